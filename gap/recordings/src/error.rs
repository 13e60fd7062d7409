//! Why a data set cannot be read.

use std::path::PathBuf;

use appell_files::FileError;
use appell_spec::Report;

/// Why a data set cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// Errors in a file, with their positions.
    #[error("{0}")]
    Report(Box<Report>),
    /// A file is not opened, or cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A folder without a description.
    #[error(
        "{} holds no recording.toml; write one, or name the mechanism and the CSV files themselves",
        folder.display()
    )]
    NoManifest {
        /// The folder.
        folder: PathBuf,
    },
    /// A file is wrong as a whole.
    #[error("{file}: {message}")]
    Whole {
        /// The file.
        file: String,
        /// Message with advice.
        message: String,
    },
    /// Several of them.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n\n"))]
    Several(Vec<DataError>),
}

impl DataError {
    /// One error or several.
    pub fn several(mut errors: Vec<Self>) -> Self {
        match errors.len() {
            1 => errors.remove(0),
            _ => Self::Several(errors),
        }
    }

    /// A file that is wrong as a whole.
    pub(crate) fn whole(file: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Whole {
            file: file.into(),
            message: message.into(),
        }
    }
}

impl From<Report> for DataError {
    fn from(report: Report) -> Self {
        Self::Report(Box::new(report))
    }
}
