//! Resolved expressions: trees whose names have been replaced by references.

/// Words of the language: an enum, and a row for each with its name in a spec and something else.
macro_rules! words {
    (
        $(#[$about_all:meta])*
        $words:ident, $other:ty;
        $($(#[$about:meta])* $variant:ident $name:literal $more:literal)*
    ) => {
        $(#[$about_all])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $words {
            $($(#[$about])* $variant,)*
        }

        impl $words {
            /// Each with its name and the rest of its row, in the order of the enum.
            pub const ALL: &'static [(Self, &'static str, $other)] =
                &[$((Self::$variant, $name, $more),)*];

            /// That of a name.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().find(|row| row.1 == name).map(|row| row.0)
            }

            /// Name in a spec.
            pub fn name(self) -> &'static str {
                Self::ALL[self as usize].1
            }
        }
    };
}

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

words! {
    /// The functions of the language, with their numbers of arguments.
    #[expect(missing_docs, reason = "each variant is the function of that name")]
    Function, usize;
    Sin "sin" 1
    Cos "cos" 1
    Tan "tan" 1
    Asin "asin" 1
    Acos "acos" 1
    Atan "atan" 1
    Atan2 "atan2" 2
    Sinh "sinh" 1
    Cosh "cosh" 1
    Tanh "tanh" 1
    Exp "exp" 1
    Ln "ln" 1
    Sqrt "sqrt" 1
    Abs "abs" 1
    Sign "sign" 1
    Hypot "hypot" 2
    Min "min" 2
    Max "max" 2
    /// `smooth_abs(a, w) = sqrt(a² + w²)`: |a| rounded over the width `w`.
    SmoothAbs "smooth_abs" 2
    /// `smooth_sign(a, w) = tanh(a / w)`: the sign of `a`, rounded over the width `w`.
    SmoothSign "smooth_sign" 2
    /// `smooth_min(a, b, w)`: the smaller of two, rounded over the width `w`.
    SmoothMin "smooth_min" 3
    /// `smooth_max(a, b, w)`: the larger of two, rounded over the width `w`.
    SmoothMax "smooth_max" 3
}

impl Function {
    /// Number of arguments.
    pub fn arity(self) -> usize {
        Self::ALL[self as usize].2
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
