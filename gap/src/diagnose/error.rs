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
    /// Recordings that do not fit an alternative.
    #[error(transparent)]
    Data(#[from] crate::data::DataError),
    /// An alternative cannot be compared on the same channels.
    #[error(
        "the alternative `{name}` has no quantity for the column `{column}`; hypotheses are compared \
         on the same channels, and names join them"
    )]
    LacksChannel {
        /// The alternative.
        name: String,
        /// The column.
        column: String,
    },
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
