//! Derivatives of exact derivatives by central differences, for models without formulas for them.

use crate::model::{At, Gradient, Model};

/// Step of a central difference, relative to the magnitude of the variable: truncation and rounding errors are of the
/// same order.
const STEP: f64 = 6e-6;

fn step(value: f64) -> f64 {
    STEP * value.abs().max(1.0)
}

/// [`Model::adjoint`] by differences, to about nine digits. The weighted Jacobians are differentiated along one
/// direction for each column that has a weight: `∇⟨Λ, J⟩ = Σ_j ∂(Jᵀ Λ_j)/∂z_j`.
pub fn adjoint<M: Model + ?Sized>(model: &M, at: At<'_>, weights: &[f64], mut by: Gradient<'_>) {
    let info = model.info();
    let (n, m, k, s) = (at.x.len(), at.u.len(), at.p.len(), info.speeds);
    let (lambda, rest) = weights.split_at(n);
    let (a, rest) = rest.split_at(n * n);
    let (b, mass) = rest.split_at(n * m);
    by.x.fill(0.0);
    by.u.fill(0.0);
    by.p.fill(0.0);
    let mut all = Jacobians::new(n, m, k);
    all.pull(model, at, lambda, 1.0, &mut by);
    let (mut x, mut u) = (at.x.to_vec(), at.u.to_vec());
    for j in 0..n + m {
        let column: Vec<f64> = (0..n)
            .map(|i| {
                if j < n {
                    a[i * n + j]
                } else {
                    b[i * m + j - n]
                }
            })
            .collect();
        if column.iter().all(|&weight| weight == 0.0) {
            continue;
        }
        let centre = if j < n { at.x[j] } else { at.u[j - n] };
        let h = step(centre);
        for sign in [1.0, -1.0] {
            if j < n {
                x[j] = centre + sign * h;
            } else {
                u[j - n] = centre + sign * h;
            }
            let there = At { x: &x, u: &u, ..at };
            all.pull(model, there, &column, sign / (2.0 * h), &mut by);
        }
        if j < n {
            x[j] = centre;
        } else {
            u[j - n] = centre;
        }
    }
    if mass.iter().any(|&weight| weight != 0.0) {
        let [mut m, mut bias, mut forces] = [vec![0.0; s * s], vec![0.0; s], vec![0.0; s]];
        let mut weighted = |there: At<'_>| {
            model.appell(there, &mut m, &mut bias, &mut forces);
            m.iter()
                .zip(mass)
                .map(|(m, weight)| m * weight)
                .sum::<f64>()
        };
        // The mass matrix depends on coordinates and parameters.
        slopes(at.x, by.x, info.speeds, |x| weighted(At { x, ..at }));
        slopes(at.p, by.p, 0, |p| weighted(At { p, ..at }));
    }
}

/// [`Model::parameter_jacobian`] by differences, to about nine digits.
pub fn parameter_jacobian<M: Model + ?Sized>(model: &M, at: At<'_>, p: &mut [f64]) {
    columns(at.p, p, at.p.len(), |p, column| {
        model.rates(At { p, ..at }, column);
    });
}

/// [`Model::inverse_dynamics`] from M, b and Π.
pub fn inverse_dynamics<M: Model + ?Sized>(
    model: &M,
    at: At<'_>,
    accelerations: &[f64],
    demand: &mut [f64],
) {
    let s = demand.len();
    let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
    model.appell(at, &mut mass, &mut bias, &mut forces);
    for (i, demand) in demand.iter_mut().enumerate() {
        let inertial = mass[i * s..].iter().zip(accelerations);
        *demand = inertial.map(|(m, a)| m * a).sum::<f64>() + bias[i] - forces[i];
    }
}

/// [`Model::inverse_dynamics_jacobians`] by differences, to about nine digits.
pub fn inverse_dynamics_jacobians<M: Model + ?Sized>(
    model: &M,
    at: At<'_>,
    accelerations: &[f64],
    [demand, by_state, by_inputs, mass]: [&mut [f64]; 4],
) {
    model.inverse_dynamics(at, accelerations, demand);
    columns(at.x, by_state, at.x.len(), |x, column| {
        model.inverse_dynamics(At { x, ..at }, accelerations, column);
    });
    columns(at.u, by_inputs, at.u.len(), |u, column| {
        model.inverse_dynamics(At { u, ..at }, accelerations, column);
    });
    let s = demand.len();
    model.appell(at, mass, &mut vec![0.0; s], &mut vec![0.0; s]);
}

/// [`Model::output_jacobians`] by differences, to about nine digits.
pub fn output_jacobians<M: Model + ?Sized>(
    model: &M,
    at: At<'_>,
    [outputs, c, d]: [&mut [f64]; 3],
) {
    model.outputs(at, outputs);
    let (n, m, l) = (at.x.len(), at.u.len(), outputs.len());
    let mut there = vec![0.0; l];
    columns(at.x, c, n, |x, column| {
        model.outputs(At { x, ..at }, &mut there);
        column.copy_from_slice(&there);
    });
    columns(at.u, d, m, |u, column| {
        model.outputs(At { u, ..at }, &mut there);
        column.copy_from_slice(&there);
    });
}

/// [`Model::output_adjoint`] by differences: to about nine digits if the model has formulas for the Jacobians of its
/// outputs, otherwise to about seven.
pub fn output_adjoint<M: Model + ?Sized>(model: &M, at: At<'_>, weights: &[f64], by: Gradient<'_>) {
    let (n, m) = (at.x.len(), at.u.len());
    let l = model.info().output_len();
    let [mut y, mut c, mut d] = [vec![0.0; l], vec![0.0; l * n], vec![0.0; l * m]];
    let mut weighted = |there: At<'_>| {
        model.output_jacobians(there, &mut y, &mut c, &mut d);
        let all = y.iter().chain(&c).chain(&d);
        all.zip(weights)
            .map(|(value, weight)| value * weight)
            .sum::<f64>()
    };
    let Gradient { x, u, p } = by;
    wide_slopes(at.x, x, |x| weighted(At { x, ..at }));
    wide_slopes(at.u, u, |u| weighted(At { u, ..at }));
    wide_slopes(at.p, p, |p| weighted(At { p, ..at }));
}

/// Gradient of a scalar that may itself contain differences: of order four, with a step far above their rounding
/// errors.
fn wide_slopes(at: &[f64], by: &mut [f64], mut scalar: impl FnMut(&[f64]) -> f64) {
    let mut varied = at.to_vec();
    for j in 0..at.len() {
        let h = 300.0 * step(at[j]);
        let mut at_offset = |offset: f64| {
            varied[j] = at[j] + offset * h;
            let value = scalar(&varied);
            varied[j] = at[j];
            value
        };
        let near = at_offset(1.0) - at_offset(-1.0);
        let far = at_offset(2.0) - at_offset(-2.0);
        by[j] = (8.0 * near - far) / (12.0 * h);
    }
}

/// Adds the gradient of a scalar with respect to the variables from `first` on.
fn slopes(at: &[f64], by: &mut [f64], first: usize, mut scalar: impl FnMut(&[f64]) -> f64) {
    let mut varied = at.to_vec();
    for j in first..at.len() {
        let h = step(at[j]);
        varied[j] = at[j] + h;
        let above = scalar(&varied);
        varied[j] = at[j] - h;
        by[j] += (above - scalar(&varied)) / (2.0 * h);
        varied[j] = at[j];
    }
}

/// Jacobian of a vector function, one column of `matrix` per variable.
fn columns(
    at: &[f64],
    matrix: &mut [f64],
    width: usize,
    mut vector: impl FnMut(&[f64], &mut [f64]),
) {
    let rows = matrix.len().checked_div(width).unwrap_or(0);
    let (mut varied, mut above, mut below) = (at.to_vec(), vec![0.0; rows], vec![0.0; rows]);
    for j in 0..at.len() {
        let h = step(at[j]);
        varied[j] = at[j] + h;
        vector(&varied, &mut above);
        varied[j] = at[j] - h;
        vector(&varied, &mut below);
        varied[j] = at[j];
        for row in 0..rows {
            matrix[row * width + j] = (above[row] - below[row]) / (2.0 * h);
        }
    }
}

/// All first derivatives of the rates.
struct Jacobians {
    rates: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    p: Vec<f64>,
}

impl Jacobians {
    fn new(n: usize, m: usize, k: usize) -> Self {
        let zeros = |len| vec![0.0; len];
        Self {
            rates: zeros(n),
            a: zeros(n * n),
            b: zeros(n * m),
            p: zeros(n * k),
        }
    }

    /// Adds `factor` times the gradient of ⟨λ, ẋ⟩ at a point.
    fn pull<M: Model + ?Sized>(
        &mut self,
        model: &M,
        at: At<'_>,
        lambda: &[f64],
        factor: f64,
        by: &mut Gradient<'_>,
    ) {
        model.jacobians(at, &mut self.rates, &mut self.a, &mut self.b);
        model.parameter_jacobian(at, &mut self.p);
        let parts = [
            (&self.a, &mut *by.x),
            (&self.b, &mut *by.u),
            (&self.p, &mut *by.p),
        ];
        for (matrix, by) in parts.into_iter().filter(|(_, by)| !by.is_empty()) {
            for (row, &weight) in matrix.chunks_exact(by.len()).zip(lambda) {
                for (by, &slope) in by.iter_mut().zip(row) {
                    *by += factor * weight * slope;
                }
            }
        }
    }
}
