//! Symbols of the arguments of all functions.

use appell_runtime::model::ModelInfo;

use super::Derivation;
use super::symbols::{Symbols, ids};
use crate::program::Arguments;
use crate::symbolic::Expr;

/// The symbols of the functions' arguments.
pub(super) fn function_arguments(derivation: &Derivation, info: &ModelInfo) -> Arguments {
    let symbols = &derivation.symbols;
    let graph = &derivation.algebra.graph;
    Arguments {
        time: ids(graph, &[symbols.time])[0],
        states: ids(
            graph,
            &[symbols.speeds.as_slice(), &symbols.coordinates].concat(),
        ),
        inputs: ids(graph, &input_symbols(symbols, info)),
        parameters: ids(graph, &symbols.parameters),
        weights: ids(graph, &symbols.weights),
        output_weights: ids(graph, &symbols.output_weights),
        accelerations: ids(graph, &symbols.accelerations),
        pi: graph.as_symbol(symbols.pi),
    }
}

/// Symbols of the inputs: declared ones, then signals and their rates.
pub(super) fn input_symbols(symbols: &Symbols, info: &ModelInfo) -> Vec<Expr> {
    let tabulated = info
        .signal_inputs
        .iter()
        .map(|&(signal, order)| symbols.signals[signal][usize::from(order)]);
    symbols.inputs.iter().copied().chain(tabulated).collect()
}
