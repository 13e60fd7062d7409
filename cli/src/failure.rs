//! Failures on standard error, and the exit status.

use std::io::{IsTerminal, Write as _};

use appell::Error;
use appell_spec::Report;

/// The exit status of a failure; of several, the largest.
pub(crate) fn status(error: &Error) -> u8 {
    match error {
        Error::Usage(_) | Error::Expression(_) => 2,
        Error::Report(_) | Error::Data(_) | Error::File { .. } => 3,
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
        Error::Report(report) | Error::Expression(report) => shown(report).trim_end().to_owned(),
        Error::Several(all) => all.iter().map(message).collect::<Vec<_>>().join("\n\n"),
        other => format!("error: {other}"),
    }
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
