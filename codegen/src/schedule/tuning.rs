//! The cost model and the effort of the search for a schedule.

/// The cost model and the effort of the search for a schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tuning {
    /// Cost of a division in operations. From about 5 on, independent denominators share one
    /// division; that pays in vector registers.
    pub division: usize,
    /// Budget of nodes that the search processes. The default suffices to try every plan on small
    /// functions; on large ones only the first two plans are tried.
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
