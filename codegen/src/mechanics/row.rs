//! A scalar constraint, linear in the generalised velocities.

use appell_spec::mechanism::{ConstraintId, PointId};

use super::frames::FrameVector;
use super::rank::LinearRow;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};

/// One scalar constraint: `Σ coefficient · q̇ + rest = 0`.
#[derive(Debug, Clone)]
pub struct Row {
    /// Display name, such as `rolling.x`.
    pub name: String,
    /// Of which constraint.
    pub constraint: ConstraintId,
    /// The whole row, with symbols for the generalised velocities.
    pub value: Expr,
    /// Coefficients of the generalised velocities.
    pub coefficients: Vec<Expr>,
    /// Terms without generalised velocities.
    pub rest: Expr,
    /// Where its reaction is reported, and the direction of a unit reaction in the ground.
    pub reaction: Reaction,
    /// The direction in its original frame; an axis of the ground for constraints without a point.
    pub along: FrameVector,
    /// The point adjacent to the origin on the path to the constrained point, if there is one.
    pub root: Option<PointId>,
    /// Whether it is omitted because it follows from the others.
    pub redundant: bool,
    /// Whether it is the derivative of a position constraint.
    pub of_position: bool,
}

/// How the reaction of a row is reported.
#[derive(Debug, Clone)]
pub struct Reaction {
    /// Index among the places of reactions; see [`super::constraints::Constraints::reported`].
    pub place: usize,
    /// Direction in the ground; the multiplier of a row without a point is the first component.
    pub direction: Vec3,
}

impl Row {
    /// Whether the coordinates satisfy the row identically.
    pub fn is_embedded(&self) -> bool {
        self.coefficients.iter().all(|&c| c == Graph::ZERO)
    }

    /// Whether the row restricts the generalised velocities independently of the others.
    pub fn is_active(&self) -> bool {
        !self.redundant && !self.is_embedded()
    }

    /// The row for rank tests.
    pub fn linear(&self) -> LinearRow {
        LinearRow {
            coefficients: self.coefficients.clone(),
            rest: self.rest,
        }
    }
}
