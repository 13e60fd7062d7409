//! Taylor series of a motion, from the schedule of its rates.
//!
//! For a product c = a b the coefficient of order k is cₖ = a₀ bₖ + b₀ aₖ + Σ aⱼ bₖ₋ⱼ, the sum over
//! 1 ≤ j < k: linear in what is new. All operations are of this kind. An expansion thus needs two
//! programs, both of them [`Schedule`]s: one for order zero, and the *sweep*, the same for every order,
//! whose factors are values of order zero. Before each sweep the sums of all products are taken at once.
//!
//! `recurrences` has the rule of each operation, `coefficients` collects what they need; both work on the graphs of
//! [`operations`](crate::operations).

mod coefficients;
mod interpreted;
mod recurrences;

pub use interpreted::InterpretedSeries;

use appell_runtime::model::{List, ModelInfo};
use appell_runtime::series::{OrderNumber, Shape};

use crate::operations::Seen;
use crate::operations::bind::{bind, live};
use crate::operations::closed_loop::{in_loop, under};
use crate::operations::flatten::flatten;
use crate::operations::graph::{Graph, Id};
use crate::schedule::Schedule;
use coefficients::Expansion;

/// The two programs of an expansion.
#[derive(Debug, Clone)]
pub struct SeriesProgram {
    /// Lengths of what they read and write.
    pub shape: Shape,
    /// Order zero: results `next` (coefficients of order 1 of the states), `kept`, `guards`.
    pub start: Schedule,
    /// Order k: results `next` (coefficients of order k + 1 of the states), `left`, `right`, `guards`.
    /// Its time is k, its parameters are the kept values, its weights the sums, and after its inputs come the
    /// numbers of the order.
    pub sweep: Schedule,
}

/// Lengths of the arguments of equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lengths {
    /// States.
    pub states: usize,
    /// Inputs with the signals.
    pub inputs: usize,
    /// Parameters.
    pub parameters: usize,
}

impl From<&ModelInfo> for Lengths {
    fn from(info: &ModelInfo) -> Self {
        Self {
            states: info.state_len(),
            inputs: info.input_len(),
            parameters: info.parameter_len(),
        }
    }
}

/// Expands rates, the first result of a schedule, in time.
pub fn expand(rates: &Schedule, lengths: Lengths) -> SeriesProgram {
    let mut graph = Graph::default();
    let mut results = flatten(rates, &mut graph, Graph::argument);
    let rates = results.swap_remove(0);
    series(graph, &rates, lengths)
}

/// The same under a law: the first result of its schedule is the inputs of the rates. `lengths` are those of
/// the law's arguments, which the rates share but for the inputs; `seen` is what it has in the place of some.
pub fn expand_under(
    law: &Schedule,
    rates: &Schedule,
    seen: &[Seen],
    lengths: Lengths,
) -> SeriesProgram {
    let mut graph = Graph::default();
    let inputs = under(law, &mut graph, seen);
    let rates = in_loop(rates, &mut graph, &inputs);
    series(graph, &rates, lengths)
}

fn series(zero: Graph, rates: &[Id], lengths: Lengths) -> SeriesProgram {
    let needed = live(&zero, rates.iter());
    let nodes = zero.ids();
    let mut expansion = Expansion::new(zero, lengths.inputs);
    // Operands first: no recursion over long chains.
    for id in nodes.filter(|id| needed[id.index()]) {
        expansion.coefficient(id);
    }
    let [left, right] = expansion.operands();
    let next_inverse = expansion.order(OrderNumber::NextInverse);
    let mut next = Vec::new();
    for &rate in rates {
        let coefficient = expansion.coefficient(rate);
        next.push(match coefficient {
            Some(coefficient) => expansion.sweep.multiply(next_inverse, coefficient),
            None => expansion.sweep.number(0),
        });
    }
    let (guarded, guards): (Vec<Id>, Vec<_>) = expansion.guards.clone().into_iter().unzip();
    let guard_coefficients = guarded.iter().map(|&guard| {
        let coefficient = expansion.coefficient(guard);
        coefficient.unwrap_or_else(|| expansion.sweep.number(0))
    });
    let guard_coefficients = guard_coefficients.collect();
    let kept = expansion.kept;
    let shape = Shape {
        states: lengths.states,
        inputs: lengths.inputs,
        parameters: lengths.parameters,
        kept: kept.len(),
        products: expansion.products.len(),
        guards: List::Owned(guards),
    };
    let start = [
        ("next", rates.to_vec()),
        ("kept", kept),
        ("guards", guarded),
    ];
    let sweep = [
        ("next", next),
        ("left", left),
        ("right", right),
        ("guards", guard_coefficients),
    ];
    SeriesProgram {
        shape,
        start: bind(&expansion.zero, start.into()),
        sweep: bind(&expansion.sweep, sweep.into()),
    }
}
