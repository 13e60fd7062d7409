//! Symbols of the arguments of all functions.

use appell_runtime::model::ModelInfo;

use super::Derivation;
use super::symbols::{Symbols, ids};
use crate::program::{Arguments, FunctionKind, Own};
use crate::symbolic::{Expr, SymbolId};

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
        pi: graph.as_symbol(symbols.pi),
    }
}

impl Derivation {
    /// Symbols of the argument that only some functions have.
    pub(super) fn own_symbols(&self, kind: FunctionKind) -> Vec<SymbolId> {
        let symbols = &self.symbols;
        let own = match kind.takes() {
            Some(Own::Weights | Own::OutputWeights) => &symbols.weights,
            Some(Own::Accelerations) => &symbols.accelerations,
            None => return Vec::new(),
        };
        ids(&self.algebra.graph, own)
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
