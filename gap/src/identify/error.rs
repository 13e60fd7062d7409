//! Why nothing can be identified.

use appell_estimate::EstimateError;

/// What a person can mend.
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
        "no parameter has a tolerance; write `std` in `[parameters]` of the data set, or choose \
         parameters with `--free`"
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
    /// A lag, delay, bias or scale of something that there is not.
    #[error("there is no `{name}` to look for; there are {}", known.join(", "))]
    UnknownAddition {
        /// As given.
        name: String,
        /// What can be looked for.
        known: Vec<String>,
    },
    /// A rate of drift that is none, or given twice.
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
