//! Errors of compilation.

use std::io;

use appell_codegen::jit::JitError;
use iced_x86::IcedError;
use thiserror::Error;

/// A tape that could not be compiled.
#[derive(Debug, Error)]
pub enum VectorError {
    /// The tape is invalid, or scalar code could not be compiled.
    #[error(transparent)]
    Tape(#[from] JitError),
    /// An instruction could not be encoded.
    #[error("an instruction could not be encoded")]
    Encoding(#[from] IcedError),
    /// The system gave no memory for code.
    #[error("no executable memory")]
    Memory(#[from] io::Error),
}
