//! Axes of frames.

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// First axis.
    X,
    /// Second axis.
    Y,
    /// Third axis.
    Z,
}

impl Axis {
    /// Their letters in specs.
    pub const LETTERS: [&str; 3] = ["x", "y", "z"];

    /// Its index among the components of a vector.
    pub const fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// Its letter in specs.
    pub const fn letter(self) -> &'static str {
        Self::LETTERS[self.index()]
    }
}
