//! What names in expressions mean, and which quantities occur there.

use std::collections::BTreeSet;

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
    /// Outputs share the names, but expressions cannot use them.
    Output,
}

/// Places of what occurs in expressions.
#[derive(Debug, Default)]
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
            Quantity::PseudoVelocity(_) | Quantity::Motion(_) | Quantity::Time | Quantity::Pi => {
                false
            }
        };
    }
}
