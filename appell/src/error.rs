//! Why a question has no answer.

use std::path::{Path, PathBuf};

use appell_spec::Report;

/// Why a question has no answer.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// It asks for something that does not exist or does not fit together.
    #[error("{0}")]
    Usage(String),
    /// An expression is wrong.
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
    Several(Vec<Error>),
}

impl Error {
    /// A file that cannot be read.
    pub fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        Self::about("read", path)
    }

    /// A file that cannot be written.
    pub fn writing(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        Self::about("write", path)
    }

    fn about(doing: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |cause| Self::File {
            doing,
            path: path.to_owned(),
            cause,
        }
    }
}

impl From<Report> for Error {
    fn from(report: Report) -> Self {
        Self::Report(Box::new(report))
    }
}

fn plain(failures: &[Error]) -> String {
    let texts = failures.iter().map(ToString::to_string);
    texts.collect::<Vec<_>>().join("\n")
}
