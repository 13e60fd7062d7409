//! Equations of motion with a control law, as one tape.

use rustc_hash::FxHashMap;

use super::{Argument, Arithmetic, Operation, ResultArray, Tape, Value};
use crate::symbolic::Function;

/// Replacements of the law's arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// A state plus an input of the closed loop: its noisy measurement.
    Disturbed {
        /// The state.
        state: u32,
        /// The added input.
        by: u32,
    },
    /// An input of the closed loop instead of a parameter.
    Replaced {
        /// The parameter.
        parameter: u32,
        /// The input.
        by: u32,
    },
}

/// The rates of a closed loop: the first result of `law` gives the inputs of `rates`. Both have the same time,
/// states and parameters; the inputs of the closed loop are those of the law and those of `seen`.
pub fn closed_loop(law: &Tape, rates: &Tape, seen: &[Seen]) -> Tape {
    let mut composed = Composed::default();
    // A sine or a cosine in the law has the call of the rates.
    for operation in &rates.operations {
        if let Operation::SinCos(angle) = operation
            && let Operation::Argument(state @ Argument::State(_)) = rates.operation(*angle)
        {
            let state = composed.push(Operation::Argument(*state));
            composed.push(Operation::SinCos(state));
        }
    }
    let inputs = composed.add(law, |composed, argument| composed.seen(argument, seen));
    let rates = composed.add(rates, |composed, argument| match argument {
        Argument::Input(input) => inputs[input as usize],
        other => composed.push(Operation::Argument(other)),
    });
    composed.tape.results = vec![ResultArray {
        name: "rates".to_owned(),
        entries: rates,
    }];
    composed.tape.live()
}

/// A tape in which no operation occurs twice.
#[derive(Default)]
struct Composed {
    tape: Tape,
    known: FxHashMap<Operation, Value>,
}

impl Composed {
    /// The value of an operation. Its parts are the next values.
    fn push(&mut self, operation: Operation) -> Value {
        if let Some(&known) = self.known.get(&operation) {
            return known;
        }
        let value = self.tape.push(operation.clone());
        self.known.insert(operation, value);
        value
    }

    /// A function of one argument, which may be a part of a sine and cosine.
    fn function(&mut self, function: Function, a: Value) -> Value {
        let pair = self.known.get(&Operation::SinCos(a));
        match (function, pair) {
            (Function::Sin, Some(pair)) => pair.part(0),
            (Function::Cos, Some(pair)) => pair.part(1),
            _ => self.push(Operation::Function(function, a)),
        }
    }

    /// Adds the operations of a tape, with its arguments substituted; its first result.
    fn add(
        &mut self,
        tape: &Tape,
        mut substitute: impl FnMut(&mut Self, Argument) -> Value,
    ) -> Vec<Value> {
        let mut values: Vec<Value> = Vec::with_capacity(tape.operations.len());
        for operation in &tape.operations {
            let value = match *operation {
                Operation::Argument(argument) => substitute(self, argument),
                Operation::Part(whole, part) => values[whole.index()].part(part),
                Operation::Function(function, a) => self.function(function, values[a.index()]),
                _ => self.push(operation.map_operands(|operand| values[operand.index()])),
            };
            values.push(value);
        }
        let first = tape.results.first().map(|result| &result.entries);
        first
            .into_iter()
            .flatten()
            .map(|entry| values[entry.index()])
            .collect()
    }

    /// What a law has in place of an argument.
    fn seen(&mut self, argument: Argument, seen: &[Seen]) -> Value {
        let mut value = self.push(Operation::Argument(argument));
        for seen in seen {
            match *seen {
                Seen::Disturbed { state, by } if argument == Argument::State(state) => {
                    let by = self.push(Operation::Argument(Argument::Input(by)));
                    value = self.push(Operation::Binary(Arithmetic::Add, value, by));
                }
                Seen::Replaced { parameter, by } if argument == Argument::Parameter(parameter) => {
                    value = self.push(Operation::Argument(Argument::Input(by)));
                }
                _ => {}
            }
        }
        value
    }
}
