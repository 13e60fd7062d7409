//! An imperfection of a channel, a nuisance parameter of every hypothesis.

use appell_estimate::{Coordinate, Free, Unknown};

use crate::effects::Acts;

/// An imperfection of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Imperfection {
    /// How it acts.
    pub(super) acts: Acts,
    /// Its estimate under the best hypothesis.
    pub(super) found: f64,
}

impl Imperfection {
    /// Its prior, as wide as the estimate: without one it would imitate the missing effects of a wrong model.
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
