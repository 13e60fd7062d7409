//! Instructions with their registers and memory operands.

use super::line::{Array, Binary, Routine};
use crate::symbolic::Relation;

/// A vector register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Register(pub(super) u8);

/// A block in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Memory {
    /// An entry of an argument.
    Argument(Array, u32),
    /// A constant after the code, by its bits.
    Constant(u64),
    /// A block of the frame.
    Slot(u32),
}

/// The last source operand: a register or memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operand {
    Register(Register),
    Memory(Memory),
}

/// An instruction; all but calls and stores are single machine instructions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Instruction {
    Load {
        to: Register,
        from: Memory,
    },
    /// Spills a register to a block of the frame.
    Keep {
        slot: u32,
        from: Register,
    },
    /// Stores a register to an entry of a result.
    Store {
        result: u32,
        entry: u32,
        from: Register,
    },
    Binary {
        operation: Binary,
        to: Register,
        left: Register,
        right: Operand,
    },
    Sqrt {
        to: Register,
        of: Operand,
    },
    /// Compares into the mask.
    Compare {
        relation: Relation,
        /// Whether `right` is the left side of the relation.
        swapped: bool,
        left: Register,
        right: Operand,
    },
    /// `then` where the mask is set.
    Select {
        to: Register,
        then: Operand,
        otherwise: Register,
    },
    /// Calls a routine with the addresses of its arguments and of its results. All vector registers are
    /// clobbered.
    Call {
        routine: Routine,
        given: Vec<Memory>,
        results: u32,
    },
}
