//! A function as straight-line code of vector operations.

use crate::symbolic::{Function, Relation};
use crate::tape::Arithmetic;

/// A value, numbered in the order of the tape: operands come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Id(pub(super) u32);

impl Id {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Arrays of blocks that a function receives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Array {
    Time,
    States,
    Inputs,
    Parameters,
    Weights,
}

/// The definition of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// An entry of an argument.
    Argument(Array, u32),
    /// A number in every lane, by its bits.
    Constant(u64),
    /// An operation on two values.
    Binary(Binary, Id, Id),
    /// Square root.
    Sqrt(Id),
    /// `branches[0]` where the relation of `compared` holds, `branches[1]` otherwise and for NaN.
    Choice {
        relation: Relation,
        compared: [Id; 2],
        branches: [Id; 2],
    },
    /// A result of a call, by the call and the position among its results.
    Result(u32, u32),
}

impl Node {
    /// Whether it is in memory from the start.
    pub(super) fn is_leaf(self) -> bool {
        matches!(self, Self::Argument(..) | Self::Constant(_))
    }

    /// Its operands, in instruction order.
    pub(super) fn operands(self) -> impl Iterator<Item = Id> {
        let operands = match self {
            Self::Argument(..) | Self::Constant(_) | Self::Result(..) => [None; 4],
            Self::Sqrt(a) => [Some(a), None, None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None, None],
            Self::Choice {
                compared: [a, b],
                branches: [c, d],
                ..
            } => [a, b, c, d].map(Some),
        };
        operands.into_iter().flatten()
    }
}

/// Operations of one instruction with two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Binary {
    Arithmetic(Arithmetic),
    /// Bitwise and.
    And,
    /// Bitwise exclusive or.
    Xor,
}

impl Binary {
    /// Whether exchanging the operands leaves the result bit-identical.
    pub(super) fn is_commutative(self) -> bool {
        !matches!(
            self,
            Self::Arithmetic(Arithmetic::Subtract | Arithmetic::Divide)
        )
    }
}

/// A routine that machine code calls with addresses of blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Routine {
    /// A function of one block; [`Function::Sqrt`] and the like are instructions instead.
    Unary(Function),
    /// Sine and cosine, one block after the other.
    SinCos,
    /// Angle of (second, first).
    Atan2,
    /// The first to the power of the second.
    Power,
    /// Solution of a linear system with the given number of rows. Its matrix and right-hand side are
    /// contiguous.
    System(u32),
}

/// A call.
#[derive(Debug, Clone)]
pub(super) struct Call {
    pub(super) routine: Routine,
    /// Arguments of the routine.
    pub(super) given: Vec<Id>,
    /// Its results, in order.
    pub(super) results: Vec<Id>,
}

/// An action in order of execution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Action {
    /// Computes a value.
    Compute(Id),
    /// Calls a routine.
    Call(u32),
    /// Stores a value to an entry of a result: value, result, entry.
    Store(Id, u32, u32),
}

/// Straight-line code.
#[derive(Debug)]
pub(super) struct Line {
    /// Definitions of the values.
    pub(super) nodes: Vec<Node>,
    /// The calls among the actions.
    pub(super) calls: Vec<Call>,
    /// Live actions.
    pub(super) actions: Vec<Action>,
}

impl Line {
    /// The operands of an action, in instruction order.
    pub(super) fn operands(&self, action: Action) -> impl Iterator<Item = Id> {
        let (node, given, stored) = match action {
            Action::Compute(id) => (Some(self.nodes[id.index()]), &[][..], None),
            Action::Call(call) => (None, &self.calls[call as usize].given[..], None),
            Action::Store(id, ..) => (None, &[][..], Some(id)),
        };
        let node = node.into_iter().flat_map(Node::operands);
        node.chain(given.iter().copied()).chain(stored)
    }
}
