//! Numbers of switching functions; see [`Switching`](crate::model::Switching).

/// Numbers of switching functions and of functions with pulses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Signs and truth values that depend on time alone.
    pub answers: usize,
    /// Functions of time alone with pulses.
    pub shapes: usize,
    /// Switching functions of the state and of inputs.
    pub crossings: usize,
    /// Functions of these with pulses.
    pub pulses: usize,
}

impl Counts {
    /// Whether there are none.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }
}
