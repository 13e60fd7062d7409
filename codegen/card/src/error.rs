//! Errors of cards.

use cudarc::driver::DriverError;
use cudarc::driver::sys::CUresult;

/// Why there is no card, or why it computes nothing.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CardError {
    /// A library cannot be loaded.
    #[error(
        "there is no {what} (`{library}`): install {package}, or name its folder in `LD_LIBRARY_PATH`"
    )]
    Missing {
        /// What it is.
        what: &'static str,
        /// The name of its file.
        library: &'static str,
        /// The package that has it.
        package: &'static str,
    },
    /// Its memory is too small.
    #[error("the memory of the graphics card is too small")]
    Memory,
    /// The driver refuses.
    #[error("the graphics card cannot be used: {0}")]
    Driver(String),
    /// The compiler refuses a source.
    #[error("the equations cannot be compiled for the graphics card: {0}")]
    Compiler(String),
    /// More places than one call takes.
    #[error("a call of a kernel takes at most {most} places, not {places}")]
    TooMany {
        /// The requested ones.
        places: usize,
        /// The most.
        most: usize,
    },
}

impl From<DriverError> for CardError {
    fn from(error: DriverError) -> Self {
        if error.0 == CUresult::CUDA_ERROR_OUT_OF_MEMORY {
            return Self::Memory;
        }
        let name = error
            .error_string()
            .map(|text| text.to_string_lossy().into_owned());
        Self::Driver(name.unwrap_or_else(|_| format!("{error:?}")))
    }
}
