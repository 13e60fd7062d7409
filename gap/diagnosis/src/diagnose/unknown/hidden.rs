//! Hidden states along a run: a mass coupled to a coordinate by a spring and a damper, and hysteresis, which depends on
//! the travel since the last reversal.

use std::f64::consts::TAU;

use appell_recordings::Run;

use super::super::whole;

/// Number of natural frequencies that are tried.
const FREQUENCIES: usize = 12;
/// Smallest number of periods in a run, and of rows in a period.
const SWINGS: f64 = 2.0;
const ROWS: f64 = 25.0;
/// Damping ratio of a hidden mass.
pub(super) const DAMPING: f64 = 0.1;
/// Largest number of integration steps between two rows.
const MOST_PARTS: usize = 1000;
/// Number of presliding displacements that are tried.
const WAYS: usize = 8;
/// The longest, relative to the range; with a longer one the force is a spring.
const LONGEST: f64 = 0.5;
/// The shortest, relative to the noise and to the largest travel per row; with a shorter one it is dry friction.
const SHORTEST: [f64; 2] = [10.0, 0.25];
/// Reversals smaller than this, relative to the noise, are ignored.
const PLAY: f64 = 3.0;

/// A coordinate in a run.
pub(super) struct Trace {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Trace {
    pub(super) fn of(run: &Run, column: usize) -> Self {
        Self {
            times: run.times.clone(),
            values: filled(run.values[column].clone()),
        }
    }

    pub(super) fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    pub(super) fn step(&self) -> f64 {
        self.duration() / (self.times.len() - 1) as f64
    }

    /// Deviation of each sample from the line through its neighbours, normalised to the noise of one sample.
    pub(super) fn off_the_line(&self) -> impl Iterator<Item = f64> {
        self.times
            .windows(3)
            .zip(self.values.windows(3))
            .map(|(t, v)| {
                let part = (t[1] - t[0]) / (t[2] - t[0]);
                let line = v[0] + part * (v[2] - v[0]);
                (v[1] - line).abs() / (1.0 + part * part + (1.0 - part) * (1.0 - part)).sqrt()
            })
    }

    pub(super) fn longest_row(&self) -> f64 {
        let pairs = self.values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        pairs.fold(0.0, f64::max)
    }
}

/// A geometric sequence of so many positive numbers; none if the range is empty.
pub(super) fn geometric([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    if !(low > 0.0 && high > low) {
        return Vec::new();
    }
    let part = |place: usize| place as f64 / (count - 1) as f64;
    (0..count)
        .map(|i| low * (high / low).powf(part(i)))
        .collect()
}

/// Replaces missing values by the previous ones.
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

/// Natural frequencies in rad/s, from some periods in a run to some rows in a period, the lowest first. A coloured
/// disturbance resembles a mass at an end of that range; the frequency of a mass is within.
pub(super) fn frequencies(traces: &[Trace]) -> Vec<f64> {
    let longest = traces.iter().map(Trace::duration).fold(0.0, f64::max);
    let step = traces.iter().map(Trace::step).fold(0.0, f64::max);
    let range = [TAU * SWINGS / longest, TAU / (ROWS * step)];
    geometric(range, FREQUENCIES)
}

/// Stretch of the spring, and its rate by the frequency, both as accelerations of the mass.
pub(super) fn swing_terms(trace: &Trace, frequency: f64) -> [Vec<f64>; 2] {
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
        // After many periods the spring is at rest.
        let parts = whole((10.0 * step * frequency).ceil()).clamp(1, MOST_PARTS);
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
    geometric([shortest, LONGEST * (high - low)], WAYS)
}

/// The hysteresis state, -1 to 1: exact while the direction does not change.
pub(super) fn way_terms(trace: &Trace, noise: f64, way: f64) -> [Vec<f64>; 1] {
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
    fn a_hidden_mass_follows_slow_motions_and_swings_by_itself() {
        let times: Vec<f64> = (0..2000).map(|row| f64::from(row) * 0.001).collect();
        let slow = Trace {
            values: times.iter().map(|t| 0.5 * t * t).collect(),
            times: times.clone(),
        };
        let [stretch, _] = swing_terms(&slow, 60.0);
        // Its acceleration is that of the coordinate once it has settled.
        assert!((stretch[1900] - 1.0).abs() < 0.05, "{}", stretch[1900]);
        let still = Trace {
            values: vec![0.3; 2000],
            times,
        };
        let [stretch, rates] = swing_terms(&still, 60.0);
        assert!(stretch.iter().chain(&rates).all(|value| value.abs() < 1e-9));
    }

    #[test]
    fn it_follows_the_way_and_no_noise() {
        let way = |row: i32| f64::from(500 - (row - 500).abs()) * 0.01;
        let jitter = |row: i32| 0.001 * f64::from(row * 7 % 5 - 2);
        let values: Vec<f64> = (0..1000).map(|row| way(row) + jitter(row)).collect();
        let times = (0..1000).map(f64::from).collect();
        let [memory] = way_terms(&Trace { times, values }, 0.001, 1.0);
        let [first, turned, last] = [100, 569, 999].map(|row| memory[row]);
        assert!((first - (1.0 - (-1.0_f64).exp())).abs() < 0.01, "{first}");
        // The travel after which half of the reversal is completed.
        assert!(turned.abs() < 0.02, "{turned}");
        assert!((last + 1.0).abs() < 0.02, "{last}");
    }
}
