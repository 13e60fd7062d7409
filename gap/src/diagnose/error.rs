//! Why nothing can be diagnosed.

use appell_runtime::estimate::EstimateError;

use crate::effects::ModelError;

/// What a person can mend.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// No channel measures a quantity of the model.
    #[error(
        "no channel measures a quantity of the model; write `measures = \"…\"` with a coordinate, \
         pseudo-velocity or output of the spec in `[channels]`"
    )]
    NothingMeasured,
    /// All runs are held out.
    #[error("no run may be fitted; name one in `fit` of `[runs]`")]
    NothingToFit,
    /// A mechanism with effects that has no equations.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A filter or a fit that failed.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// A start that cannot be found.
    #[error(transparent)]
    Start(#[from] crate::identify::IdentifyError),
}
