//! What ends a command, and its exit status.

use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

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
    /// Files are wrong; each report shows the places.
    #[error("{}", plain(.0))]
    Reports(Vec<Report>),
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

    /// 2 bad usage, 3 bad spec or data, 4 the computation failed.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Usage(_) | Self::Expression(_) => 2,
            Self::Reports(_) | Self::Data(_) | Self::File { .. } => 3,
            Self::Computation(_) => 4,
        })
    }

    /// Tells it on standard error.
    pub(crate) fn print(&self) {
        let text = match self {
            Self::Reports(reports) => reports.iter().map(shown).collect::<Vec<_>>().join("\n"),
            Self::Expression(report) => shown(report),
            other => format!("error: {other}"),
        };
        // Where standard error is closed, the exit status has to do.
        let _ = writeln!(std::io::stderr(), "{}", text.trim_end());
    }
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

fn plain(reports: &[Report]) -> String {
    reports
        .iter()
        .map(Report::plain)
        .collect::<Vec<_>>()
        .join("\n")
}
