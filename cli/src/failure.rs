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

/// Tells a failure on standard error.
pub(crate) fn print(error: &Error) {
    tell(&format!("{}\n", told(error)));
}

fn told(error: &Error) -> String {
    match error {
        Error::Report(report) | Error::Expression(report) => shown(report).trim_end().to_owned(),
        Error::Several(all) => all.iter().map(told).collect::<Vec<_>>().join("\n\n"),
        other => format!("error: {other}"),
    }
}

/// Writes to standard error. Where that is closed, the exit status has to do.
pub(crate) fn tell(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Tells something that changes no result.
pub(crate) fn note(text: &str) {
    tell(&format!("note: {text}\n"));
}

/// A report in colour where a person reads it.
pub(crate) fn shown(report: &Report) -> String {
    let wanted = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    if wanted {
        report.coloured()
    } else {
        report.plain()
    }
}
