//! Findings: errors and warnings of the derivation.

use appell_spec::Code;
use appell_spec::mechanism::{
    BodyId, ConstraintId, CoordinateId, FrameId, InputId, LoadId, OutputId, ParameterId, PointId,
    SpeedId,
};

/// The item of a spec that a finding is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// The mechanism as a whole.
    Mechanism,
    /// A parameter.
    Parameter(ParameterId),
    /// A coordinate.
    Coordinate(CoordinateId),
    /// An input.
    Input(InputId),
    /// A frame.
    Frame(FrameId),
    /// A point.
    Point(PointId),
    /// A body.
    Body(BodyId),
    /// A constraint.
    Constraint(ConstraintId),
    /// A pseudo-velocity.
    PseudoVelocity(SpeedId),
    /// A load.
    Load(LoadId),
    /// An output.
    Output(OutputId),
}

/// A mistake that is detected only in the derivation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Diagnostic code.
    pub code: Code,
    /// The problem, one sentence.
    pub message: String,
    /// The item concerned.
    pub item: Item,
    /// How to fix it.
    pub help: String,
}

/// Result of a stage of the derivation.
pub type Outcome<T> = Result<T, Vec<Finding>>;

/// The value of an expression of `item`; `None` is a division by the number zero.
pub fn defined<T>(value: Option<T>, item: Item) -> Outcome<T> {
    value.ok_or_else(|| vec![division_by_zero(item)])
}

/// Fails if there are findings.
pub fn unless_any(findings: Vec<Finding>) -> Outcome<()> {
    if findings.is_empty() {
        Ok(())
    } else {
        Err(findings)
    }
}

/// Names in a sentence: `` `a`, `b` ``.
pub fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

/// A spec expression that divides by the number zero.
pub fn division_by_zero(item: Item) -> Finding {
    Finding {
        code: Code::DivisionByZero,
        message: "an expression divides by zero".to_owned(),
        item,
        help: "write the expression without the zero denominator".to_owned(),
    }
}
