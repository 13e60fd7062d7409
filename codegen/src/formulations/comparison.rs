//! Comparison of derived quantities with other formulations.

use crate::symbolic::Expr;

/// The reference for the derived equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Against {
    /// The definitions of the pseudo-velocities and the constraints.
    Spec,
    /// Kane's equations.
    Kane,
    /// Lagrange's equations with multipliers.
    Lagrange,
    /// Newton's law for the whole mechanism.
    Newton,
}

impl Against {
    /// Its display name.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Spec => "spec",
            Self::Kane => "Kane",
            Self::Lagrange => "Lagrange",
            Self::Newton => "Newton",
        }
    }
}

/// The result of comparing two expressions of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub enum Agreement {
    /// The same functions, by the identity test.
    Identical,
    /// The same values at random points.
    AtPoints {
        /// Number of points.
        points: usize,
        /// Largest deviation, relative to the largest entry there.
        deviation: f64,
    },
    /// Different values.
    Different {
        /// The entry with the largest deviation.
        entry: String,
        /// Its values by the derivation and by the other formulation.
        values: [f64; 2],
        /// Their deviation, relative to the largest entry there.
        deviation: f64,
    },
    /// No comparison: both were finite at no random point.
    Undefined,
    /// The time limit was reached first.
    NotReached,
}

/// The comparison of a quantity with another formulation.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The reference.
    pub against: Against,
    /// Name of the quantity.
    pub quantity: &'static str,
    /// The result.
    pub agreement: Agreement,
}

impl Comparison {
    /// Whether the two are different functions.
    pub fn differs(&self) -> bool {
        matches!(self.agreement, Agreement::Different { .. })
    }
}

/// The result of all comparisons.
#[derive(Debug, Clone)]
pub struct FormulationComparison {
    /// One per quantity and formulation.
    pub comparisons: Vec<Comparison>,
    /// Bound on the probability that any quantity was wrongly taken for identical.
    pub error_bound: f64,
}

impl FormulationComparison {
    /// Whether all quantities were compared and agree.
    pub fn agrees(&self) -> bool {
        let agree = |c: &Comparison| {
            matches!(
                c.agreement,
                Agreement::Identical | Agreement::AtPoints { .. }
            )
        };
        self.comparisons.iter().all(agree)
    }
}

/// Two expressions that should be the same function.
pub(super) struct Pair {
    pub(super) entry: String,
    pub(super) derived: Expr,
    pub(super) other: Expr,
}
