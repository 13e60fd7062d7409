//! Condition numbers of the linear systems of a model.

use crate::dense::solved_in_place;
use crate::model::{At, Model};

/// Power iterations; one digit of a condition number suffices.
const ITERATIONS: usize = 40;

/// The minimum of the condition number of a matrix over all row and column scalings, `n` × `n`, row by row: the
/// spectral radius of |A⁻¹| |A| (F. L. Bauer, Numerische Mathematik 5, 1963; N. J. Higham, *Accuracy and Stability of
/// Numerical Algorithms*, section 7.3).
///
/// 1 for a diagonal matrix, infinite for a singular one; a solution loses about log₁₀ of it in digits. NaN if an
/// entry is not finite or the length is not n².
pub fn condition_number(matrix: &[f64], n: usize) -> f64 {
    if matrix.len() != n * n || matrix.iter().any(|entry| !entry.is_finite()) {
        return f64::NAN;
    }
    if n == 0 {
        return 1.0;
    }
    let Some(inverse) = inverse(matrix, n) else {
        return f64::INFINITY;
    };
    // |A⁻¹| |A| is non-negative with a diagonal of at least 1: power iteration converges to its largest eigenvalue
    // from any positive vector.
    let (mut x, mut radius) = (vec![1.0; n], 1.0);
    for _ in 0..ITERATIONS {
        x = absolute_product(&inverse, &absolute_product(matrix, &x));
        radius = x.iter().copied().fold(0.0, f64::max);
        for component in &mut x {
            *component /= radius;
        }
    }
    radius
}

/// A⁻¹, row by row; `None` if the matrix is singular up to rounding.
fn inverse(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut factors = matrix.to_vec();
    let mut inverse = vec![0.0; n * n];
    inverse.iter_mut().step_by(n + 1).for_each(|one| *one = 1.0);
    solved_in_place(&mut factors, &mut inverse, n).then_some(inverse)
}

/// Condition number of the map from pseudo-velocities to generalised velocities, in SI: the product of the Frobenius
/// norms of G = ∂q̇/∂ω and of its pseudo-inverse, divided by the number of pseudo-velocities. 1 if G preserves
/// lengths and angles, infinite if q̇ is not finite.
pub fn velocity_condition(model: &dyn Model, at: At<'_>) -> f64 {
    let (n, s) = (model.info().state_len(), model.info().speeds);
    if s == 0 {
        return 1.0;
    }
    // q̇ is affine in ω: the constant part is prescribed by time.
    let mut x = at.x.to_vec();
    let mut rates_for = |speed: Option<usize>| {
        x[..s].fill(0.0);
        if let Some(speed) = speed {
            x[speed] = 1.0;
        }
        let mut rates = vec![0.0; n];
        model.rates(At { x: &x, ..at }, &mut rates);
        rates.split_off(s)
    };
    let drift = rates_for(None);
    let columns: Vec<Vec<f64>> = (0..s)
        .map(|speed| {
            let rates = rates_for(Some(speed));
            rates.iter().zip(&drift).map(|(a, b)| a - b).collect()
        })
        .collect();
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let pairs = columns
        .iter()
        .flat_map(|a| columns.iter().map(|b| product(a, b)));
    let gram: Vec<f64> = pairs.collect();
    if gram.iter().any(|entry| !entry.is_finite()) {
        return f64::INFINITY;
    }
    let trace = |matrix: &[f64]| -> f64 { matrix.iter().step_by(s + 1).sum() };
    inverse(&gram, s).map_or(f64::INFINITY, |inverse| {
        (trace(&gram) * trace(&inverse)).sqrt() / s as f64
    })
}

/// |A| x
fn absolute_product(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    let row = |row: &[f64]| row.iter().zip(x).map(|(a, x)| a.abs() * x).sum();
    matrix.chunks(x.len()).map(row).collect()
}

/// Condition numbers at one state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Conditions {
    /// Of the mass matrix.
    pub mass_matrix: f64,
    /// Of the map from pseudo-velocities to generalised velocities; see [`velocity_condition`].
    pub velocities: f64,
    /// Of each linear system of [`Model::system_sizes`], solved for generalised velocities.
    pub systems: Vec<f64>,
}

impl Conditions {
    /// Of the systems of a model. See [`condition_number`].
    pub fn of(model: &dyn Model, at: At<'_>) -> Self {
        let s = model.info().speeds;
        let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
        model.appell(at, &mut mass, &mut bias, &mut forces);
        let sizes = model.system_sizes();
        let mut matrices = vec![0.0; sizes.iter().map(|n| n * n).sum()];
        if !sizes.is_empty() {
            model.systems(at, &mut matrices);
        }
        let mut rest = matrices.as_slice();
        let systems = sizes.iter().map(|&n| {
            let (matrix, others) = rest.split_at(n * n);
            rest = others;
            condition_number(matrix, n)
        });
        Self {
            mass_matrix: condition_number(&mass, s),
            velocities: velocity_condition(model, at),
            systems: systems.collect(),
        }
    }

    /// All of them in the order of the fields; [`Conditions::names`] lists their names.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        let first = [self.mass_matrix, self.velocities];
        first.into_iter().chain(self.systems.iter().copied())
    }

    /// Names of the systems: `mass_matrix`, `velocities`, `system_1`, ….
    pub fn names(model: &dyn Model) -> impl Iterator<Item = String> {
        let systems = 1..=model.system_sizes().len();
        let first = ["mass_matrix", "velocities"].map(str::to_owned);
        first
            .into_iter()
            .chain(systems.map(|i| format!("system_{i}")))
    }
}
