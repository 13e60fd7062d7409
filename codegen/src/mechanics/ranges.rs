//! The ranges in which the equations are valid.

use appell_spec::mechanism::Mechanism;

use super::symbols::{Symbols, ids};
use crate::symbolic::{Graph, Intervals, SymbolId};

/// Ranges in which a pivot must not vanish.
pub fn declared_ranges(graph: &Graph, mechanism: &Mechanism, symbols: &Symbols) -> Intervals {
    let coordinates = ids(graph, &symbols.coordinates)
        .into_iter()
        .zip(&mechanism.coordinates)
        .filter_map(|(symbol, q)| q.range.map(|[low, high]| (symbol, low, high)));
    let parameters = parameter_ranges(graph, mechanism, symbols);
    Intervals::new(graph, coordinates.chain(parameters).collect())
}

/// A parameter whose limits include both signs may be zero; any other keeps the sign of its value, since a
/// wheel of radius zero is a different mechanism.
pub fn parameter_ranges(
    graph: &Graph,
    mechanism: &Mechanism,
    symbols: &Symbols,
) -> Vec<(SymbolId, f64, f64)> {
    ids(graph, &symbols.parameters)
        .into_iter()
        .zip(&mechanism.parameters)
        .filter_map(|(symbol, p)| {
            let low = p.at_least.unwrap_or(f64::NEG_INFINITY);
            let high = p.at_most.unwrap_or(f64::INFINITY);
            let limited = p.at_least.is_some() || p.at_most.is_some();
            if limited && low < 0.0 && high > 0.0 {
                return Some((symbol, low, high));
            }
            match p.value {
                v if v > 0.0 => Some((symbol, low.max(f64::MIN_POSITIVE), high)),
                v if v < 0.0 => Some((symbol, low, high.min(-f64::MIN_POSITIVE))),
                _ => None,
            }
        })
        .collect()
}
