//! Feedback files: `u = offset - K (y - y_desired(t))`, y being some of the states.
//!
//! ```toml
//! input  = "u"                             # or inputs = ["u", "v"], with a list of gains for each
//! states = ["theta", "omega_1"]
//! gains  = [40, 12]
//! sampled_ms = 10                          # sampling period; inputs are held in between
//! delay_ms = 5                             # from a measurement to its effect
//! pending_gains = [0.1]                    # gains of inputs that do not act yet
//! switching_times_s = [2]                  # where a desired value jumps or kinks
//! desired = { theta = "if(t < 2, 0, 0.1)" }
//! initial = { theta = "5deg" }             # unless the request sets it
//! ```
//!
//! A law with the key `law` computes its inputs by inverse dynamics.
//!
//! A gain-scheduled law has, instead of `gains` and `offset`, the scheduling variable `over`, a state or
//! parameter, and a table `[[at]]` for each of its values.

use std::path::Path;

use appell_spec::expr::Expr;
use appell_spec::limits::MAX_FILE;
use appell_spec::{Code, Report, Scope};
use toml::de::DeTable;

use super::law::Law;
use crate::setup::Setup;
use crate::{Error, files};
use reading::Reader;

mod by_model;
mod gains;
mod reading;
mod schedule;

/// A law for one input or several.
#[derive(Debug)]
pub struct Feedback {
    /// The file.
    pub file: String,
    /// Offsets of inputs.
    pub offsets: Vec<(usize, Expr)>,
    /// The law.
    pub law: Box<dyn Law>,
    /// Times in s at which the law has a jump or a kink.
    pub switching_times: Vec<f64>,
    /// Initial values by state.
    pub initial: Vec<(usize, Expr)>,
}

impl Feedback {
    /// Sets the initial values of the law.
    pub fn start(&self, setup: &mut Setup<'_>) -> Result<(), Error> {
        for (state, expr) in &self.initial {
            let told = |message| Error::data(&self.file, message);
            let name = &setup.info.states[*state].name;
            let value = setup.constant(expr).ok_or_else(|| {
                told(format!(
                    "the initial value of `{name}` is not a finite number"
                ))
            })?;
            setup.place(*state, value).map_err(told)?;
        }
        Ok(())
    }
}

/// Reads a feedback file.
pub fn read(path: &Path, setup: &Setup<'_>) -> Result<Feedback, Error> {
    parse(
        &path.to_string_lossy(),
        &files::read(path, MAX_FILE as u64)?,
        setup,
    )
}

/// Reads the text of a feedback file.
pub fn parse(file: &str, text: &str, setup: &Setup<'_>) -> Result<Feedback, Error> {
    let mut reader = Reader {
        text,
        setup,
        findings: Vec::new(),
    };
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        let message = error.message().lines().next().unwrap_or_default();
        reader.tell(Code::TomlSyntax, message, error.span().unwrap_or(0..0), "");
    }
    let feedback = if errors.is_empty() {
        feedback(&mut reader, file, table.get_ref())
    } else {
        None
    };
    match feedback {
        Some(feedback) if reader.findings.is_empty() => Ok(feedback),
        _ => Err(Report::new(file, text, reader.findings).into()),
    }
}

/// Parses the file; an invalid entry is reported and skipped, so that all errors are found.
fn feedback(reader: &mut Reader<'_>, file: &str, table: &DeTable<'_>) -> Option<Feedback> {
    let switching_times = reader.list(table, "switching_times_s", Reader::number);
    let initial = reader.by_state(table, "initial", Scope::Constant, "the initial value");
    let (offsets, law) = match table.get("law") {
        Some(law) => {
            let law: Box<dyn Law> = Box::new(by_model::read(reader, table, law)?);
            (Vec::new(), law)
        }
        None => gains::read(reader, table)?,
    };
    let initial = initial.into_iter().map(|(state, expr, _)| (state, expr));
    Some(Feedback {
        file: file.to_owned(),
        offsets,
        law,
        switching_times: switching_times.unwrap_or_default(),
        initial: initial.collect(),
    })
}
