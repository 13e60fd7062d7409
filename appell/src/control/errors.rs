//! Why no controller can be designed.

pub use appell_analysis::control::lqr::RiccatiError;
pub use appell_analysis::control::operating_point::OperatingPointError;
pub use appell_analysis::control::placement::PlacementError;
pub use appell_analysis::control::reduction::ReductionError;
pub use appell_analysis::control::sampled::SamplingError;
pub use appell_spectra::spectrum::SpectrumError;

use crate::error::Class;
use crate::field::Field;

/// Why no controller can be designed.
#[derive(Debug, thiserror::Error)]
#[error("{}{message}", field.map(|field| format!("{field}: ")).unwrap_or_default())]
pub struct DesignError {
    /// The invalid part of the request; none if the computation failed.
    pub field: Option<Field>,
    /// The error and its remedy, in the names of the mechanism.
    pub message: String,
    /// The cause.
    #[source]
    pub cause: Cause,
}

/// Cause of a failed design.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// No linear equations with constant coefficients.
    #[error(transparent)]
    OperatingPoint(#[from] OperatingPointError),
    /// No controllable spectrum.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
    /// No closed subsystem of the outputs.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// Poles that cannot be placed.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// Weights without a stabilising solution.
    #[error(transparent)]
    Riccati(#[from] RiccatiError),
    /// A sampling period or delay that is impossible.
    #[error(transparent)]
    Sampling(#[from] SamplingError),
}

impl DesignError {
    /// A wrong request.
    pub(super) fn request(field: Field, message: String, cause: impl Into<Cause>) -> Self {
        Self {
            field: Some(field),
            message,
            cause: cause.into(),
        }
    }

    /// A failed computation.
    pub(super) fn computation(cause: impl Into<Cause>) -> Self {
        let cause = cause.into();
        Self {
            field: None,
            message: cause.to_string(),
            cause,
        }
    }

    /// The class.
    pub fn class(&self) -> Class {
        match self.field {
            Some(_) => Class::Request,
            None => Class::Computation,
        }
    }
}

impl From<SpectrumError> for DesignError {
    fn from(error: SpectrumError) -> Self {
        Self::computation(error)
    }
}

impl From<SamplingError> for DesignError {
    fn from(error: SamplingError) -> Self {
        Self::request(Field::Sampling, error.to_string(), error)
    }
}
