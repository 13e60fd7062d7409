//! Meanings of names in expressions, quantities that occur there, and definitions being expanded.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostic;
use crate::expr::{Quantity, Span};
use crate::units::Dimension;

/// The meaning of a name in an expression.
#[derive(Debug, Clone)]
pub(super) struct Named {
    pub(super) meaning: Meaning,
    /// `None` while it is not known.
    pub(super) dimension: Option<Dimension>,
    pub(super) span: Span,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Meaning {
    Quantity(Quantity),
    /// A named expression, by its index.
    Definition(usize),
    /// Outputs are in the same namespace, but cannot occur in expressions.
    Output,
}

/// Properties of the force of a load or constraint for its use in expressions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Acting {
    /// Its form.
    pub(super) shape: Shape,
    /// `None` while it is not known.
    pub(super) dimension: Option<Dimension>,
    /// Bound on the polynomial degree.
    pub(super) size: u32,
    /// Whether it is a unilateral contact force along a normal.
    pub(super) pushes: bool,
}

/// The form of a force: a scalar or a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// It has components.
    Vector,
    /// It is one number.
    Scalar,
    /// It differs from body to body.
    Spread,
}

/// Positions at which quantities occur in expressions.
#[derive(Debug, Clone, Default)]
pub(super) struct Used {
    pub(super) parameters: BTreeSet<usize>,
    pub(super) coordinates: BTreeSet<usize>,
    pub(super) inputs: BTreeSet<usize>,
    pub(super) signals: BTreeSet<usize>,
}

impl Used {
    pub(super) fn add(&mut self, quantity: Quantity) {
        match quantity {
            Quantity::Parameter(id) => self.parameters.insert(id.index()),
            Quantity::Coordinate(id) | Quantity::Rate(id) => self.coordinates.insert(id.index()),
            Quantity::Input(id) => self.inputs.insert(id.index()),
            Quantity::Signal(id) => self.signals.insert(id.index()),
            Quantity::PseudoVelocity(_)
            | Quantity::Motion(_)
            | Quantity::Response(_)
            | Quantity::Time
            | Quantity::Pi => false,
        };
    }
}

/// The definitions that are being expanded, and the size of their expansions.
#[derive(Debug, Default)]
pub(super) struct Reading {
    /// By index, the innermost last.
    pub(super) open: Vec<usize>,
    /// Nested operations around the next expression.
    pub(super) depth: usize,
    /// Total number of terms from expanded names.
    pub(super) count: usize,
    /// Whether they are too many or too deep.
    pub(super) exceeded: bool,
    /// Definitions that occur somewhere.
    pub(super) used: BTreeSet<usize>,
    /// Definitions that depend on themselves.
    pub(super) circular: BTreeSet<usize>,
    /// Errors of definitions that do not depend on their uses.
    pub(super) findings: Vec<Diagnostic>,
}
