//! What the derivation finds wrong with a mechanism.

use appell_spec::Code;

/// The item of a spec that a finding is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// The mechanism as a whole.
    Mechanism,
    /// A parameter, by index.
    Parameter(usize),
    /// A coordinate, by index.
    Coordinate(usize),
    /// An input, by index.
    Input(usize),
    /// A frame, by index.
    Frame(usize),
    /// A point, by index.
    Point(usize),
    /// A body, by index.
    Body(usize),
    /// A constraint, by index.
    Constraint(usize),
    /// A pseudo-velocity, by index.
    PseudoVelocity(usize),
    /// A load, by index.
    Load(usize),
    /// An output, by index.
    Output(usize),
}

/// A mistake that only the derivation can see.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Diagnostic code.
    pub code: Code,
    /// What is wrong, one sentence.
    pub message: String,
    /// Where.
    pub item: Item,
    /// What to write instead.
    pub help: String,
}

/// Result of a stage of the derivation.
pub type Outcome<T> = Result<T, Vec<Finding>>;

/// A spec expression that divides by the number zero.
pub fn division_by_zero(item: Item) -> Finding {
    Finding {
        code: Code::DivisionByZero,
        message: "an expression divides by zero".to_owned(),
        item,
        help: "write the expression without the zero denominator".to_owned(),
    }
}
