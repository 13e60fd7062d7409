//! Orders the live operations, calls early.
//!
//! All vector registers are clobbered at a call. Operands of calls are therefore computed first, so that few
//! values are live across calls. A result is stored at its definition, which ends its live range. The order
//! does not affect the results.

use appell_codegen::symbolic::Function;
use appell_codegen::tape::{Operation, Tape, Value};

/// An action, in order of execution.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Action {
    /// Computes a value, or the parts of an operation.
    Compute(Value),
    /// Stores a value to an entry of a result.
    Store(Store),
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Store {
    pub(crate) value: Value,
    pub(crate) result: u32,
    pub(crate) entry: u32,
}

/// Whether an operation of an unrolled tape is a call of a routine.
pub(crate) fn is_call(operation: &Operation) -> bool {
    match operation {
        Operation::Function(function, _) => !matches!(function, Function::Sqrt | Function::Abs),
        Operation::Atan2(..)
        | Operation::Power(..)
        | Operation::SinCos(_)
        | Operation::Solve { .. } => true,
        _ => false,
    }
}

/// The actions of an unrolled tape.
pub(crate) fn ordered(tape: &Tape) -> Vec<Action> {
    let mut stores = Vec::new();
    for (result, array) in (0..).zip(&tape.results) {
        for (entry, &value) in (0..).zip(&array.entries) {
            stores.push(Store {
                value,
                result,
                entry,
            });
        }
    }
    stores.sort_by_key(|store| store.value);
    let needs = needs(tape, &stores);
    let (leaves, stores): (Vec<_>, Vec<_>) = stores
        .into_iter()
        .partition(|store| tape.operation(store.value).is_leaf());

    let mut actions = Vec::with_capacity(tape.operations.len() + stores.len());
    for need in [Need::Call, Need::Result] {
        for (value, operation) in (0..).map(Value).zip(&tape.operations) {
            if needs[value.index()] != need || operation.is_leaf() {
                continue;
            }
            // The call of the parts, and of the routine that also factorises, are actions.
            if !matches!(operation, Operation::Part(..) | Operation::Factorise(_)) {
                actions.push(Action::Compute(value));
            }
            let first = stores.partition_point(|store| store.value < value);
            let of_value = stores[first..].iter().take_while(|s| s.value == value);
            actions.extend(of_value.copied().map(Action::Store));
        }
    }
    // Leaves have no definition.
    actions.extend(leaves.into_iter().map(Action::Store));
    actions
}

/// What depends on a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd)]
enum Need {
    Nothing,
    Result,
    /// A call, or the value is part of one.
    Call,
}

fn needs(tape: &Tape, stores: &[Store]) -> Vec<Need> {
    let mut needs = vec![Need::Nothing; tape.operations.len()];
    for store in stores {
        needs[store.value.index()] = Need::Result;
    }
    // Users come after their operands.
    for (index, operation) in tape.operations.iter().enumerate().rev() {
        if needs[index] == Need::Nothing {
            continue;
        }
        if is_call(operation) || matches!(operation, Operation::Part(..)) {
            needs[index] = Need::Call;
        }
        let need = needs[index];
        operation.for_each_operand(|operand| {
            if needs[operand.index()] < need {
                needs[operand.index()] = need;
            }
        });
    }
    needs
}
