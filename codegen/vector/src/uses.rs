//! Next-use information.

use appell_codegen::tape::{Operation, Tape, Value};

use super::order::{Action, Store};

/// No further use.
pub(crate) const NEVER: u32 = u32::MAX;

/// Uses are numbered in the order of execution.
pub(crate) struct Uses {
    /// By use: the next use of the same value.
    following: Vec<u32>,
    /// The next use of each value.
    next: Vec<u32>,
    /// The number of finished uses.
    pub(crate) now: u32,
}

/// Visits the operands of an operation; those of a solution are the matrix and the right-hand side.
pub(crate) fn for_each_operand(tape: &Tape, operation: &Operation, mut visit: impl FnMut(Value)) {
    match operation {
        Operation::Solve {
            factorisation,
            right,
        } => {
            let factorisation = tape.operation(*factorisation);
            factorisation.for_each_operand(&mut visit);
            right.iter().copied().for_each(visit);
        }
        _ => operation.for_each_operand(visit),
    }
}

impl Uses {
    pub(crate) fn new(tape: &Tape, actions: &[Action]) -> Self {
        let mut used = Vec::with_capacity(2 * actions.len());
        for action in actions {
            match action {
                Action::Compute(value) => {
                    for_each_operand(tape, tape.operation(*value), |operand| used.push(operand));
                }
                Action::Store(Store { value, .. }) => used.push(*value),
            }
        }
        let mut following = vec![NEVER; used.len()];
        let mut next = vec![NEVER; tape.operations.len()];
        for (number, value) in used.iter().enumerate().rev() {
            following[number] = next[value.index()];
            // The checked limits keep the number of uses far below this.
            next[value.index()] = u32::try_from(number).unwrap_or(NEVER);
        }
        Self {
            following,
            next,
            now: 0,
        }
    }

    /// The next use.
    pub(crate) fn next(&self, value: Value) -> u32 {
        self.next[value.index()]
    }

    /// The use after the next one.
    pub(crate) fn after(&self, value: Value) -> u32 {
        let following = self.following.get(self.next(value) as usize);
        following.copied().unwrap_or(NEVER)
    }

    pub(crate) fn is_alive(&self, value: Value) -> bool {
        self.next(value) != NEVER
    }

    /// Ends the next use.
    pub(crate) fn over(&mut self, value: Value) {
        self.now += 1;
        self.next[value.index()] = self.after(value);
    }
}
