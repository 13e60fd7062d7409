//! Sample configurations inside the declared ranges, as examples for unproven properties.

use super::bench::Bench;
use crate::mechanics::symbols::ids;
use crate::symbolic::{Expr, evaluate};

/// Number of configurations.
const COUNT: u32 = 24;
/// Sampling range of a coordinate without a range: angles are periodic, lengths change sign.
const WIDE: [f64; 2] = [-4.0, 4.0];

/// Whether an expression is positive in one configuration and not in another, and hence zero between them if it
/// is continuous.
pub(super) fn takes_both_signs(bench: &Bench, expr: Expr) -> bool {
    let graph = &bench.algebra.graph;
    let coordinates = ids(graph, &bench.derivation.symbols.coordinates);
    let (mut positive, mut negative) = (false, false);
    for index in 0..COUNT {
        let mut values = bench.state.values().to_vec();
        values.resize(graph.symbol_count(), 0.0);
        for (k, (symbol, q)) in coordinates
            .iter()
            .zip(&bench.mechanism.coordinates)
            .enumerate()
        {
            let [low, high] = q.range.unwrap_or(WIDE);
            values[symbol.0 as usize] = low + (high - low) * fraction(index, k);
        }
        let value = evaluate(graph, &values, &[expr])[0];
        positive |= value > 0.0;
        negative |= value <= 0.0;
    }
    positive && negative
}

/// Low-discrepancy sequence in the unit interval for each coordinate: multiples of square roots of non-squares.
fn fraction(index: u32, coordinate: usize) -> f64 {
    let radicand = (2..)
        .filter(|n: &u32| n.isqrt().pow(2) != *n)
        .nth(coordinate);
    let step = f64::from(radicand.unwrap_or(2)).sqrt();
    (0.5 + f64::from(index) * step).fract()
}
