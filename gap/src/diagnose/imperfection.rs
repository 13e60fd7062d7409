//! An imperfection of a channel that is fitted beside every hypothesis.

use appell_estimate::{Coordinate, Free, Unknown};

use crate::effects::Acts;

/// An imperfection of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Imperfection {
    /// How it acts.
    pub(super) acts: Acts,
    /// What was found beside the best hypothesis.
    pub(super) found: f64,
}

impl Imperfection {
    /// What is expected of it: no more than was found. Beside a wrong model it would imitate what that lacks.
    pub(super) fn expected(&self, free: Free) -> Free {
        match free.coordinate {
            Coordinate::Plain => {
                let perfect = perfect(free.unknown);
                free.around(perfect, (self.found - perfect).abs())
            }
            Coordinate::Logarithm => free.around(self.found, 1.0),
        }
    }
}

/// The value of a perfect channel.
pub(super) fn perfect(unknown: Unknown) -> f64 {
    if matches!(unknown, Unknown::Scale(_)) {
        1.0
    } else {
        0.0
    }
}
