//! A scalar constraint, linear in the generalised velocities.

use appell_spec::mechanism::{ConstraintId, PointId};

use super::frames::FrameVector;
use super::rank::LinearRow;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};

/// One scalar constraint: `Σ coefficient · q̇ + rest = 0`.
#[derive(Debug, Clone)]
pub struct Row {
    /// Name for people, such as `rolling.x`.
    pub name: String,
    /// Of which constraint.
    pub constraint: ConstraintId,
    /// The whole row, with symbols for the generalised velocities.
    pub value: Expr,
    /// Coefficients of the generalised velocities.
    pub coefficients: Vec<Expr>,
    /// What remains without generalised velocities.
    pub rest: Expr,
    /// Where its reaction is reported, and along which direction of the ground a unit of it acts.
    pub reaction: Reaction,
    /// The direction as it is written; an axis of the ground where the constraint has no point.
    pub along: FrameVector,
    /// The point next to the origin from which hangs what it holds, if it has a point.
    pub root: Option<PointId>,
    /// Whether it is left out because it follows from the others.
    pub redundant: bool,
    /// Whether it is the derivative of a position constraint.
    pub of_position: bool,
}

/// How the reaction of a row is reported.
#[derive(Debug, Clone)]
pub struct Reaction {
    /// Index among the places of reactions; see [`super::constraints::Constraints::reported`].
    pub place: usize,
    /// Direction in the ground; a row without a point reports its multiplier as first component.
    pub direction: Vec3,
}

impl Row {
    /// Whether the coordinates satisfy the row by themselves.
    pub fn is_embedded(&self) -> bool {
        self.coefficients.iter().all(|&c| c == Graph::ZERO)
    }

    /// Whether the row restricts the generalised velocities beyond what the others do.
    pub fn is_active(&self) -> bool {
        !self.redundant && !self.is_embedded()
    }

    /// The row for questions of rank.
    pub fn linear(&self) -> LinearRow {
        LinearRow {
            coefficients: self.coefficients.clone(),
            rest: self.rest,
        }
    }
}
