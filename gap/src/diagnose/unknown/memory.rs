//! Forces that depend on what was before: a mass that hangs on a coordinate and swings by itself.
//!
//! Its motion is computed from the recordings, once: it stands beside them as a channel would. A disturbance with a
//! colour looks like a swing at the end of the range of frequencies; a mass has a frequency within.

use std::f64::consts::TAU;

use appell_estimate::Measured;
use appell_runtime::model::At;

use super::super::bench::Bench;
use crate::effects::HiddenMass;

/// Frequencies of a hidden mass.
const FREQUENCIES: usize = 12;
/// Swings in a run at least, and rows in a swing at least.
const SWINGS: f64 = 2.0;
const ROWS: f64 = 25.0;
/// Damping ratio of a hidden mass.
const DAMPING: f64 = 0.1;

/// Masses behind a coordinate, one of each frequency.
pub(super) struct HiddenMasses {
    /// Name of the coordinate.
    coordinate: String,
    /// Their frequencies in 1/s, the lowest first.
    pub(super) frequencies: Vec<f64>,
    /// For each run its times, and a value of each term at each.
    runs: Vec<(Vec<f64>, Vec<Vec<f64>>)>,
}

impl HiddenMasses {
    /// How many terms they have: two each.
    pub(super) fn count(&self) -> usize {
        2 * self.frequencies.len()
    }

    /// One of them in words.
    pub(super) fn name(&self, number: usize) -> String {
        let hertz = self.frequencies[number] / TAU;
        format!(
            "a swing of {} at {hertz:.2} Hz that the model lacks",
            self.coordinate
        )
    }

    /// What is known beforehand of one of them, from a first estimate of its size.
    pub(super) fn hidden(&self, number: usize, size: f64) -> HiddenMass {
        let rate = self.frequencies[number];
        let next = self.frequencies.get(number + 1);
        HiddenMass {
            behind: self.coordinate.clone(),
            mass: [size, size],
            rate: [rate, next.map_or(rate, |next| next - rate)],
            damping: [DAMPING, DAMPING],
        }
    }

    /// The terms at a place.
    pub(super) fn at(&self, run: usize, at: At<'_>, to: &mut [f64]) {
        let (times, values) = &self.runs[run];
        let row = times.partition_point(|&own| own <= at.t).saturating_sub(1);
        for (to, value) in to.iter_mut().zip(values) {
            *to = value[row];
        }
    }

    /// The one that gains most, if its frequency lies within the range.
    pub(super) fn best(gains: &[f64]) -> Option<usize> {
        let best = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]))?;
        (best > 0 && best + 1 < gains.len()).then_some(best)
    }

    /// Behind all coordinates that are measured.
    pub(super) fn all(bench: &Bench<'_>) -> Vec<Self> {
        let speeds = bench.effects.info().speeds;
        let channels = bench.measured.iter().enumerate();
        let of = |(channel, shown): (usize, &Measured)| {
            let Measured::State(state) = *shown else {
                return None;
            };
            let name = &bench.effects.info().states[state].name;
            let runs = bench.recordings.iter().map(|run| {
                let rows = 0..run.times().len();
                let values = rows.map(|row| run.measured(row)[channel]);
                (run.times().to_vec(), filled(values.collect()))
            });
            let runs: Vec<(Vec<f64>, Vec<f64>)> = runs.collect();
            (state >= speeds)
                .then(|| Self::behind(name, &runs))
                .flatten()
        };
        channels.filter_map(of).collect()
    }

    /// Behind a coordinate, with frequencies from some swings in a run to some rows in a swing.
    fn behind(name: &str, runs: &[(Vec<f64>, Vec<f64>)]) -> Option<Self> {
        let duration = |(times, _): &(Vec<f64>, Vec<f64>)| times[times.len() - 1] - times[0];
        let longest = runs.iter().map(duration).fold(0.0, f64::max);
        let steps = runs
            .iter()
            .map(|run| duration(run) / (run.0.len() - 1) as f64);
        let step = steps.fold(0.0, f64::max);
        let (low, high) = (TAU * SWINGS / longest, TAU / (ROWS * step));
        if !(low > 0.0 && high > low) {
            return None;
        }
        let frequency = |place: usize| {
            let part = place as f64 / (FREQUENCIES - 1) as f64;
            low * (high / low).powf(part)
        };
        let of_run = |(times, values): &(Vec<f64>, Vec<f64>)| {
            let swings = (0..FREQUENCIES).map(|place| swing(times, values, frequency(place)));
            (times.clone(), swings.flatten().collect())
        };
        Some(Self {
            coordinate: name.to_owned(),
            frequencies: (0..FREQUENCIES).map(frequency).collect(),
            runs: runs.iter().map(of_run).collect(),
        })
    }
}

/// What is missing keeps the value before.
fn filled(mut values: Vec<f64>) -> Vec<f64> {
    let first = values.iter().copied().find(|value| !value.is_nan());
    let mut last = first.unwrap_or(0.0);
    for value in &mut values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
    values
}

/// Stretch of the spring, and its rate by the frequency, both as accelerations of the mass.
fn swing(times: &[f64], values: &[f64], frequency: f64) -> [Vec<f64>; 2] {
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
        // A count of small steps.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let parts = ((10.0 * step * frequency).ceil() as usize).max(1);
        let part = step / parts as f64;
        // Half a push, a drift, half a push (Verlet): a lag of half a step would be a force.
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
        let slow: Vec<f64> = times.iter().map(|t| 0.5 * t * t).collect();
        let [stretch, _] = swing(&times, &slow, 60.0);
        // Its acceleration is that of the coordinate once it has settled.
        assert!((stretch[1900] - 1.0).abs() < 0.05, "{}", stretch[1900]);
        let still = vec![0.3; 2000];
        let [stretch, rates] = swing(&times, &still, 60.0);
        assert!(stretch.iter().chain(&rates).all(|value| value.abs() < 1e-9));
    }
}
