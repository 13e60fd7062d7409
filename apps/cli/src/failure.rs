//! Failures on standard error, and the exit status.

use std::borrow::Cow;
use std::io::{IsTerminal, Write as _};

use appell::{Class, Field};
use appell_spec::{Report, visible};

/// Why a command fails.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A request to the library fails.
    #[error("{}", worded(.0))]
    Library(#[from] appell::Error),
    /// The command line is invalid.
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

/// Exits with clap's message about the arguments, without colours if they contain hidden characters.
pub(crate) fn usage(error: &clap::Error) -> ! {
    let text = error.to_string();
    if let Cow::Owned(text) = visible(&text) {
        to_stderr(&text);
        std::process::exit(error.exit_code());
    }
    error.exit()
}

/// Prints a failure on standard error.
pub(crate) fn print(error: &Error) {
    to_stderr(&format!("{}\n", message(error)));
}

fn message(error: &Error) -> String {
    match error {
        Error::Library(error) => of_library(error),
        Error::Several(all) => all.iter().map(message).collect::<Vec<_>>().join("\n\n"),
        other => format!("error: {}", visible(&other.to_string())),
    }
}

fn of_library(error: &appell::Error) -> String {
    match error {
        appell::Error::Report(report) => shown(report),
        appell::Error::Expression(error) => {
            let report = error.report(&format!("{} {}", name(error.field), error.name));
            shown(&report)
        }
        appell::Error::Several(all) => all.iter().map(of_library).collect::<Vec<_>>().join("\n\n"),
        other => format!("error: {}", visible(&worded(other))),
    }
}

/// The message of an error of the library, with flags for parts of the request.
fn worded(error: &appell::Error) -> String {
    let text = match error {
        appell::Error::Request { field, message } => about(Some(*field), message),
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

/// Writes to standard error, with hidden characters of foreign texts escaped.
pub(crate) fn tell(text: &str) {
    to_stderr(&visible(text));
}

/// Prints a note that does not affect results.
pub(crate) fn note(text: &str) {
    tell(&format!("note: {text}\n"));
}

/// Prints a report on standard error.
pub(crate) fn report(report: &Report) {
    to_stderr(&(shown(report) + "\n"));
}

/// If standard error is closed, only the exit status remains.
fn to_stderr(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// A report, in colour on a terminal. It escapes hidden characters itself.
fn shown(report: &Report) -> String {
    let wanted = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let text = if wanted {
        report.coloured()
    } else {
        report.plain()
    };
    text.trim_end().to_owned()
}

/// The flag of a part of a request, if it has one.
fn flag(field: Field) -> Option<&'static str> {
    Some(match field {
        Field::Engine => "--engine",
        Field::Set => "--set",
        Field::Initial => "--initial",
        Field::Input => "--input",
        Field::Recorded | Field::Inputs => "--inputs",
        Field::Interpolation => "--interpolation",
        Field::Feedback => "--feedback",
        Field::End => "--t-end-s",
        Field::Interval => "--dt-s",
        Field::Fix => "--fix",
        Field::Free => "--free",
        Field::Along => "--along",
        Field::Require => "--require",
        Field::Chart => "--chart",
        Field::Grid => "--grid",
        Field::Equation => "--equation",
        Field::About => "--about",
        Field::At => "--at",
        Field::Outputs => "--outputs",
        Field::Poles => "--poles",
        Field::Weights => "--lqr",
        Field::Sampling => "--sampled-ms, --delay-ms",
        Field::Schedule => "--schedule",
        Field::Attraction => "--attraction",
        Field::Duration => "--for-s",
        Field::Plot => "--plot",
        Field::Also => "--also",
        Field::Drifting => "--drifting",
        Field::Effects => "--without",
        Field::Hypothesis => "--hypothesis",
        Field::Bias => "--bias",
        Field::Letters => "--parameters",
        Field::Lock => "--lock",
        Field::Sources => "--sources-only",
        Field::Chunk => "--chunk",
        Field::Jobs => "--jobs",
        Field::Device => "--device",
        _ => return None,
    })
}
