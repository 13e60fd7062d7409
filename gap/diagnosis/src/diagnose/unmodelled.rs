//! Recorded channels outside the model, with their rates: possible variables of the gap.

use crate::slope::{Slope, WINDOW};
use appell_recordings::{DataSet, Role, Run};

/// Smallest residual variance of a channel about a straight line over time: a monotonic channel only encodes the
/// time.
const RETURNS: f64 = 0.1;

/// A channel or its rate along the runs to fit.
#[derive(Debug, Clone)]
pub(super) struct UnmodelledChannel {
    /// Its name.
    pub(super) name: String,
    /// Its lowest and its highest value.
    pub(super) range: (f64, f64),
    /// For each run times and values.
    runs: Vec<(Vec<f64>, Vec<f64>)>,
}

impl UnmodelledChannel {
    /// All of them.
    pub(super) fn of(set: &DataSet) -> Vec<Self> {
        let mut all = Vec::new();
        for (column, channel) in set.channels.iter().enumerate() {
            if channel.role != Role::Recorded {
                continue;
            }
            let values = set.runs.iter().map(|run| run.values[column].clone());
            let name = channel.column.clone();
            all.extend(Self::new(name, &set.runs, values.collect()));
            let rates = set
                .runs
                .iter()
                .map(|run| rates(&run.times, &run.values[column]));
            let name = format!("rate of {}", channel.column);
            all.extend(Self::new(name, &set.runs, rates.collect()));
        }
        all
    }

    /// `None` for a channel that is constant or only encodes the time.
    fn new(name: String, runs: &[Run], values: Vec<Vec<f64>>) -> Option<Self> {
        let seen = values.iter().flatten().filter(|value| value.is_finite());
        let range = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        });
        let times = runs.iter().map(|run| run.times.clone());
        let runs: Vec<(Vec<f64>, Vec<f64>)> = times.zip(values).collect();
        let returns = runs
            .iter()
            .any(|(times, values)| left_by_a_line(times, values) > RETURNS);
        (range.0 < range.1 && returns).then_some(Self { name, range, runs })
    }

    /// The value at a time of a run, as held since its row; NaN where it is missing.
    pub(super) fn at(&self, run: usize, t: f64) -> f64 {
        let (times, values) = &self.runs[run];
        let row = times.partition_point(|&own| own <= t).saturating_sub(1);
        values.get(row).copied().unwrap_or(f64::NAN)
    }
}

/// Slopes of parabolas about each row.
fn rates(times: &[f64], values: &[f64]) -> Vec<f64> {
    let rows = times.len();
    let rate = |row: usize| {
        let from = row
            .saturating_sub(WINDOW / 2)
            .min(rows.saturating_sub(WINDOW));
        let window = from..rows.min(from + WINDOW);
        let values = values[window.clone()].iter().copied();
        Slope::at(times[row], &times[window], values).map_or(f64::NAN, |slope| slope.value)
    };
    (0..rows).map(rate).collect()
}

/// Relative residual variance about a straight line over time.
fn left_by_a_line(times: &[f64], values: &[f64]) -> f64 {
    let seen: Vec<(f64, f64)> = (times.iter().copied().zip(values.iter().copied()))
        .filter(|(_, value)| value.is_finite())
        .collect();
    let count = seen.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| seen.iter().map(of).sum::<f64>() / count;
    let (t, y) = (mean(&|one| one.0), mean(&|one| one.1));
    let along = mean(&|one| (one.0 - t).powi(2));
    let across = mean(&|one| (one.1 - y).powi(2));
    let both = mean(&|one| (one.0 - t) * (one.1 - y));
    1.0 - both * both / (along * across).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_of_a_parabola_are_exact_and_lines_tell_the_time() {
        let times: Vec<f64> = (0..50).map(|row| f64::from(row) * 0.1).collect();
        let values: Vec<f64> = times.iter().map(|t| 3.0 * t * t - t).collect();
        for (t, rate) in times.iter().zip(rates(&times, &values)) {
            assert!((rate - (6.0 * t - 1.0)).abs() < 1e-9, "{rate} at {t}");
        }
        let line: Vec<f64> = times.iter().map(|t| 2.0 - 5.0 * t).collect();
        assert!(left_by_a_line(&times, &line) < 1e-9);
        let wave: Vec<f64> = times.iter().map(|t| (5.0 * t).sin()).collect();
        assert!(left_by_a_line(&times, &wave) > 0.9);
    }
}
