//! Missing forces: the mass matrix times the acceleration of a smoothed motion in excess of the equations. The gap over
//! time: the missing force of each equation in intervals of the runs.
//!
//! The states are those of the smoother under the nominal model, whose process noise estimates the
//! missing force.

use std::ops::Range;

use appell_estimate::{Estimation, Recording, Smoothed};
use appell_runtime::model::{At, Model};

use super::localise::{force_unit, length};
use super::prediction::followed;
use super::{Bench, Comparison, ForceHistory, MissingForce, Result, whole};
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
            let parts = whole(((to - from) / part).ceil().max(1.0));
            let first = sizes[0].len();
            for own in &mut sizes {
                own.resize(first + parts, Vec::new());
            }
            for (t, forces) in run.forces {
                let index = first + whole((t - from) / part).min(parts - 1);
                for (own, force) in sizes.iter_mut().zip(&forces) {
                    own[index].push(force.abs());
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
pub(super) fn force_history(bench: &Bench<'_>, comparison: &Comparison) -> Result<ForceHistory> {
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
    Ok(ForceHistory::of(bench.effects, runs, length(bench)))
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
    let rows = PART_TOGETHER * length(bench) * (times.len() - 1) as f64
        / (times[times.len() - 1] - times[0]);
    whole(rows.round()).max(1)
}

/// The mean missing force over the time of the steps that end at rows.
pub(super) fn mean_missing(
    model: &dyn Model,
    recording: &Recording,
    states: &[Smoothed],
    rows: Range<usize>,
    p: &[f64],
) -> Vec<f64> {
    let mut impulse = vec![0.0; model.info().speeds];
    let mut duration = 0.0;
    for row in rows {
        let forces = Forces::new(model, recording, states, row);
        let step = forces.step();
        for (sum, force) in impulse.iter_mut().zip(forces.missing(p)) {
            *sum += force * step;
        }
        duration += step;
    }
    for force in &mut impulse {
        *force /= duration;
    }
    impulse
}

/// The step that ends at a row.
pub(super) struct Forces<'s> {
    model: &'s dyn Model,
    /// Times at the ends.
    times: [f64; 2],
    /// States at the ends.
    ends: [&'s [f64]; 2],
    /// Means between them.
    inputs: Vec<f64>,
    /// Parameters of the run that differ from those of all runs.
    differences: &'s [(usize, f64)],
}

impl<'s> Forces<'s> {
    pub(super) fn new(
        model: &'s dyn Model,
        recording: &'s Recording,
        states: &'s [Smoothed],
        row: usize,
    ) -> Self {
        let info = model.info();
        let mut inputs = vec![0.0; info.input_len()];
        inputs[..recording.input_len()].copy_from_slice(&recording.mean_inputs(row - 1));
        Self {
            model,
            times: [recording.times()[row - 1], recording.times()[row]],
            ends: [row - 1, row].map(|row| &states[row].state[..info.state_len()]),
            inputs,
            differences: recording.differences(),
        }
    }

    fn in_run(&self, p: &[f64]) -> Vec<f64> {
        let mut p = p.to_vec();
        for &(parameter, by) in self.differences {
            p[parameter] += by;
        }
        p
    }

    fn step(&self) -> f64 {
        self.times[1] - self.times[0]
    }

    /// States in the middle, and inputs.
    pub(super) fn variables(&self) -> Vec<f64> {
        let [from, to] = self.ends;
        let middle = from.iter().zip(to).map(|(a, b)| 0.5 * (a + b));
        middle.chain(self.inputs.iter().copied()).collect()
    }

    /// M (Δω/Δt − ω̇), with ω̇ the mean of both ends.
    fn missing(&self, p: &[f64]) -> Vec<f64> {
        let [before, after] = [0, 1].map(|end| self.rates(self.times[end], self.ends[end], p));
        let [from, to] = self.ends;
        let beyond = |i: usize| (to[i] - from[i]) / self.step() - 0.5 * (before[i] + after[i]);
        self.times_mass(beyond, p)
    }

    /// M (ω̇ − ω̇₀) in the middle.
    pub(super) fn between(&self, with: &[f64], without: &[f64]) -> Vec<f64> {
        let middle = self.variables();
        let x = &middle[..self.ends[0].len()];
        let [with, plain] = [with, without].map(|p| self.rates(self.times[0], x, p));
        self.times_mass(|i| with[i] - plain[i], without)
    }

    fn rates(&self, t: f64, x: &[f64], p: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; x.len()];
        let (u, p) = (&self.inputs, &self.in_run(p));
        self.model.rates(At { t, x, u, p }, &mut rates);
        rates
    }

    fn times_mass(&self, acceleration: impl Fn(usize) -> f64, p: &[f64]) -> Vec<f64> {
        let speeds = self.model.info().speeds;
        let middle = self.variables();
        let at = At {
            t: self.times[0],
            x: &middle[..self.ends[0].len()],
            u: &self.inputs,
            p: &self.in_run(p),
        };
        let (mut mass, mut bias) = (vec![0.0; speeds * speeds], vec![0.0; speeds]);
        let mut forces = vec![0.0; speeds];
        self.model.appell(at, &mut mass, &mut bias, &mut forces);
        let row = |i: usize| {
            (0..speeds)
                .map(|j| mass[i * speeds + j] * acceleration(j))
                .sum()
        };
        (0..speeds).map(row).collect()
    }
}
