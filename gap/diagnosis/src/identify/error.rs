//! Errors of identifications.

use appell_estimate::EstimateError;

/// Why an identification failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// No channel measures a quantity of the model.
    #[error(
        "no channel measures a quantity of the model; write `measures = \"…\"` with a coordinate, \
         pseudo-velocity or output of the spec in `[channels]`"
    )]
    NothingMeasured,
    /// All runs are held out.
    #[error("no run may be fitted; name one in `fit` of `[runs]`")]
    NothingToFit,
    /// No parameter is free.
    #[error(
        "no parameter has a tolerance; write `std` in `[parameters]` of the data set, or name the \
         free parameters"
    )]
    NothingFree,
    /// A parameter that the spec lacks.
    #[error("the spec has no parameter `{name}`; it has {}", known.join(", "))]
    UnknownParameter {
        /// As given.
        name: String,
        /// Names of the spec.
        known: Vec<String>,
    },
    /// A lag, delay, bias or scale of an unknown input or channel.
    #[error("`{name}` cannot be estimated; available: {}", known.join(", "))]
    UnknownAddition {
        /// As given.
        name: String,
        /// Available names.
        known: Vec<String>,
    },
    /// An invalid or repeated rate of drift.
    #[error(
        "`{name}` cannot drift by {rate}: give each parameter one positive rate, in its unit per \
         square root of a second"
    )]
    Rate {
        /// The parameter.
        name: String,
        /// As given.
        rate: f64,
    },
    /// A filter or a fit that failed.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
}
