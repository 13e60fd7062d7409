//! Failures on standard error, and the exit status.

use std::io::{IsTerminal, Write as _};

use appell::{Class, Field};
use appell_spec::Report;

use crate::flags::flag;

/// Why a command fails.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A request to the library fails.
    #[error("{}", worded(.0))]
    Library(#[from] appell::Error),
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// The computation failed.
    #[error("{0}")]
    Computation(String),
    /// Several failures.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Several(Vec<Error>),
}

impl From<Report> for Error {
    fn from(report: Report) -> Self {
        Self::Library(report.into())
    }
}

/// The exit status of a failure; of several, the largest.
pub(crate) fn status(error: &Error) -> u8 {
    match error {
        Error::Library(error) => match error.class() {
            Class::Request => 2,
            Class::Data => 3,
            Class::Computation => 4,
        },
        Error::Usage(_) => 2,
        Error::Computation(_) => 4,
        Error::Several(all) => all.iter().map(status).max().unwrap_or(0),
    }
}

/// Prints a failure on standard error.
pub(crate) fn print(error: &Error) {
    tell(&format!("{}\n", message(error)));
}

fn message(error: &Error) -> String {
    match error {
        Error::Library(error) => of_library(error),
        Error::Several(all) => all.iter().map(message).collect::<Vec<_>>().join("\n\n"),
        other => format!("error: {other}"),
    }
}

fn of_library(error: &appell::Error) -> String {
    match error {
        appell::Error::Report(report) => shown(report).trim_end().to_owned(),
        appell::Error::Expression(error) => {
            let report = error.report(&format!("{} {}", name(error.field), error.name));
            shown(&report).trim_end().to_owned()
        }
        appell::Error::Several(all) => all.iter().map(of_library).collect::<Vec<_>>().join("\n\n"),
        other => format!("error: {}", worded(other)),
    }
}

/// The message of an error of the library, with flags for parts of the request.
fn worded(error: &appell::Error) -> String {
    let text = match error {
        appell::Error::Request { field, message } => about(Some(*field), message),
        appell::Error::Design(error) => about(error.field, &error.message),
        appell::Error::At { place, source } => format!("at {place}: {}", worded(source)),
        other => about(other.field(), &other.to_string()),
    };
    match error.remedy().and_then(flag) {
        Some(flag) => format!("{text}; see {flag}"),
        None => text,
    }
}

fn about(field: Option<Field>, message: &str) -> String {
    match field.and_then(flag) {
        Some(flag) => format!("{flag}: {message}"),
        None => message.to_owned(),
    }
}

fn name(field: Field) -> &'static str {
    flag(field).unwrap_or_else(|| field.name())
}

/// Writes to standard error; if that is closed, only the exit status remains.
pub(crate) fn tell(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Prints a note that changes no result.
pub(crate) fn note(text: &str) {
    tell(&format!("note: {text}\n"));
}

/// A report, in colour on a terminal.
pub(crate) fn shown(report: &Report) -> String {
    let wanted = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    if wanted {
        report.coloured()
    } else {
        report.plain()
    }
}
