//! Data types of a branch: requirements, options, points, special points; errors.

use nalgebra::DVector;

use super::continuation::End;
use crate::point::Point;
use crate::stability::critical::Change;
use crate::stability::{Stability, StabilityError, Verdict};
use crate::steady::SteadyError;
use crate::term::Term;
use appell_runtime::contact::ContactForce;

/// An output that must stay on one side of a value for a motion to be feasible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// The output.
    pub term: Term,
    /// Least value in SI.
    pub at_least: f64,
}

/// Options of the continuation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchOptions {
    /// Largest number of points of one branch.
    pub most_points: usize,
    /// Longest step, as a part of the range of the quantity and of the size of the unknowns.
    pub longest_step: f64,
    /// Whether a branch ends where a requirement is violated; else the points are marked.
    pub stop_infeasible: bool,
    /// Whether crossing branches are followed as well.
    pub follow_crossings: bool,
}

impl Default for BranchOptions {
    fn default() -> Self {
        Self {
            most_points: 4000,
            longest_step: 0.02,
            stop_infeasible: false,
            follow_crossings: true,
        }
    }
}

/// A steady motion on a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchPoint {
    /// State, inputs and parameters.
    pub point: Point,
    /// Value of the quantity along which the branch runs, in SI.
    pub value: f64,
    /// Outputs in SI.
    pub outputs: Vec<f64>,
    /// Forces at the contacts.
    pub contacts: Vec<ContactForce>,
    /// Eigenvalues, verdict.
    pub stability: Stability,
    /// Whether the requirements hold and every normal force is compressive.
    pub feasible: bool,
}

/// Kind of a special point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The quantity turns back (fold).
    Fold,
    /// Another branch crosses (branch point).
    Crossing,
    /// Stability may change, by the eigenvalues.
    Critical(Change),
    /// A requirement begins or ceases to hold: its number; after the last, a contact lifts.
    Feasibility(usize),
}

/// A point between two points of a branch that is known to rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Special {
    /// Its kind.
    pub kind: Kind,
    /// Index of the point before it.
    pub after: usize,
    /// The motion.
    pub motion: BranchPoint,
    /// Direction of the branch that crosses, in the unknowns.
    pub(super) across: Option<DVector<f64>>,
}

/// Steady motions along one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The points, in order.
    pub points: Vec<BranchPoint>,
    /// The special points between them, in order.
    pub specials: Vec<Special>,
    /// The causes of its two ends.
    pub ends: [End; 2],
    pub(super) curve: Vec<DVector<f64>>,
}

impl Branch {
    /// Special points at which the verdict changes.
    pub fn changes(&self) -> impl Iterator<Item = &Special> {
        self.specials.iter().filter(|special| {
            let verdict = |place: usize| self.points.get(place).map(|p| p.stability.verdict);
            let unstable = |place: usize| verdict(place) == Some(Verdict::Unstable);
            matches!(special.kind, Kind::Critical(_))
                && unstable(special.after) != unstable(special.after + 1)
        })
    }
}

/// Why branches could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BranchError {
    /// No steady motions, or not a one-dimensional family.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// The conditions leave no family of motions.
    #[error("the steady motions are isolated; release a condition to continue them along {0}")]
    Isolated(String),
    /// The stability of a motion could not be determined.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// An invalid range.
    #[error("`{along}` cannot run from {from} to {to}: write two different numbers")]
    Range {
        /// The quantity.
        along: String,
        /// Its beginning.
        from: f64,
        /// Its end.
        to: f64,
    },
}
