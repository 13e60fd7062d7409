//! Equations of motion with a control law, as one schedule.

use super::bind::bind;
use super::flatten::flatten;
use super::graph::{Graph, Id};
use crate::schedule::{Argument, Schedule};

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
pub fn closed_loop(law: &Schedule, rates: &Schedule, seen: &[Seen]) -> Schedule {
    let mut graph = Graph::default();
    let inputs = under(law, &mut graph, seen);
    let rates = in_loop(rates, &mut graph, &inputs);
    bind(&graph, vec![("rates", rates)])
}

/// The results of a law.
fn under(law: &Schedule, graph: &mut Graph, seen: &[Seen]) -> Vec<Id> {
    let argument = |graph: &mut Graph, argument| {
        let mut id = graph.argument(argument);
        for seen in seen {
            match *seen {
                Seen::Disturbed { state, by } if argument == Argument::State(state) => {
                    let by = graph.argument(Argument::Input(by));
                    id = graph.add(id, by);
                }
                Seen::Replaced { parameter, by } if argument == Argument::Parameter(parameter) => {
                    id = graph.argument(Argument::Input(by));
                }
                _ => {}
            }
        }
        id
    };
    flatten(law, graph, argument).swap_remove(0)
}

/// Rates, the first result of a schedule, with inputs substituted.
fn in_loop(rates: &Schedule, graph: &mut Graph, inputs: &[Id]) -> Vec<Id> {
    let given = |graph: &mut Graph, argument| match argument {
        Argument::Input(input) => inputs[input as usize],
        other => graph.argument(other),
    };
    flatten(rates, graph, given).swap_remove(0)
}
