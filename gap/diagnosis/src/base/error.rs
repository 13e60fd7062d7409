//! Errors of the estimation of base parameters.

use appell_estimate::inverse::InverseError;

/// Why base parameters cannot be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BaseError {
    /// Nothing depends on the parameters.
    #[error("no motion depends on an inertial parameter or on one of the loads")]
    NoParameter,
    /// An input was not recorded.
    #[error(
        "the input `{input}` is not recorded; base parameters are estimated from recorded forces"
    )]
    NoInput {
        /// Its name.
        input: String,
    },
    /// The motions do not determine the base parameters.
    #[error(
        "the recorded motions determine {rank} of {count} base parameters; record motions that move every joint"
    )]
    TooLittle {
        /// Combinations that are determined.
        rank: usize,
        /// Base parameters.
        count: usize,
    },
    /// Every term of the equations has a parameter, those of the inputs too.
    #[error(
        "every term of the equations has a parameter that is estimated, so all may be scaled together; write the gain of \
         the inputs as a number of the spec instead: {}", .parameters.join(", ")
    )]
    Scale {
        /// The parameters that multiply inputs.
        parameters: Vec<String>,
    },
    /// A run with parameters of its own.
    #[error(
        "base parameters are those of one mechanism, and the run `{run}` has parameters of its own; estimate without it"
    )]
    Differs {
        /// Its name.
        run: String,
    },
    /// The equations have no finite values on the recorded motions.
    #[error("inverse dynamics has no finite values on the recorded motions")]
    NotFinite,
    /// The motions could not be evaluated.
    #[error(transparent)]
    Inverse(#[from] InverseError),
}
