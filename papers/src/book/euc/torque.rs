//! The driving torque as in the paper: from two sets of equations, moment by moment.

use appell_estimate::inverse::InputEquations;
use appell_models::Shipped;
use appell_runtime::model::{At, Model};

use super::laboratory::View;
use crate::book::{computation, failed};
use appell::Error;

/// A planar model of the paper.
#[derive(Clone, Copy)]
pub(super) struct Planar {
    pub(super) model: &'static dyn Model,
    /// Its name in the paper.
    pub(super) name: &'static str,
}

/// Measured quantities at a moment: γ and φ with two derivatives each, and the forward
/// acceleration.
struct Moment {
    gamma: [f64; 3],
    phi: [f64; 3],
    forward: f64,
}

/// The torque of a run from two sets of equations.
pub(super) struct Torques {
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
}

impl Planar {
    /// The models with three and with two degrees of freedom.
    pub(super) fn both() -> Result<[Self; 2], Error> {
        let planar = |shipped: &str, name: &'static str| {
            let found = Shipped::find(shipped);
            let found =
                found.ok_or_else(|| failed(&format!("no shipped mechanism `{shipped}`")))?;
            let model = found.model;
            Ok::<_, Error>(Self { model, name })
        };
        Ok([planar("euc_3dof", "3 DoF")?, planar("euc_2dof", "2 DoF")?])
    }

    /// (9) and (10), or (13), at every so many frames of a run.
    pub(super) fn torques(
        self,
        view: &View,
        run: usize,
        height: f64,
        every: usize,
    ) -> Result<Torques, Error> {
        let info = self.model.info();
        let mut p = info.default_parameters();
        let h = info.parameter_index("h");
        p[h.ok_or_else(|| failed("the model has no `h`"))?] = height;
        let smoothed = &view.smoothed[run];
        let mut torques = Torques {
            first: Vec::new(),
            second: Vec::new(),
        };
        for row in (0..view.rides[run].times.len()).step_by(every) {
            let three = |channel: usize| -> [f64; 3] {
                let all = smoothed.channels[channel].at(row);
                [all[0], all[1], all[2]]
            };
            let moment = Moment {
                gamma: three(1),
                phi: three(2),
                forward: smoothed.acceleration[row][0],
            };
            let [first, second] = self.at(&moment, &p)?;
            torques.first.push(first);
            torques.second.push(second);
        }
        Ok(torques)
    }

    fn at(self, moment: &Moment, p: &[f64]) -> Result<[f64; 2], Error> {
        let info = self.model.info();
        let mut x = info.initial_state();
        x.fill(0.0);
        for (name, value) in [
            ("gamma", moment.gamma[0]),
            ("phi", moment.phi[0]),
            ("gamma_dot", moment.gamma[1]),
            ("phi_dot", moment.phi[1]),
        ] {
            if let Some(index) = info.state_index(name) {
                x[index] = value;
            }
        }
        let u = vec![0.0; info.input_len()];
        let at = At {
            t: 0.0,
            x: &x,
            u: &u,
            p,
        };
        let equations = InputEquations::at(self.model, at).map_err(computation)?;
        let accelerations: Vec<Option<f64>> = (info.speed_quantities().iter())
            .map(|speed| match speed.name.as_ref() {
                "v" => Some(moment.forward),
                "gamma_dot" => Some(moment.gamma[2]),
                _ => Some(moment.phi[2]),
            })
            .collect();
        let all: Vec<usize> = (0..info.speeds).collect();
        // As many equations as inputs; then one more, with the forward acceleration unknown.
        let first = equations.solve(&accelerations, &all[..info.declared_inputs]);
        let mut without = accelerations.clone();
        without[0] = None;
        let second = equations.solve(&without, &all);
        Ok([
            first.map_err(computation)?.inputs[0],
            second.map_err(computation)?.inputs[0],
        ])
    }

    /// Root mean square of the difference of the two torques over all runs.
    pub(super) fn error(self, view: &View, height: f64) -> Result<f64, Error> {
        /// Neighbouring frames share their window; every fourth is sufficient.
        const EVERY: usize = 4;
        let (mut squares, mut count) = (0.0, 0);
        for run in 0..view.rides.len() {
            let torques = self.torques(view, run, height, EVERY)?;
            let pairs = torques.first.iter().zip(&torques.second);
            squares += pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            count += torques.first.len();
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
    pub(super) fn of(planar: Planar, view: &View) -> Result<Self, Error> {
        let [low, high] = HEIGHTS;
        let step = (high - low) / (COUNT - 1) as f64;
        let heights: Vec<f64> = (0..COUNT).map(|i| low + step * i as f64).collect();
        let errors = heights.iter().map(|&h| planar.error(view, h));
        let errors: Vec<f64> = errors.collect::<Result<_, _>>()?;
        let best = (0..COUNT)
            .min_by(|&a, &b| errors[a].total_cmp(&errors[b]))
            .unwrap_or(0);
        // A parabola through the three lowest.
        let middle = best.clamp(1, COUNT - 2);
        let [a, b, c] = [errors[middle - 1], errors[middle], errors[middle + 1]];
        let curvature = a - 2.0 * b + c;
        let off = if best == middle && curvature > 0.0 {
            0.5 * (a - c) / curvature
        } else {
            0.0
        };
        let height = if best == middle {
            heights[middle] + off * step
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
