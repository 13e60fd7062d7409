//! Resolved expressions: trees whose names have been replaced by what they refer to.

use std::ops::Range;

use num_rational::BigRational;

use crate::mechanism::{CoordinateId, InputId, ParameterId, SignalId, SpeedId};

/// A place in the spec text, in bytes.
pub type Span = Range<usize>;

/// An expression and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands in the spec.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Debug, Clone, PartialEq)]
pub enum ExprKind {
    /// An exact number in SI: `0.1` is one tenth.
    Number(BigRational),
    /// A named quantity.
    Quantity(Quantity),
    /// `-a`
    Negate(Box<Expr>),
    /// `a ∘ b`
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// A function of one or two arguments.
    Call(Function, Vec<Expr>),
    /// `if(a < b, then, otherwise)` and its kin.
    Choice {
        /// Relation between the two compared expressions.
        relation: Relation,
        /// Left and right side of the comparison.
        compared: Box<[Expr; 2]>,
        /// Value where the relation holds, and value elsewhere.
        branches: Box<[Expr; 2]>,
    },
}

/// What a name refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A parameter.
    Parameter(ParameterId),
    /// A coordinate.
    Coordinate(CoordinateId),
    /// The time derivative of a coordinate, `dot(q)`.
    Rate(CoordinateId),
    /// A pseudo-velocity.
    PseudoVelocity(SpeedId),
    /// An input.
    Input(InputId),
    /// A signal.
    Signal(SignalId),
    /// Time, `t`.
    Time,
    /// The circle constant, `pi`.
    Pi,
}

/// A binary operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `^`
    Power,
}

/// A comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterOrEqual,
}

/// The functions of the language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "each variant is the function of that name")]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
    Sign,
    Hypot,
    Min,
    Max,
    /// `smooth_abs(a, w) = sqrt(a² + w²)`: |a| rounded over the width `w`.
    SmoothAbs,
    /// `smooth_sign(a, w) = tanh(a / w)`: the sign of `a`, rounded over the width `w`.
    SmoothSign,
    /// `smooth_min(a, b, w)`: the smaller of two, rounded over the width `w`.
    SmoothMin,
    /// `smooth_max(a, b, w)`: the larger of two, rounded over the width `w`.
    SmoothMax,
}
