//! How many functions switch equations; [`Switching`](crate::model::Switching) tells which.

/// How many functions switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Answers of what time alone decides.
    pub answers: usize,
    /// Functions of time alone that rise and fall.
    pub shapes: usize,
    /// Functions of the state, and of inputs.
    pub crossings: usize,
    /// Functions of these that rise and fall.
    pub pulses: usize,
}

impl Counts {
    /// Whether nothing switches.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }
}
