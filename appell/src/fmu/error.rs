//! Why there is no FMU.

use std::io;

/// Why there is no FMU.
#[derive(Debug, thiserror::Error)]
pub enum FmuError {
    /// No C compiler runs.
    #[error(
        "no C compiler was found (tried {tried}): install one, let the environment variable CC name one, or write \
         only the sources, which the importing tool compiles"
    )]
    NoCompiler {
        /// Names that were tried.
        tried: String,
    },
    /// The C compiler fails.
    #[error(
        "the C compiler `{compiler}` failed: let the environment variable CC name another one, or write only the \
         sources, which the importing tool compiles{told}"
    )]
    Compiler {
        /// Its name.
        compiler: String,
        /// Its messages, a line each.
        told: String,
    },
    /// There are no binaries for this platform.
    #[error(
        "no machine code is written for {platform}: write only the sources, which the importing tool compiles"
    )]
    Platform {
        /// Architecture and operating system.
        platform: String,
    },
    /// Files of the compilation cannot be made or read.
    #[error("cannot {doing}: {cause}")]
    Scratch {
        /// The failed operation.
        doing: &'static str,
        /// The error of the operating system.
        #[source]
        cause: io::Error,
    },
    /// The package cannot be made.
    #[error("cannot pack the FMU: {0}")]
    Package(#[from] zip::result::ZipError),
}
