//! The appell mechanism language: text to a checked mechanism.
//!
//! ```text
//! text --parse--> SpecAst --resolve--> Mechanism
//! ```
//!
//! [`load`] does both. Every finding of a file is reported at once, each with its place in the
//! text and with what to write instead.

pub mod ast;
mod axis;
pub mod compose;
pub mod diagnostic;
pub mod edit;
pub mod expr;
pub mod ids;
pub mod language;
pub mod limits;
pub mod mechanism;
mod name;
mod number;
pub mod parse;
pub mod resolve;
pub mod schema;
mod starter;
mod suggest;
pub mod units;

pub use diagnostic::{Code, Diagnostic, Report, Severity};
pub use mechanism::Mechanism;
pub use resolve::{Scope, Snippet, formula};
pub use starter::{NameError, starter};
pub use suggest::{closest, did_you_mean, shown};

/// A mechanism that passed every check of this crate.
#[derive(Debug, Clone)]
pub struct Checked {
    /// The mechanism.
    pub mechanism: Mechanism,
    /// Warnings and notes.
    pub warnings: Vec<Diagnostic>,
}

/// Reads and checks a spec; `file` is its name in messages and in emitted code.
pub fn load(file: &str, text: &str) -> Result<Checked, Report> {
    let (ast, mut findings) = parse::parse(text);
    let (mechanism, checks) = resolve::resolve(&ast, file, text);
    findings.extend(checks);
    if findings.iter().any(|f| f.severity == Severity::Error) {
        findings.retain(|f| f.severity == Severity::Error);
        return Err(Report::new(file, text, findings));
    }
    Ok(Checked {
        mechanism,
        warnings: findings,
    })
}
