//! Which of two candidates for a rewriting goes first.

use super::dag::Item;

/// Which of two equally frequent candidates goes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Preference {
    /// The one nearer to the arguments.
    Early,
    /// The one nearer to the results.
    Late,
}

impl Preference {
    /// The higher rank goes first.
    pub(super) fn rank(self, item: Item) -> u64 {
        let position = 2 * item.id.index() as u64 + u64::from(item.flip);
        match self {
            Self::Early => u64::MAX - position,
            Self::Late => position,
        }
    }
}
