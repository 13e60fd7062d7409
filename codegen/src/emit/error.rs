//! Errors of the emission.

use thiserror::Error;

use crate::program::FunctionKind;

/// Errors of the emission.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Error {
    /// The path of the run-time crate is not a path.
    #[error("`{0}` is not the path of a crate or module")]
    RuntimePath(String),
    /// The implementation of `Model` needs a function that the program does not have.
    #[error("`impl Model` needs the function {0:?}")]
    MissingFunction(FunctionKind),
    /// The number of entries contradicts the layout.
    #[error("{kind:?}: `{array}` has {found} entries where its layout has {expected}")]
    Shape {
        /// Function.
        kind: FunctionKind,
        /// Result array.
        array: String,
        /// Entries of the layout.
        expected: usize,
        /// Entries of the array.
        found: usize,
    },
    /// The text is not valid Rust, which is a bug of this module.
    #[error("emitted text does not parse: {0}")]
    Syntax(String),
}
