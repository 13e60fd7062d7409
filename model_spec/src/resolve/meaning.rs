//! What names in expressions mean, which quantities occur there, and the definitions on the way.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostic;
use crate::expr::{Quantity, Span};
use crate::units::Dimension;

/// What a name in an expression means.
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
    /// Outputs share the names, but expressions cannot use them.
    Output,
}

/// What is known of the force of a load or of a constraint when an expression names it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Acting {
    /// What an expression can name of it.
    pub(super) shape: Shape,
    /// `None` while it is not known.
    pub(super) dimension: Option<Dimension>,
    /// Bound on the polynomial degree.
    pub(super) size: u32,
    /// Whether it can only push, along a normal.
    pub(super) pushes: bool,
}

/// The number that a force is, or the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// It has components.
    Vector,
    /// It is one number.
    Scalar,
    /// It acts on every body in another way.
    Spread,
}

/// Places of what occurs in expressions.
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

/// The definitions whose expressions are being read, and what they have added.
#[derive(Debug, Default)]
pub(super) struct Reading {
    /// By index, the innermost last.
    pub(super) open: Vec<usize>,
    /// Nested operations around the next expression.
    pub(super) depth: usize,
    /// Terms that stand for names, in all.
    pub(super) count: usize,
    /// Whether they are too many or too deep.
    pub(super) exceeded: bool,
    /// Definitions that occur somewhere.
    pub(super) used: BTreeSet<usize>,
    /// Definitions that lead back to themselves.
    pub(super) circular: BTreeSet<usize>,
    /// What is wrong with definitions wherever they are used.
    pub(super) findings: Vec<Diagnostic>,
}
