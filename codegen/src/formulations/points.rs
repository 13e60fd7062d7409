//! Values at random points inside the declared ranges.

use appell_spec::mechanism::Mechanism;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use super::comparison::{Agreement, Pair};
use crate::mechanics::seed;
use crate::mechanics::symbols::{Symbols, ids};
use crate::symbolic::{Expr, Graph, SymbolId, evaluate};

/// Points at which expressions are compared.
const COUNT: usize = 24;
/// Maximum number of random points: expressions may be undefined at some if ranges are not declared.
const MOST: usize = 4 * COUNT;
/// Rounding error of a thousand operations in an entry, relative to the magnitude of its terms.
const ROUNDING: f64 = 1e-9;
/// Relative perturbation of every argument, to measure the amplification of rounding errors.
const DISTURBANCE: f64 = 4.0 * f64::EPSILON;

/// Scales the components of a quaternion.
fn normalise(point: &mut [f64], quaternion: &[SymbolId]) {
    let square: f64 = quaternion.iter().map(|e| point[e.0 as usize].powi(2)).sum();
    for e in quaternion {
        point[e.0 as usize] /= square.sqrt();
    }
}

/// Random points, each with a neighbour perturbed by rounding.
pub(super) struct Points {
    all: Vec<[Vec<f64>; 2]>,
}

impl Points {
    /// Angles and lengths without a range are within ±1.2, velocities within ±2, inputs and signals within ±5;
    /// parameters are within 30 % of the spec's.
    pub(super) fn new(graph: &Graph, mechanism: &Mechanism, symbols: &Symbols) -> Self {
        let mut random = SplitMix64::seed_from_u64(seed(mechanism));
        let mut domains: Vec<(Expr, [f64; 2])> = Vec::new();
        for (&symbol, q) in symbols.coordinates.iter().zip(&mechanism.coordinates) {
            // The central 90 %: at the ends of a range the equations may be singular.
            let range = q.range.map_or([-1.2, 1.2], |[low, high]| {
                let edge = 0.05 * (high - low);
                [low + edge, high - edge]
            });
            domains.push((symbol, range));
        }
        for (&symbol, p) in symbols.parameters.iter().zip(&mechanism.parameters) {
            let width = 0.3 * p.value.abs();
            let low = p.at_least.unwrap_or(f64::NEG_INFINITY);
            let high = p.at_most.unwrap_or(f64::INFINITY);
            domains.push((
                symbol,
                [low.max(p.value - width), high.min(p.value + width)],
            ));
        }
        let around = |symbols: &[Expr], size: f64| -> Vec<_> {
            symbols.iter().map(|&s| (s, [-size, size])).collect()
        };
        domains.extend(around(&symbols.speeds, 2.0));
        domains.extend(around(&symbols.inputs, 5.0));
        domains.extend(around(&symbols.signals.concat(), 5.0));
        domains.push((symbols.time, [0.0, 2.0]));
        domains.push((symbols.pi, [std::f64::consts::PI; 2]));

        let places: Vec<Expr> = domains.iter().map(|&(symbol, _)| symbol).collect();
        let places: Vec<SymbolId> = ids(graph, &places);
        let quaternions = mechanism.frames.iter().filter_map(|frame| frame.quaternion);
        let quaternions: Vec<Vec<SymbolId>> = quaternions
            .map(|e| ids(graph, &e.map(|q| symbols.coordinates[q.index()])))
            .collect();
        let mut all = Vec::with_capacity(MOST);
        for _ in 0..MOST {
            let mut point = vec![f64::NAN; graph.symbol_count()];
            let mut neighbour = point.clone();
            for (place, &(_, range)) in places.iter().zip(&domains) {
                let value = between(&mut random, range);
                let change = between(&mut random, [-DISTURBANCE, DISTURBANCE]);
                point[place.0 as usize] = value;
                neighbour[place.0 as usize] = value * (1.0 + change);
            }
            for quaternion in &quaternions {
                normalise(&mut point, quaternion);
                normalise(&mut neighbour, quaternion);
            }
            all.push([point, neighbour]);
        }
        Self { all }
    }

    /// Compares at the first points where all expressions are finite.
    pub(super) fn compare(&self, graph: &Graph, pairs: &[Pair]) -> Agreement {
        let derived = pairs.iter().map(|pair| pair.derived);
        let other = pairs.iter().map(|pair| pair.other);
        let roots: Vec<Expr> = derived.chain(other).collect();
        let at = |point: &[f64]| {
            let values = evaluate(graph, point, &roots);
            values.iter().all(|v| v.is_finite()).then_some(values)
        };
        let both = |[point, neighbour]: &[Vec<f64>; 2]| Some([at(point)?, at(neighbour)?]);
        let values: Vec<[Vec<f64>; 2]> = self.all.iter().filter_map(both).take(COUNT).collect();
        if values.is_empty() {
            return Agreement::Undefined;
        }
        // Cancelling terms are as large as their rounding errors indicate.
        let noise = values.iter().flat_map(|[a, b]| a.iter().zip(b));
        let noise = noise.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        let (mut entry, mut worst, mut deviation) = (0, [0.0; 2], 0.0);
        for [values, _] in &values {
            let scale = values.iter().fold(0.0, |scale: f64, v| scale.max(v.abs()));
            let size = scale.max(noise / f64::EPSILON);
            let (derived, other) = values.split_at(pairs.len());
            for (k, (&a, &b)) in derived.iter().zip(other).enumerate() {
                if (a - b).abs() > deviation * size {
                    (entry, worst, deviation) = (k, [a, b], (a - b).abs() / size);
                }
            }
        }
        if deviation <= ROUNDING {
            return Agreement::AtPoints {
                points: values.len(),
                deviation,
            };
        }
        Agreement::Different {
            entry: pairs[entry].entry.clone(),
            values: worst,
            deviation,
        }
    }
}

fn between(random: &mut SplitMix64, [low, high]: [f64; 2]) -> f64 {
    let fraction = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    low + (high - low) * fraction
}
