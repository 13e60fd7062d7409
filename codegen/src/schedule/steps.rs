//! A function as a sequence of named operations.

use crate::symbolic::{Function, Rational, Relation};

/// The operations of one function, in order.
#[derive(Debug, Clone)]
pub struct Schedule {
    /// Arguments that are used, in the order of the program.
    pub arguments: Vec<Argument>,
    /// Steps; each defines values that later ones use.
    pub steps: Vec<Step>,
    /// Results, in the order of the function.
    pub results: Vec<ResultArray>,
    /// Unique identifiers of the values, indexed by [`Value`].
    pub names: Vec<String>,
}

/// A value that a step defines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(pub u32);

/// An argument of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Argument {
    /// Time.
    Time,
    /// State by index.
    State(u32),
    /// Input by index.
    Input(u32),
    /// Parameter by index.
    Parameter(u32),
    /// Weight of an adjoint by index.
    Weight(u32),
    /// Weight of an adjoint of the outputs by index.
    OutputWeight(u32),
    /// Given pseudo-acceleration by index.
    Acceleration(u32),
}

/// A step.
#[derive(Debug, Clone)]
pub enum Step {
    /// `let value = tree;`
    Let {
        /// The defined value.
        value: Value,
        /// Its expression.
        tree: Tree,
    },
    /// `let (sin, cos) = angle.sin_cos();`
    SinCos {
        /// Sine.
        sin: Value,
        /// Cosine.
        cos: Value,
        /// Angle.
        angle: Tree,
    },
    /// Pivoted factorisation of a square matrix.
    Factor {
        /// Number of the factorisation, counted from 0 in this function.
        factorisation: u32,
        /// Rows of the matrix.
        size: usize,
        /// Entries, row by row.
        matrix: Vec<Tree>,
    },
    /// Solution of a factorised system.
    Solve {
        /// The factorisation.
        factorisation: u32,
        /// Unknowns, one per row.
        values: Vec<Value>,
        /// Right-hand side.
        right: Vec<Tree>,
    },
    /// A paragraph of the emitted text starts here.
    Paragraph {
        /// Heading, one line.
        title: String,
    },
}

/// The expression of a step: a small tree, evaluated left to right exactly as written.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Tree {
    /// An earlier value.
    Value(Value),
    /// An argument.
    Argument(Argument),
    /// An exact number, rounded once to the scalar type.
    Constant(Rational),
    /// `-a`
    Negate(Box<Tree>),
    /// `a ∘ b`
    Binary(Operation, Box<Tree>, Box<Tree>),
    /// A function of one argument.
    Function(Function, Box<Tree>),
    /// `atan2(y, x)`
    Atan2(Box<Tree>, Box<Tree>),
    /// `base^exponent`
    Power(Box<Tree>, Box<Tree>),
    /// A select between two values; both are computed.
    Choice {
        /// Relation.
        relation: Relation,
        /// Left and right side of the relation.
        compared: Box<[Tree; 2]>,
        /// Value if it holds, value otherwise.
        branches: Box<[Tree; 2]>,
    },
}

/// The four operations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operation {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

/// A result array.
#[derive(Debug, Clone)]
pub struct ResultArray {
    /// Its name.
    pub name: String,
    /// Entries, row by row: constants, arguments or values (possibly negated).
    pub entries: Vec<Tree>,
}
