//! From expressions to a sequence of named operations; it knows no target language.
//!
//! The emitted Rust, the in-process compiler and the interpreter all follow a [`Schedule`] to the
//! letter: same operations, same order, so they agree to the last bits of the elementary functions.

mod bind;
mod cancel;
mod cost;
mod dag;
mod divide;
mod dump;
mod factor;
mod gather;
mod interpret;
mod lower;
mod meet;
mod monomial;
pub(crate) mod names;
mod outline;
pub(crate) mod pi;
pub(crate) mod piece;
mod rebuild;
mod scale;
mod search;
mod share;
mod signs;

pub use cost::OperationCount;
pub use interpret::{interpret, interpret_weighted};
pub use pi::pi;

use crate::program::{self, Program};
use crate::symbolic::{Function, Rational, Relation};

/// What schedules are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tuning {
    /// A division takes as long as so many other operations. From about 5 on, independent
    /// denominators share one division; that pays in vector registers.
    pub division: usize,
    /// Nodes that the search may pass over. Small functions try every plan within the default;
    /// large ones only the two most promising plans.
    pub effort: usize,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            division: 3,
            effort: 400,
        }
    }
}

/// The operations of one function of a program, as few as are found.
///
/// # Panics
///
/// If an expression contains a symbol that is not an argument of the program, which the derivation
/// must not let happen.
pub fn schedule(program: &Program, function: &program::Function) -> Schedule {
    schedule_tuned(program, function, Tuning::default())
}

/// [`schedule`] for other costs, or with more patience.
///
/// # Panics
///
/// As [`schedule`].
pub fn schedule_tuned(program: &Program, function: &program::Function, tuning: Tuning) -> Schedule {
    let derived = lower::lower(program, function);
    let cheapest = search::cheapest(&derived, tuning);
    let hints = meet::known_values(&cheapest, &lower::hints(program));
    bind::bind(program, function, &cheapest, hints)
}

/// The operations of one function, in order.
#[derive(Debug, Clone)]
pub struct Schedule {
    /// Arguments that are used, in the order of the program.
    pub arguments: Vec<Argument>,
    /// Steps; each defines values that later ones use.
    pub steps: Vec<Step>,
    /// Results, in the order of the function.
    pub results: Vec<ResultArray>,
    /// Names of the values, by [`Value`]; unique identifiers in the function.
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
}

/// A step.
#[derive(Debug, Clone)]
pub enum Step {
    /// `let value = tree;`
    Let {
        /// What is defined.
        value: Value,
        /// How it is computed.
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
    /// Unknowns of a factorised system.
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

/// What a step computes: a small tree, evaluated left to right exactly as written.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Tree {
    /// An earlier value.
    Value(Value),
    /// An argument.
    Argument(Argument),
    /// An exact number, rounded to the scalar once.
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
    /// A choice between two values; both are computed.
    Choice {
        /// Relation.
        relation: Relation,
        /// Left and right side of the relation.
        compared: Box<[Tree; 2]>,
        /// Value where it holds, value elsewhere.
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

impl Schedule {
    /// The steps as text, one a line.
    pub fn dump(&self, program: &Program) -> String {
        dump::dump(self, &names::ArgumentNames::of(program))
    }
}
