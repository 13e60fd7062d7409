//! Errors of a diagnosis.

use appell_estimate::EstimateError;
use appell_spec::edit::EditError;

use crate::effects::ModelError;

/// Why recordings cannot be diagnosed.
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
    Data(#[from] appell_recordings::DataError),
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
    /// The nominal model is too far from the recordings to be fitted.
    #[error(
        "the model as it is cannot be fitted to these recordings: {0}; a wrong unit or sign, a channel \
         that never changes, another mechanism or tolerances that are far too small look like this; \
         `appell recording` tells what the columns hold, and a wider `std` lets parameters move"
    )]
    Nominal(EstimateError),
    /// A filter or a fit that failed.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// Forces of motions that cannot be evaluated.
    #[error(transparent)]
    Forces(#[from] crate::base::BaseError),
    /// The effects found in the earlier recordings cannot be written into the spec.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// Initial values that cannot be determined.
    #[error(transparent)]
    Start(#[from] crate::identify::IdentifyError),
}

impl DiagnoseError {
    /// The same error, if it is the nominal model that cannot be fitted.
    pub(super) fn of_nominal(error: Self) -> Self {
        match error {
            Self::Estimate(error) => Self::Nominal(error),
            other => other,
        }
    }
}

/// The result of a step of a diagnosis.
pub(super) type Result<T, E = DiagnoseError> = std::result::Result<T, E>;

/// Why a spec cannot be changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChangeError {
    /// The spec or the items are invalid.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The spec has the effect already.
    #[error(
        "the spec has `{name}` already: it holds this effect, and the report is about another spec"
    )]
    There {
        /// A parameter of the effect.
        name: String,
    },
    /// A unit that does not exist.
    #[error("the parameter `{name}` has no readable value and unit in the report")]
    Unreadable {
        /// The parameter.
        name: String,
    },
}
