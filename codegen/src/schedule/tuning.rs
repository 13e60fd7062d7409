//! What schedules are made for.

/// What schedules are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tuning {
    /// A division takes as long as so many other operations. From about 5 on, independent
    /// denominators share one division; that pays in vector registers.
    pub division: usize,
    /// Nodes that the search may pass over. Small functions try every plan within the default;
    /// large ones only the two most promising plans.
    pub effort: usize,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            division: 3,
            effort: 400,
        }
    }
}
