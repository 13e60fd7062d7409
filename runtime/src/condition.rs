//! How far the linear systems of a model are from being singular.

use crate::dense::lu_solve_in_place;
use crate::model::{At, Model};

/// Power iterations; a condition number is wanted to one digit.
const ITERATIONS: usize = 40;

/// The smallest condition number that a choice of units for rows and columns can give a matrix,
/// `n` × `n`, row by row: the spectral radius of |A⁻¹| |A| (F. L. Bauer, Numerische Mathematik 5,
/// 1963; N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, section 7.3).
///
/// 1 for a diagonal matrix, infinite for a singular one; about log₁₀ of it are the digits that a
/// solution loses. NaN where an entry is not finite or the length is not n².
pub fn condition_number(matrix: &[f64], n: usize) -> f64 {
    if matrix.len() != n * n || matrix.iter().any(|entry| !entry.is_finite()) {
        return f64::NAN;
    }
    if n == 0 {
        return 1.0;
    }
    let mut factors = matrix.to_vec();
    let mut inverse = vec![0.0; n * n];
    inverse.iter_mut().step_by(n + 1).for_each(|one| *one = 1.0);
    let pivot = lu_solve_in_place(&mut factors, &mut inverse, n);
    if pivot == 0.0 || inverse.iter().any(|entry| !entry.is_finite()) {
        return f64::INFINITY;
    }
    // |A⁻¹| |A| has no negative entry and none below 1 on the diagonal: powers of it approach its
    // largest eigenvalue from any positive vector.
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
    /// Of each system of [`Model::system_sizes`], which is solved for generalised velocities.
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
            systems: systems.collect(),
        }
    }

    /// All of them, the mass matrix first.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        std::iter::once(self.mass_matrix).chain(self.systems.iter().copied())
    }
}
