//! Shapes of arrays, and labels of their entries.

use appell_runtime::model::{ModelInfo, Quantity};

/// A vector of the model whose entries have names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Space {
    /// p: parameters.
    Parameters,
    /// x: pseudo-velocities, then coordinates.
    State,
    /// u: inputs, then signals and their rates.
    Inputs,
    /// y: outputs of the spec.
    Outputs,
    /// ẋ: pseudo-accelerations, then generalised velocities.
    Rates,
    /// ω̇: pseudo-accelerations.
    Accelerations,
    /// q̇: generalised velocities.
    CoordinateRates,
    /// Π and b: one pseudo-force per pseudo-velocity.
    GeneralizedForces,
    /// Rows of the constraints that geometry does not embed.
    ConstraintRows,
    /// Places with a reaction.
    Reactions,
}

impl Space {
    /// The quantities of the entries: for rates and forces, those of the states. Rows of constraints and
    /// reactions have none.
    pub fn quantities(self, info: &ModelInfo) -> &[Quantity] {
        match self {
            Self::Parameters => &info.parameters,
            Self::State | Self::Rates => &info.states,
            Self::Inputs => &info.inputs,
            Self::Outputs => &info.outputs,
            Self::Accelerations | Self::GeneralizedForces => info.speed_quantities(),
            Self::CoordinateRates => info.coordinate_quantities(),
            Self::ConstraintRows | Self::Reactions => &[],
        }
    }
}

/// The shape of an array, and the labels of its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One number.
    Scalar,
    /// One number per entry of a vector.
    Vector(Space),
    /// A fixed number of numbers per entry of a vector.
    Rows(Space, usize),
    /// One number per pair of entries: derivatives of the first vector with respect to the second.
    Jacobian(Space, Space),
    /// A plain list.
    List(usize),
    /// A plain matrix, by numbers of rows and columns.
    Matrix(usize, usize),
}

impl Layout {
    /// Whether entries have a row and a column index.
    pub fn has_columns(self) -> bool {
        matches!(self, Self::Rows(..) | Self::Jacobian(..) | Self::Matrix(..))
    }
}
