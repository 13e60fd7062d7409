//! Forces in a step of a smoothed motion: the mass matrix times the acceleration in excess of the equations.

use std::ops::Range;

use appell_estimate::{Recording, Smoothed};
use appell_runtime::model::{At, Model};

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
        let own = forces.missing(p);
        impulse
            .iter_mut()
            .zip(own)
            .for_each(|(sum, force)| *sum += force * step);
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
    pub(super) fn missing(&self, p: &[f64]) -> Vec<f64> {
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
