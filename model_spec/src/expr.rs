//! Resolved expressions: trees whose names have been replaced by references.

mod named;
mod value;

use std::ops::Range;

use num_rational::BigRational;

use crate::ids::{CoordinateId, InputId, ParameterId, SignalId, SpeedId};

pub use named::{Motion, Response, Word};

/// A place in the spec text, in bytes.
pub type Span = Range<usize>;

/// An expression and its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Expr {
    /// Its form.
    pub kind: ExprKind,
    /// Its position in the spec.
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
    /// `if(a < b, then, otherwise)`, also with the other relations.
    Choice {
        /// Relation between the two compared expressions.
        relation: Relation,
        /// Left and right side of the comparison.
        compared: Box<[Expr; 2]>,
        /// Value where the relation holds, and value elsewhere.
        branches: Box<[Expr; 2]>,
    },
}

/// The quantity to which a name refers.
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
    /// A kinematic quantity of a point or a frame.
    Motion(Motion),
    /// An acceleration or a force, which the equations of motion have to be solved for.
    Response(Response),
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

impl Function {
    /// Every function with its name and number of arguments.
    pub const ALL: &'static [(Self, &'static str, usize)] = &[
        (Self::Sin, "sin", 1),
        (Self::Cos, "cos", 1),
        (Self::Tan, "tan", 1),
        (Self::Asin, "asin", 1),
        (Self::Acos, "acos", 1),
        (Self::Atan, "atan", 1),
        (Self::Atan2, "atan2", 2),
        (Self::Sinh, "sinh", 1),
        (Self::Cosh, "cosh", 1),
        (Self::Tanh, "tanh", 1),
        (Self::Exp, "exp", 1),
        (Self::Ln, "ln", 1),
        (Self::Sqrt, "sqrt", 1),
        (Self::Abs, "abs", 1),
        (Self::Sign, "sign", 1),
        (Self::Hypot, "hypot", 2),
        (Self::Min, "min", 2),
        (Self::Max, "max", 2),
        (Self::SmoothAbs, "smooth_abs", 2),
        (Self::SmoothSign, "smooth_sign", 2),
        (Self::SmoothMin, "smooth_min", 3),
        (Self::SmoothMax, "smooth_max", 3),
    ];

    /// The function of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// Name in a spec.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|row| row.0 == self)
            .map_or("", |row| row.1)
    }

    /// Number of arguments.
    pub fn arity(self) -> usize {
        Self::ALL
            .iter()
            .find(|row| row.0 == self)
            .map_or(0, |row| row.2)
    }
}

impl BinaryOp {
    /// As written in a spec.
    pub const fn symbol(self) -> char {
        match self {
            Self::Add => '+',
            Self::Subtract => '-',
            Self::Multiply => '*',
            Self::Divide => '/',
            Self::Power => '^',
        }
    }
}

impl Relation {
    /// As written in a spec.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
        }
    }
}

impl Expr {
    /// An integer.
    pub fn integer(value: i64, span: Span) -> Self {
        Self {
            kind: ExprKind::Number(BigRational::from_integer(value.into())),
            span,
        }
    }

    /// The expressions of which it consists, from left to right.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            ExprKind::Number(_) | ExprKind::Quantity(_) => Vec::new(),
            ExprKind::Negate(a) => vec![a],
            ExprKind::Binary(_, a, b) => vec![a, b],
            ExprKind::Call(_, arguments) => arguments.iter().collect(),
            ExprKind::Choice {
                compared, branches, ..
            } => compared.iter().chain(branches.iter()).collect(),
        }
    }

    /// Visits every quantity of the expression, from left to right.
    pub fn visit(&self, seen: &mut dyn FnMut(Quantity)) {
        if let ExprKind::Quantity(quantity) = &self.kind {
            seen(*quantity);
        }
        for part in self.parts() {
            part.visit(seen);
        }
    }
}
