//! The appell mechanism language: text to a checked mechanism.
//!
//! ```text
//! text --parse--> SpecAst --expand--> SpecAst without joints --resolve--> Mechanism
//! ```
//!
//! [`load`] does all of this. All findings of a file are reported at once, each with its position in the
//! text and a suggested correction.

pub mod ast;
mod axis;
pub mod compose;
pub mod diagnostic;
pub mod edit;
pub mod expr;
pub mod foreign;
pub mod ids;
pub mod joints;
pub mod language;
pub mod limits;
pub mod mechanism;
pub mod name;
mod number;
pub mod occurrences;
pub mod outline;
pub mod parse;
pub mod rename;
pub mod resolve;
pub mod schema;
mod starter;
mod suggest;
pub mod units;
mod visible;

pub use diagnostic::{Code, Diagnostic, Report, Severity};
pub use mechanism::Mechanism;
pub use parse::is_forbidden;
pub use resolve::{Scope, Snippet, formula, is_reserved};
pub use starter::{NameError, starter};
pub use suggest::{closest, did_you_mean, shown};
pub use visible::visible;

/// A mechanism that passed every check of this crate.
#[derive(Debug, Clone)]
pub struct Checked {
    /// The mechanism.
    pub mechanism: Mechanism,
    /// Warnings and notes.
    pub warnings: Vec<Diagnostic>,
}

/// A possibly invalid spec.
#[derive(Debug, Clone)]
pub struct Reading {
    /// The syntax tree.
    pub ast: ast::SpecAst,
    /// The same with expanded joints; `None` if there are none.
    without_joints: Option<ast::SpecAst>,
    /// The mechanism, with placeholders for invalid parts.
    pub mechanism: Mechanism,
    /// The errors; if there are none, warnings and notes.
    pub findings: Vec<Diagnostic>,
}

impl Reading {
    /// Reads and checks a spec; `file` is its name in messages and in emitted code.
    pub fn new(file: &str, text: &str) -> Self {
        let (ast, mut findings) = parse::parse(text);
        let expansion = joints::expand(&ast, text);
        let whole = expansion.as_ref().map_or(&ast, |expansion| &expansion.ast);
        let (mechanism, checks) = resolve::resolve(whole, file, text);
        let without_joints = if let Some(expansion) = expansion {
            findings.extend(joints::explained(&ast, &expansion.findings, checks));
            findings.extend(expansion.findings);
            Some(expansion.ast)
        } else {
            findings.extend(checks);
            None
        };
        let is_error = |finding: &Diagnostic| finding.severity == Severity::Error;
        if findings.iter().any(is_error) {
            findings.retain(is_error);
        }
        Self {
            ast,
            without_joints,
            mechanism,
            findings,
        }
    }

    /// The syntax tree with expanded joints; the positions of their items are those of the joints' keys.
    pub fn expanded(&self) -> &ast::SpecAst {
        self.without_joints.as_ref().unwrap_or(&self.ast)
    }

    /// Whether the mechanism passed every check.
    pub fn is_valid(&self) -> bool {
        self.findings.iter().all(|f| f.severity != Severity::Error)
    }
}

/// Reads and checks a spec; `file` is its name in messages and in emitted code.
pub fn load(file: &str, text: &str) -> Result<Checked, Report> {
    let reading = Reading::new(file, text);
    if !reading.is_valid() {
        return Err(Report::new(file, text, reading.findings));
    }
    Ok(Checked {
        mechanism: reading.mechanism,
        warnings: reading.findings,
    })
}

/// The text of a spec with expanded joints; everything else is unchanged, including comments. Errors
/// of the spec are returned as a report.
///
/// ```
/// # let text = appell_spec::starter("fresh").expect("a name");
/// assert_eq!(appell_spec::expanded("fresh.toml", &text)?, text);
/// # Ok::<(), appell_spec::Report>(())
/// ```
pub fn expanded(file: &str, text: &str) -> Result<String, Report> {
    load(file, text)?;
    let (ast, _) = parse::parse(text);
    joints::replaced(&ast, text).map_err(|error| {
        let finding = Diagnostic::error(Code::TomlSyntax, error.to_string());
        Report::new(file, text, vec![finding])
    })
}
