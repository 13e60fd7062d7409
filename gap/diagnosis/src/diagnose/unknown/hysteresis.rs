//! A force with hysteresis, which depends on the travel since the last reversal.

use super::trace::{Span, Trace};
use crate::effects::Memory;

/// Number of presliding displacements that are tried.
const WAYS: usize = 8;
/// The longest, relative to the range; with a longer one the force is a spring.
const LONGEST: f64 = 0.5;
/// The shortest, relative to the noise and to the largest travel per row; with a shorter one it is dry friction.
const SHORTEST: [f64; 2] = [10.0, 0.25];
/// Reversals smaller than this, relative to the noise, are ignored.
const PLAY: f64 = 3.0;

/// Standard deviation of the noise, from the median deviation of samples from the line through their neighbours.
pub(super) fn noise(traces: &[Trace]) -> f64 {
    /// Quantile of a normal distribution.
    const MEDIAN: f64 = 0.6745;
    let mut off: Vec<f64> = traces.iter().flat_map(Trace::off_the_line).collect();
    off.sort_by(f64::total_cmp);
    off.get(off.len() / 2).map_or(0.0, |off| off / MEDIAN)
}

/// The presliding displacements that are tried, the shortest first.
pub(super) fn ways(traces: &[Trace], noise: f64) -> Vec<f64> {
    let values = || traces.iter().flat_map(|trace| &trace.values);
    let low = values().copied().fold(f64::INFINITY, f64::min);
    let high = values().copied().fold(f64::NEG_INFINITY, f64::max);
    let row = traces.iter().map(Trace::longest_row).fold(0.0, f64::max);
    let shortest = (SHORTEST[0] * noise).max(SHORTEST[1] * row);
    Span(shortest, LONGEST * (high - low)).places(WAYS)
}

pub(super) fn name(coordinate: &str) -> String {
    format!("the travel of {coordinate} since its last reversal")
}

/// The law with its prior, from a first estimate of its size.
pub(super) fn first(coordinate: &str, [way, apart]: [f64; 2], size: f64) -> Memory {
    Memory::Hysteresis {
        along: coordinate.to_owned(),
        force: [size, size],
        way: [way, apart],
    }
}

/// The hysteresis state, -1 to 1: exact while the direction does not change.
pub(super) fn terms(trace: &Trace, noise: f64, way: f64) -> [Vec<f64>; 1] {
    let (mut at, mut memory) = (trace.values[0], 0.0);
    let remembered = trace.values.iter().map(|&value| {
        // Backlash suppresses reversals by noise.
        let next = at.clamp(value - PLAY * noise, value + PLAY * noise);
        let (step, direction) = ((next - at).abs(), (next - at).signum());
        at = next;
        memory = direction + (memory - direction) * (-step / way).exp();
        memory
    });
    [remembered.collect()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_follows_the_way_and_no_noise() {
        let way = |row: i32| f64::from(500 - (row - 500).abs()) * 0.01;
        let jitter = |row: i32| 0.001 * f64::from(row * 7 % 5 - 2);
        let values: Vec<f64> = (0..1000).map(|row| way(row) + jitter(row)).collect();
        let times = (0..1000).map(f64::from).collect();
        let [memory] = terms(&Trace { times, values }, 0.001, 1.0);
        let [first, turned, last] = [100, 569, 999].map(|row| memory[row]);
        assert!((first - (1.0 - (-1.0_f64).exp())).abs() < 0.01, "{first}");
        // The travel after which half of the reversal is completed.
        assert!(turned.abs() < 0.02, "{turned}");
        assert!((last + 1.0).abs() < 0.02, "{last}");
    }
}
