//! Tie-breaking between equally frequent rewriting candidates.

use super::dag::Item;

/// Tie-breaking between two equally frequent candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Preference {
    /// The one closer to the arguments.
    Early,
    /// The one closer to the results.
    Late,
}

impl Preference {
    /// The candidate of higher rank is rewritten first.
    pub(super) fn rank(self, item: Item) -> u64 {
        let position = 2 * item.id.index() as u64 + u64::from(item.flip);
        match self {
            Self::Early => u64::MAX - position,
            Self::Late => position,
        }
    }
}
