//! The nodes of the expression graph.

use super::Rational;

/// An expression: the index of a canonical node in its [`Graph`](super::Graph).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Expr(pub(super) u32);

/// A symbol: a parameter, a coordinate or another quantity without a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SymbolId(pub u32);

/// The kinds of expressions.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Node {
    /// An exact number.
    Number(Rational),
    /// A symbol.
    Symbol(SymbolId),
    /// An intermediate quantity with a name and a definition; see [`Graph::name`](super::Graph::name). Sums
    /// and products are not flattened through it.
    Named(u32),
    /// `Σ coefficient · expr`, ordered by `expr`. The constant is the coefficient of the number 1.
    /// A lone term has a coefficient other than 1.
    Sum(Box<[Term]>),
    /// `Π base^exponent`, ordered by `base`, without a numeric coefficient. A lone factor has an
    /// exponent other than 1. Sums among the bases are primitive with a positive first coefficient.
    Product(Box<[Factor]>),
    /// A function of one argument.
    Function(Function, Expr),
    /// `atan2(y, x)`.
    Atan2(Expr, Expr),
    /// `base^exponent` with an exponent that is not an integer.
    Power(Expr, Expr),
    /// `then` if the relation holds between the two compared expressions, else `otherwise`.
    Choice {
        /// Relation.
        relation: Relation,
        /// Left and right side of the relation.
        compared: [Expr; 2],
        /// Value if it holds, value otherwise.
        branches: [Expr; 2],
    },
    /// One unknown of a linear system that is solved numerically.
    Solution {
        /// Index of the system; see [`Graph::system`](super::Graph::system).
        system: u32,
        /// Row of the unknown.
        row: u32,
    },
}

/// A term of a sum.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Term {
    /// The multiplicand; the number 1 for the constant.
    pub expr: Expr,
    /// Its coefficient, not zero.
    pub coefficient: Rational,
}

/// A factor of a product.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Factor {
    /// The base of the power.
    pub base: Expr,
    /// Its exponent, not zero.
    pub exponent: i32,
}

/// Functions of one argument. The tangent is a quotient of sine and cosine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "each variant is the function of that name")]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub enum Function {
    Sin,
    Cos,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
    Sign,
}

impl Function {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Sinh => "sinh",
            Self::Cosh => "cosh",
            Self::Tanh => "tanh",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Sqrt => "sqrt",
            Self::Abs => "abs",
            Self::Sign => "sign",
        }
    }
}

/// The method of a number that has the name of a function, at `$x`.
macro_rules! applied {
    ($function:expr, $x:expr) => {
        match $function {
            Function::Sin => $x.sin(),
            Function::Cos => $x.cos(),
            Function::Asin => $x.asin(),
            Function::Acos => $x.acos(),
            Function::Atan => $x.atan(),
            Function::Sinh => $x.sinh(),
            Function::Cosh => $x.cosh(),
            Function::Tanh => $x.tanh(),
            Function::Exp => $x.exp(),
            Function::Ln => $x.ln(),
            Function::Sqrt => $x.sqrt(),
            Function::Abs => $x.abs(),
            Function::Sign => $x.sign(),
        }
    };
}

pub(crate) use applied;

/// Comparisons of a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
}

/// A named intermediate quantity.
#[derive(Debug, Clone)]
pub struct Definition {
    /// Its name, an ASCII identifier.
    pub name: String,
    /// Its definition.
    pub value: Expr,
    /// Whether differentiation generated it; such a name is displayed only for a value with several uses.
    pub automatic: bool,
}

/// A square linear system, solved with pivoting when the equations are evaluated.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct System {
    /// Matrix, row by row.
    pub matrix: Box<[Expr]>,
    /// Right-hand side.
    pub right: Box<[Expr]>,
}
