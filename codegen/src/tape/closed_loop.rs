//! Functions of a motion under a control law, as one tape.

use super::{Argument, Arithmetic, Operation, ResultArray, Tape, Unique, Value};
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

/// Functions of a closed loop: the first result of `law` gives the inputs of each of `functions`, whose first results
/// become one, called `values`. All have the same time, states and parameters; the inputs of the closed loop are those of
/// the law and those of `seen`.
pub fn closed_loop(law: &Tape, functions: &[&Tape], seen: &[Seen]) -> Tape {
    let mut composed = Unique::default();
    // A sine or a cosine in the law has the call of the functions.
    for function in functions {
        for operation in &function.operations {
            if let Operation::SinCos(angle) = operation
                && let Operation::Argument(state @ Argument::State(_)) = function.operation(*angle)
            {
                let state = composed.push(Operation::Argument(*state));
                composed.push(Operation::SinCos(state));
            }
        }
    }
    let inputs = add(&mut composed, law, |composed, argument| {
        replaced(composed, argument, seen)
    });
    let of_laws = |seen: &&Seen| matches!(seen, Seen::Replaced { .. });
    let parameters: Vec<Seen> = seen.iter().filter(of_laws).copied().collect();
    let mut values = Vec::new();
    for function in functions {
        values.extend(add(
            &mut composed,
            function,
            |composed, argument| match argument {
                Argument::Input(input) => inputs[input as usize],
                other => replaced(composed, other, &parameters),
            },
        ));
    }
    let results = vec![ResultArray {
        name: "values".to_owned(),
        entries: values,
    }];
    composed.finish(results).live()
}

/// A function of one argument, which may be a part of a sine and cosine.
fn function(composed: &mut Unique, function: Function, a: Value) -> Value {
    let pair = composed.find(&Operation::SinCos(a));
    match (function, pair) {
        (Function::Sin, Some(pair)) => pair.part(0),
        (Function::Cos, Some(pair)) => pair.part(1),
        _ => composed.push(Operation::Function(function, a)),
    }
}

/// Adds the operations of a tape, with its arguments substituted; its first result.
fn add(
    composed: &mut Unique,
    tape: &Tape,
    mut substitute: impl FnMut(&mut Unique, Argument) -> Value,
) -> Vec<Value> {
    let mut values: Vec<Value> = Vec::with_capacity(tape.operations.len());
    for operation in &tape.operations {
        let value = match *operation {
            Operation::Argument(argument) => substitute(composed, argument),
            Operation::Part(whole, part) => values[whole.index()].part(part),
            Operation::Function(name, a) => function(composed, name, values[a.index()]),
            _ => composed.push(operation.map_operands(|operand| values[operand.index()])),
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

/// The value of an argument of the law.
fn replaced(composed: &mut Unique, argument: Argument, seen: &[Seen]) -> Value {
    let mut value = composed.push(Operation::Argument(argument));
    for seen in seen {
        match *seen {
            Seen::Disturbed { state, by } if argument == Argument::State(state) => {
                let by = composed.push(Operation::Argument(Argument::Input(by)));
                value = composed.push(Operation::Binary(Arithmetic::Add, value, by));
            }
            Seen::Replaced { parameter, by } if argument == Argument::Parameter(parameter) => {
                value = composed.push(Operation::Argument(Argument::Input(by)));
            }
            _ => {}
        }
    }
    value
}
