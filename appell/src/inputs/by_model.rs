//! Inputs that a law computes from the equations of motion.
//!
//! Appell's equations are linear in the inputs, M ω̇ + b − Π₀ = E u. Gravity compensation solves them for the
//! inputs at rest, ω = ω̇ = 0; computed torque for those of desired accelerations (B. R. Markiewicz, 1973;
//! J. Y. S. Luh, M. W. Walker, R. P. C. Paul, 1980). Accelerations without a desired value are unknowns like the
//! inputs; an overdetermined system is solved by least squares.

use appell_analysis::control::sampled::Sampling;
use appell_estimate::inverse::InputEquations;
use appell_runtime::model::{At, Model};

use super::feedback::Aim;

/// A law in one motion.
pub(super) struct ModelLaw {
    pub(super) inputs: Vec<usize>,
    pub(super) aim: Aim,
    pub(super) believed: Vec<(usize, f64)>,
    /// Of a discrete-time law.
    pub(super) sampling: Option<Sampling>,
}

impl ModelLaw {
    /// Its inputs, given the other inputs and the signals in `at.u`. `desired` has the controlled coordinates with their
    /// first and second derivatives. Inputs that the equations do not determine are not finite.
    pub(super) fn asked(&self, model: &dyn Model, at: At<'_>, desired: &[[f64; 3]]) -> Vec<f64> {
        let mut p = at.p.to_vec();
        for &(parameter, value) in &self.believed {
            p[parameter] = value;
        }
        let found = self.inputs_at(model, At { p: &p, ..at }, desired);
        found.unwrap_or_else(|| vec![f64::NAN; self.inputs.len()])
    }

    fn inputs_at(&self, model: &dyn Model, at: At<'_>, desired: &[[f64; 3]]) -> Option<Vec<f64>> {
        let speeds = model.info().speeds;
        let mut x = at.x.to_vec();
        let accelerations = match &self.aim {
            Aim::GravityCompensation => {
                x[..speeds].fill(0.0);
                vec![Some(0.0); speeds]
            }
            Aim::ComputedTorque {
                followed,
                stiffness,
                damping,
            } => {
                let mut accelerations = vec![None; speeds];
                for (followed, [q, rate, acceleration]) in followed.iter().zip(desired) {
                    let error = at.x[followed.coordinate] - q;
                    let error_rate = at.x[followed.speed] - rate;
                    let asked = acceleration - damping * error_rate - stiffness * error;
                    accelerations[followed.speed] = Some(asked);
                }
                accelerations
            }
        };
        let mut equations = InputEquations::at(model, At { x: &x, ..at }).ok()?;
        for (input, column) in equations.inputs.column_iter().enumerate() {
            if !self.inputs.contains(&input) {
                equations.free -= column * at.u[input];
            }
        }
        equations.inputs = equations.inputs.select_columns(&self.inputs);
        let rows: Vec<usize> = (0..speeds).collect();
        let solved = equations.solve(&accelerations, &rows).ok()?;
        Some(solved.inputs)
    }
}
