//! What ends a command, and its exit status.

use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};

use appell_spec::Report;

/// Why a command did not do what it was asked for.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The command line asks for something that does not exist or does not fit together.
    #[error("{0}")]
    Usage(String),
    /// An expression on the command line is wrong.
    #[error("{}", .0.plain())]
    Expression(Box<Report>),
    /// A file is wrong; the report shows the places.
    #[error("{}", .0.plain())]
    Report(Box<Report>),
    /// A file is wrong as a whole.
    #[error("{0}")]
    Data(String),
    /// A file cannot be read or written.
    #[error("cannot {doing} {}: {cause}", path.display())]
    File {
        /// `read` or `write`.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// The computation failed: time, state and reason.
    #[error("{0}")]
    Computation(String),
    /// Several failures, each told.
    #[error("{}", plain(.0))]
    Several(Vec<Failure>),
}

impl Failure {
    /// A file that cannot be read.
    pub(crate) fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        Self::about("read", path)
    }

    /// A file that cannot be written.
    pub(crate) fn writing(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        Self::about("write", path)
    }

    fn about(doing: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |cause| Self::File {
            doing,
            path: path.to_owned(),
            cause,
        }
    }

    /// The exit status of a failure; of several, the largest.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Expression(_) => 2,
            Self::Report(_) | Self::Data(_) | Self::File { .. } => 3,
            Self::Computation(_) => 4,
            Self::Several(all) => all.iter().map(Self::status).max().unwrap_or(0),
        }
    }

    /// Tells it on standard error.
    pub(crate) fn print(&self) {
        tell(&format!("{}\n", self.told()));
    }

    fn told(&self) -> String {
        match self {
            Self::Report(report) | Self::Expression(report) => shown(report).trim_end().to_owned(),
            Self::Several(all) => all.iter().map(Self::told).collect::<Vec<_>>().join("\n\n"),
            other => format!("error: {other}"),
        }
    }
}

impl From<Report> for Failure {
    fn from(report: Report) -> Self {
        Self::Report(Box::new(report))
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

fn plain(failures: &[Failure]) -> String {
    let texts = failures.iter().map(ToString::to_string);
    texts.collect::<Vec<_>>().join("\n")
}
