//! The program of one function: straight-line code, in which operation `i` computes value `i` from earlier values.
//!
//! The scheduler writes it. The interpreter, the compilers, the emitted languages and the transformations read it;
//! each is one loop with one match over the operations. All execute the same operations in the same order: with the
//! same elementary functions, results have equal bits.
//!
//! | file | contents |
//! |---|---|
//! | `live.rs` | dead-code elimination; the order of the emitted text |
//! | `interpret.rs`, `cost.rs` | interpreter, bounds over intervals; operation counts |
//! | `without.rs` | partial evaluation for parameters that are zero |
//! | `unique.rs`, `closed_loop.rs` | common subexpressions; composition with a control law |

mod closed_loop;
mod cost;
mod interpret;
mod live;
mod unique;
mod without;

pub use closed_loop::{Seen, closed_loop};
pub use cost::OperationCount;
pub use interpret::{enclose, enclose_along, interpret, interpret_into, interpret_weighted};
pub use unique::Unique;

use crate::symbolic::{Function, Rational, Relation};

/// A value of a [`Tape`], by the operation that computes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub struct Value(pub u32);

impl Value {
    /// Its index among the operations.
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// A part of the operation with this value.
    #[must_use]
    pub fn part(self, index: u32) -> Self {
        Self(self.0.saturating_add(1).saturating_add(index))
    }
}

/// An argument of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
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

impl Argument {
    /// Whether both are entries of the same vector.
    pub(crate) fn is_like(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }
}

/// An operation on earlier values.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub enum Operation {
    /// An argument.
    Argument(Argument),
    /// An exact number, rounded once to the scalar type.
    Constant(Rational),
    /// `-a`
    Negate(Value),
    /// `a ∘ b`
    Binary(Arithmetic, Value, Value),
    /// A function of one argument.
    Function(Function, Value),
    /// `atan2(y, x)`
    Atan2(Value, Value),
    /// `base^exponent`
    Power(Value, Value),
    /// A select between two values; both are computed.
    Choice {
        /// Relation.
        relation: Relation,
        /// Left and right side of the relation.
        compared: [Value; 2],
        /// Value if it holds, value otherwise.
        branches: [Value; 2],
    },
    /// Sine and cosine of an angle. The next two operations are its parts.
    SinCos(Value),
    /// The pivoted factorisation of a square matrix, row by row.
    Factorise(Vec<Value>),
    /// The solution of a factorised system with this right-hand side. The next operations are its parts, one for
    /// each unknown.
    Solve {
        /// The factorisation.
        factorisation: Value,
        /// Right-hand side.
        right: Vec<Value>,
    },
    /// A part of an operation that computes several numbers.
    Part(Value, u32),
}

impl Operation {
    /// Whether it computes nothing: an argument or a number.
    pub fn is_leaf(&self) -> bool {
        matches!(self, Self::Argument(_) | Self::Constant(_))
    }

    /// Whether it computes one number, which others may use as an operand.
    pub fn is_number(&self) -> bool {
        !matches!(
            self,
            Self::SinCos(_) | Self::Factorise(_) | Self::Solve { .. }
        )
    }

    /// How many numbers it computes as parts.
    pub fn parts(&self) -> usize {
        match self {
            Self::SinCos(_) => 2,
            Self::Solve { right, .. } => right.len(),
            _ => 0,
        }
    }

    /// Its operands, in order.
    pub fn operands(&self) -> Vec<Value> {
        let mut operands = Vec::new();
        self.for_each_operand(|operand| operands.push(operand));
        operands
    }

    /// Visits its operands in order.
    pub fn for_each_operand(&self, mut visit: impl FnMut(Value)) {
        match self {
            Self::Argument(_) | Self::Constant(_) => {}
            Self::Negate(a) | Self::Function(_, a) | Self::SinCos(a) | Self::Part(a, _) => {
                visit(*a);
            }
            Self::Binary(_, a, b) | Self::Atan2(a, b) | Self::Power(a, b) => {
                [*a, *b].into_iter().for_each(visit);
            }
            Self::Choice {
                compared, branches, ..
            } => compared.iter().chain(branches).copied().for_each(visit),
            Self::Factorise(matrix) => matrix.iter().copied().for_each(visit),
            Self::Solve {
                factorisation,
                right,
            } => {
                visit(*factorisation);
                right.iter().copied().for_each(visit);
            }
        }
    }

    /// The same operation on other operands.
    #[must_use]
    pub fn map_operands(&self, mut of: impl FnMut(Value) -> Value) -> Self {
        match self {
            Self::Argument(_) | Self::Constant(_) => self.clone(),
            Self::Negate(a) => Self::Negate(of(*a)),
            Self::Binary(operation, a, b) => Self::Binary(*operation, of(*a), of(*b)),
            Self::Function(function, a) => Self::Function(*function, of(*a)),
            Self::Atan2(y, x) => Self::Atan2(of(*y), of(*x)),
            Self::Power(base, exponent) => Self::Power(of(*base), of(*exponent)),
            Self::Choice {
                relation,
                compared,
                branches,
            } => Self::Choice {
                relation: *relation,
                compared: compared.map(&mut of),
                branches: branches.map(&mut of),
            },
            Self::SinCos(angle) => Self::SinCos(of(*angle)),
            Self::Factorise(matrix) => Self::Factorise(matrix.iter().map(|&a| of(a)).collect()),
            Self::Solve {
                factorisation,
                right,
            } => Self::Solve {
                factorisation: of(*factorisation),
                right: right.iter().map(|&a| of(a)).collect(),
            },
            Self::Part(whole, index) => Self::Part(of(*whole), *index),
        }
    }
}

/// The four operations of arithmetic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub enum Arithmetic {
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
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub struct ResultArray {
    /// Its name.
    pub name: String,
    /// Entries, row by row.
    pub entries: Vec<Value>,
}

impl ResultArray {
    /// The same array of other values.
    #[must_use]
    pub fn map(&self, of: impl Fn(Value) -> Value) -> Self {
        Self {
            name: self.name.clone(),
            entries: self.entries.iter().map(|&entry| of(entry)).collect(),
        }
    }
}

/// The program of one function.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub struct Tape {
    /// The operations.
    pub operations: Vec<Operation>,
    /// Results, in the order of the function.
    pub results: Vec<ResultArray>,
    /// By value: a unique identifier. Text writes values without one where they are used.
    pub names: Vec<Option<String>>,
    /// Headings of the emitted text, each before the statement of a value.
    pub headings: Vec<(Value, String)>,
}

impl Tape {
    /// The operation that computes a value.
    pub fn operation(&self, value: Value) -> &Operation {
        &self.operations[value.index()]
    }

    /// The identifier of a value.
    pub fn name(&self, value: Value) -> Option<&str> {
        self.names[value.index()].as_deref()
    }

    /// The operation of a value that has no name.
    pub fn unnamed(&self, value: Value) -> Option<&Operation> {
        match self.name(value) {
            None => Some(self.operation(value)),
            Some(_) => None,
        }
    }

    /// Adds an operation with its parts.
    pub fn push(&mut self, operation: Operation) -> Value {
        let parts = operation.parts();
        let value = self.push_alone(operation);
        for part in (0..).take(parts) {
            self.push_alone(Operation::Part(value, part));
        }
        value
    }

    /// Adds an operation whose parts are to be added next.
    pub fn push_alone(&mut self, operation: Operation) -> Value {
        // A longer function would not fit into memory.
        let value = Value(u32::try_from(self.operations.len()).unwrap_or(u32::MAX));
        self.operations.push(operation);
        self.names.push(None);
        value
    }

    /// An argument.
    pub fn argument(&mut self, argument: Argument) -> Value {
        self.push(Operation::Argument(argument))
    }

    /// A number.
    pub fn constant(&mut self, number: Rational) -> Value {
        self.push(Operation::Constant(number))
    }

    /// `a ∘ b`
    pub fn binary(&mut self, operation: Arithmetic, a: Value, b: Value) -> Value {
        self.push(Operation::Binary(operation, a, b))
    }

    /// The arguments that are used, in the order of the program.
    pub fn arguments(&self) -> Vec<Argument> {
        let used = self
            .operations
            .iter()
            .filter_map(|operation| match operation {
                Operation::Argument(argument) => Some(*argument),
                _ => None,
            });
        let mut used: Vec<Argument> = used.collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// Whether the results depend on parameters.
    pub fn has_parameters(&self) -> bool {
        let is_parameter =
            |one: &Operation| matches!(one, Operation::Argument(Argument::Parameter(_)));
        self.operations.iter().any(is_parameter)
    }

    /// Lengths of the results.
    pub fn lengths(&self) -> Vec<usize> {
        self.results
            .iter()
            .map(|result| result.entries.len())
            .collect()
    }
}
