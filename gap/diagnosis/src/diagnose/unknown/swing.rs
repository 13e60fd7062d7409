//! A hidden mass coupled to a coordinate by a spring and a damper.

use std::f64::consts::TAU;

use super::trace::{Span, Trace};
use crate::effects::Memory;

/// Number of natural frequencies that are tried.
const FREQUENCIES: usize = 12;
/// Smallest number of periods in a run, and of rows in a period.
const SWINGS: f64 = 2.0;
const ROWS: f64 = 25.0;
/// Damping ratio of a hidden mass.
const DAMPING: f64 = 0.1;
/// Largest number of integration steps between two rows.
const MOST_PARTS: usize = 1000;

/// Natural frequencies in rad/s, from some periods in a run to some rows in a period, the lowest first. A coloured
/// disturbance resembles a mass at an end of that range; the frequency of a mass is within.
pub(super) fn frequencies(traces: &[Trace]) -> Vec<f64> {
    let longest = traces.iter().map(Trace::duration).fold(0.0, f64::max);
    let step = traces.iter().map(Trace::step).fold(0.0, f64::max);
    Span(TAU * SWINGS / longest, TAU / (ROWS * step)).places(FREQUENCIES)
}

/// One of them in words.
pub(super) fn name(coordinate: &str, frequency: f64) -> String {
    let hertz = frequency / TAU;
    format!("an oscillation of a hidden mass at {coordinate} with {hertz:.2} Hz")
}

/// The law with its prior, from a first estimate of its size.
pub(super) fn first(coordinate: &str, [rate, apart]: [f64; 2], size: f64) -> Memory {
    Memory::HiddenMass {
        behind: coordinate.to_owned(),
        mass: [size, size],
        rate: [rate, apart],
        damping: [DAMPING, DAMPING],
    }
}

/// Stretch of the spring, and its rate by the frequency, both as accelerations of the mass.
pub(super) fn terms(trace: &Trace, frequency: f64) -> [Vec<f64>; 2] {
    let Trace { times, values } = trace;
    let (mut at, mut rate) = (values[0], 0.0);
    let mut stretches = Vec::with_capacity(times.len());
    let mut rates = Vec::with_capacity(times.len());
    for row in 0..times.len() {
        let next = (row + 1).min(times.len() - 1);
        let step = times[next] - times[row];
        let slope = if step > 0.0 {
            (values[next] - values[row]) / step
        } else {
            0.0
        };
        stretches.push(frequency * frequency * (values[row] - at));
        rates.push(frequency * (slope - rate));
        // The number of steps; after many periods the spring is at rest.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let parts = ((10.0 * step * frequency).ceil() as usize).clamp(1, MOST_PARTS);
        let part = step / parts as f64;
        // Velocity Verlet: a phase lag of half a step would act as a force.
        for number in 0..parts {
            for end in [0, 1] {
                let value = values[row] + slope * (number + end) as f64 * part;
                let pull = frequency * frequency * (value - at)
                    + 2.0 * DAMPING * frequency * (slope - rate);
                rate += 0.5 * part * pull;
                if end == 0 {
                    at += part * rate;
                }
            }
        }
    }
    [stretches, rates]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hidden_mass_follows_slow_motions_and_swings_by_itself() {
        let times: Vec<f64> = (0..2000).map(|row| f64::from(row) * 0.001).collect();
        let slow = Trace {
            values: times.iter().map(|t| 0.5 * t * t).collect(),
            times: times.clone(),
        };
        let [stretch, _] = terms(&slow, 60.0);
        // Its acceleration is that of the coordinate once it has settled.
        assert!((stretch[1900] - 1.0).abs() < 0.05, "{}", stretch[1900]);
        let still = Trace {
            values: vec![0.3; 2000],
            times,
        };
        let [stretch, rates] = terms(&still, 60.0);
        assert!(stretch.iter().chain(&rates).all(|value| value.abs() < 1e-9));
    }
}
