//! The gap over time: the missing force of each equation in intervals of the runs.
//!
//! The states are those of the smoother under the nominal model, whose process noise estimates the
//! missing force.

use appell_estimate::{Estimation, Recording};

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::Comparison;
use super::forces::mean_missing;
use super::localise::force_unit;
use super::prediction::followed;
use super::report::{ForceHistory, MissingForce};
use super::windows;

/// Largest number of intervals over all runs, the resolution of the plot.
const PARTS: f64 = 160.0;
/// Largest number of steps that are evaluated in a run.
const STEPS: usize = 2000;
/// Averaging time relative to a window.
const PART_TOGETHER: f64 = 0.1;

/// The history of all training runs.
pub(super) fn force_history(
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<ForceHistory, DiagnoseError> {
    let nominal = comparison.nominal();
    let setup = bench.setup(&nominal.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let values = followed(bench, nominal, &estimation)?;
    let info = setup.model.info();
    let p = &nominal.fit.values[..info.parameter_len()];
    let ends = |run: usize| {
        let times = bench.recordings[run].times();
        (times[0], times[times.len() - 1])
    };
    let length: f64 = (0..bench.recordings.len())
        .map(ends)
        .map(|(from, to)| to - from)
        .sum();
    let part = windows::length(bench).max(length / PARTS);
    let mut runs = Vec::new();
    let mut sizes: Vec<Vec<Vec<f64>>> = vec![Vec::new(); info.speeds];
    for (run, recording) in bench.recordings.iter().enumerate() {
        let (from, to) = ends(run);
        // The number of intervals is small.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let parts = ((to - from) / part).ceil().max(1.0) as usize;
        let first = sizes[0].len();
        for own in &mut sizes {
            own.resize(first + parts, Vec::new());
        }
        let states = estimation.smoothed(&values, run)?;
        let stride = states.len().div_ceil(STEPS).max(1);
        let several = together(bench, recording);
        for row in (1..states.len()).step_by(stride) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let index = ((recording.times()[row] - from) / part) as usize;
            let rows = row..(row + several).min(states.len());
            let forces = mean_missing(setup.model, recording, &states, rows, p);
            for (own, force) in sizes.iter_mut().zip(&forces) {
                own[first + index.min(parts - 1)].push(force.abs());
            }
        }
        runs.push((bench.set.runs[run].name.clone(), from, parts));
    }
    let equations = sizes.into_iter().enumerate();
    let equations = equations.map(|(equation, parts)| MissingForce {
        name: info.states[equation].name.to_string(),
        unit: force_unit(&bench.effects.mechanism, equation),
        medians: parts.into_iter().map(median).collect(),
    });
    Ok(ForceHistory {
        part,
        runs,
        equations: equations.collect(),
    })
}

/// The median, which is robust to a jump of a channel, a large force in a single step. Zero without values.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Number of steps to average: over windows the process noise is free at every row and contains the noise.
pub(super) fn together(bench: &Bench<'_>, recording: &Recording) -> usize {
    if !bench.is_over_windows() {
        return 1;
    }
    let times = recording.times();
    let rows = PART_TOGETHER * windows::length(bench) * (times.len() - 1) as f64
        / (times[times.len() - 1] - times[0]);
    // The number of rows is small.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    (rows.round() as usize).max(1)
}
