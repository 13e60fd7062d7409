//! Why a robot cannot be imported.

use appell_spec::Report;

/// Why a robot cannot be imported.
#[derive(Debug)]
pub enum Failure {
    /// Its file or an included one has errors or unsupported parts; the report is about one file.
    File(Box<Report>),
    /// A joint that cannot be locked, in a sentence.
    Lock(String),
    /// Names of parameters that match nothing.
    Unknown {
        /// The first one.
        name: String,
        /// A suggestion.
        help: String,
    },
}
