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
use crate::effects::EffectModel;

/// Largest number of intervals over all runs, the resolution of the plot.
const PARTS: f64 = 160.0;
/// Largest number of steps that are evaluated in a run.
const STEPS: usize = 2000;
/// Averaging time relative to a window.
const PART_TOGETHER: f64 = 0.1;

/// The missing forces of a run.
pub(super) struct OfRun {
    pub(super) name: String,
    /// Its first and last time in s.
    pub(super) ends: [f64; 2],
    /// Times with the forces of all equations.
    pub(super) forces: Vec<(f64, Vec<f64>)>,
}

impl ForceHistory {
    /// Of some runs, in parts that are no shorter than this time in s.
    pub(super) fn of(model: &EffectModel, runs: Vec<OfRun>, shortest: f64) -> Self {
        let info = model.info();
        let length: f64 = runs.iter().map(|run| run.ends[1] - run.ends[0]).sum();
        let part = shortest.max(length / PARTS);
        let mut told = Vec::new();
        let mut sizes: Vec<Vec<Vec<f64>>> = vec![Vec::new(); info.speeds];
        for run in runs {
            let [from, to] = run.ends;
            // The number of intervals is small.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let parts = ((to - from) / part).ceil().max(1.0) as usize;
            let first = sizes[0].len();
            for own in &mut sizes {
                own.resize(first + parts, Vec::new());
            }
            for (t, forces) in run.forces {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                let index = ((t - from) / part) as usize;
                for (own, force) in sizes.iter_mut().zip(&forces) {
                    own[first + index.min(parts - 1)].push(force.abs());
                }
            }
            told.push((run.name, from, parts));
        }
        let equations = sizes.into_iter().enumerate();
        let equations = equations.map(|(equation, parts)| MissingForce {
            name: info.states[equation].name.to_string(),
            unit: force_unit(&model.mechanism, equation),
            medians: parts.into_iter().map(median).collect(),
        });
        Self {
            part,
            runs: told,
            equations: equations.collect(),
        }
    }
}

/// The history of all training runs.
pub(super) fn force_history(
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<ForceHistory, DiagnoseError> {
    let nominal = comparison.nominal();
    let setup = bench.setup(&nominal.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let values = followed(bench, nominal, &estimation)?;
    let p = &nominal.fit.values[..setup.model.info().parameter_len()];
    let mut runs = Vec::new();
    for (run, recording) in bench.recordings.iter().enumerate() {
        let times = recording.times();
        let states = estimation.smoothed(&values, run)?;
        let stride = states.len().div_ceil(STEPS).max(1);
        let several = together(bench, recording);
        let forces = (1..states.len()).step_by(stride).map(|row| {
            let rows = row..(row + several).min(states.len());
            let forces = mean_missing(setup.model, recording, &states, rows, p);
            (times[row], forces)
        });
        runs.push(OfRun {
            name: bench.set.runs[run].name.clone(),
            ends: [times[0], times[times.len() - 1]],
            forces: forces.collect(),
        });
    }
    Ok(ForceHistory::of(
        bench.effects,
        runs,
        windows::length(bench),
    ))
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
