//! Values with their positions.

use appell_spec::expr::Span;

/// A text with its place in the study file, which its `Debug` leaves out.
#[derive(Clone, PartialEq, Eq)]
pub struct Text {
    /// The text; of a number its digits.
    pub text: String,
    /// Its position, quotes included.
    pub at: Span,
}

impl std::fmt::Debug for Text {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.text.fmt(f)
    }
}

/// A value with its place in the study file, which its `Debug` leaves out.
#[derive(Clone, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its position.
    pub at: Span,
}

impl<T: std::fmt::Debug> std::fmt::Debug for Placed<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.value.fmt(f)
    }
}

/// A pair of factors with the correlation of their normal scores.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Their names.
    pub pair: [Text; 2],
    /// From −1 to 1.
    pub value: Placed<f64>,
}

/// A name with a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// The name.
    pub name: Text,
    /// The value.
    pub value: Text,
}
