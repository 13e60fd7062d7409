//! The driving torque as in the paper: from two sets of equations, moment by moment.

use appell_estimate::inverse::InputEquations;
use appell_runtime::model::{At, Model, Quantity};

use super::laboratory::View;
use crate::book::{Result, computation, parameter, shipped};
use appell::Error;

/// A planar model of the paper.
#[derive(Clone, Copy)]
pub(super) struct Planar {
    pub(super) model: &'static dyn Model,
    /// Its name in the paper.
    pub(super) name: &'static str,
}

impl Planar {
    /// The models with three and with two degrees of freedom.
    pub(super) fn both() -> Result<[Self; 2]> {
        let planar = |mechanism: &str, name: &'static str| {
            let model = shipped(mechanism)?.model;
            Ok::<_, Error>(Self { model, name })
        };
        Ok([planar("euc_3dof", "3 DoF")?, planar("euc_2dof", "2 DoF")?])
    }

    /// The torque of a run from both sets of equations, (9) and (10) or (13), at every so many frames.
    pub(super) fn torques(
        self,
        view: &View,
        run: usize,
        height: f64,
        every: usize,
    ) -> Result<Vec<[f64; 2]>> {
        let info = self.model.info();
        let mut p = info.default_parameters();
        p[parameter(info, "h")?] = height;
        let smoothed = &view.smoothed[run];
        let rows = (0..view.rides[run].times.len()).step_by(every);
        let torques = rows.map(|row| {
            let [gamma, phi] = [1, 2].map(|channel| smoothed.channels[channel].at(row));
            let [forward, ..] = smoothed.acceleration[row];
            let measured = [
                ("gamma", gamma[0]),
                ("phi", phi[0]),
                ("gamma_dot", gamma[1]),
                ("phi_dot", phi[1]),
            ];
            let accelerations = [("v", forward), ("gamma_dot", gamma[2]), ("phi_dot", phi[2])];
            self.at(&measured, &accelerations, &p)
        });
        torques.collect()
    }

    /// Both torques from the measured states and accelerations.
    fn at(
        self,
        measured: &[(&str, f64)],
        accelerations: &[(&str, f64)],
        p: &[f64],
    ) -> Result<[f64; 2]> {
        let info = self.model.info();
        let mut x = vec![0.0; info.state_len()];
        for (name, value) in measured {
            if let Some(index) = info.state_index(name) {
                x[index] = *value;
            }
        }
        let at = At {
            t: 0.0,
            x: &x,
            u: &vec![0.0; info.input_len()],
            p,
        };
        let equations = InputEquations::at(self.model, at).map_err(computation)?;
        let acceleration = |speed: &Quantity| {
            let known = accelerations.iter().find(|(name, _)| *name == speed.name);
            known.map(|(_, value)| *value)
        };
        let accelerations: Vec<Option<f64>> =
            info.speed_quantities().iter().map(acceleration).collect();
        let all: Vec<usize> = (0..info.speeds).collect();
        // As many equations as inputs; then one more, with the forward acceleration unknown.
        let first = equations.solve(&accelerations, &all[..info.declared_inputs]);
        let mut without = accelerations.clone();
        without[0] = None;
        let second = equations.solve(&without, &all);
        Ok([
            first.map_err(computation)?[0],
            second.map_err(computation)?[0],
        ])
    }

    /// Root mean square of the difference of the two torques over all runs.
    pub(super) fn error(self, view: &View, height: f64) -> Result<f64> {
        /// Neighbouring frames share their window; every fourth is sufficient.
        const EVERY: usize = 4;
        let (mut squares, mut count) = (0.0, 0);
        for run in 0..view.rides.len() {
            let torques = self.torques(view, run, height, EVERY)?;
            squares += torques.iter().map(|[a, b]| (a - b).powi(2)).sum::<f64>();
            count += torques.len();
        }
        Ok((squares / count as f64).sqrt())
    }
}

/// The error over the height, and where it is least.
pub(super) struct Curve {
    pub(super) heights: Vec<f64>,
    pub(super) errors: Vec<f64>,
    /// Height and error at the minimum.
    pub(super) least: [f64; 2],
}

/// Tested heights in m.
const HEIGHTS: [f64; 2] = [0.1, 1.6];
const COUNT: usize = 31;

impl Curve {
    pub(super) fn of(planar: Planar, view: &View) -> Result<Self> {
        let [low, high] = HEIGHTS;
        let step = (high - low) / (COUNT - 1) as f64;
        let heights: Vec<f64> = (0..COUNT).map(|i| low + step * i as f64).collect();
        let errors = heights.iter().map(|&h| planar.error(view, h));
        let errors: Vec<f64> = errors.collect::<Result<_>>()?;
        let best = (0..COUNT)
            .min_by(|&a, &b| errors[a].total_cmp(&errors[b]))
            .unwrap_or(0);
        // A parabola through the three lowest.
        let middle = best.clamp(1, COUNT - 2);
        let [a, b, c] = [errors[middle - 1], errors[middle], errors[middle + 1]];
        let curvature = a - 2.0 * b + c;
        let height = if best == middle && curvature > 0.0 {
            heights[middle] + 0.5 * (a - c) / curvature * step
        } else {
            heights[best]
        };
        let least = [height, planar.error(view, height)?];
        Ok(Self {
            heights,
            errors,
            least,
        })
    }

    /// Whether the error still falls at the last tested height.
    pub(super) fn is_open(&self) -> bool {
        let [low, high] = HEIGHTS;
        !(low < self.least[0] && self.least[0] < high)
    }

    /// Difference of the largest and the least error in N m: small if the height hardly affects the
    /// torques.
    pub(super) fn rise(&self) -> f64 {
        let largest = self.errors.iter().copied().fold(0.0, f64::max);
        largest - self.least[1]
    }
}
