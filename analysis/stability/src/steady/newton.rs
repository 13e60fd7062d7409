//! Zeros of overdetermined or underdetermined equations that may be redundant.
//!
//! Equations of steady motions are of that kind: the rate of an angle and two accelerations may all
//! require that one speed is zero, and the motions form families. The Levenberg-Marquardt method
//! with a damping proportional to the squared residual needs no rank decision and still converges
//! quadratically, to a point of the family (Yamashita and Fukushima, Computing, 2001).

use nalgebra::{DMatrix, DVector};

use appell_spectra::singular::Singular;

/// A function F of several unknowns with its Jacobian.
pub(crate) trait Equations {
    /// F(z) and ∂F/∂z.
    fn evaluate(&self, z: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>);
}

/// Largest number of steps.
const MOST_STEPS: usize = 200;
/// Residual below which a point that improves no more is a zero: rounding of a long formula,
/// relative to the effect of a unit change of the scaled unknowns.
const NEWTON_RESIDUAL: f64 = 1e-10;
/// Singular values that count as zero during the iteration, relative to the largest: only rounding,
/// as damping limits the steps along all others.
const NEWTON_RANK: f64 = 1e-13;
/// Singular values that count as zero in the dimension of a family: a zero of the equations is
/// known to about 1e-14, and smaller derivatives belong to a family.
const FAMILY_RANK: f64 = 1e-8;
/// Initial damping, and the damping at which the search fails.
const DAMPING: [f64; 2] = [1e-2, 1e12];

#[derive(Debug, Clone)]
pub(crate) struct Zero {
    pub(crate) z: DVector<f64>,
    /// Singular value decomposition of the weighted Jacobian.
    pub(crate) singular: Singular<f64>,
}

impl Zero {
    /// Dimension of the family of zeros.
    pub(crate) fn family(&self) -> usize {
        self.singular.values.len() - self.singular.rank(FAMILY_RANK)
    }

    /// Its tangent space, as columns.
    pub(crate) fn kernel(&self) -> DMatrix<f64> {
        let (columns, family) = (self.singular.values.len(), self.family());
        self.singular
            .right
            .columns(columns - family, family)
            .into_owned()
    }
}

/// Where the search ended.
#[derive(Debug, Clone)]
pub(crate) struct Missed {
    pub(crate) z: DVector<f64>,
    /// Weighted residual there; infinite where the equations have no finite value.
    pub(crate) residual: f64,
}

/// The zero reached from a point.
pub(crate) fn solve(equations: &dyn Equations, start: &DVector<f64>) -> Result<Zero, Missed> {
    let missed = |z: &DVector<f64>, residual: f64| Missed {
        z: z.clone(),
        residual,
    };
    let mut z = start.clone();
    let (mut f, mut jacobian) = equations.evaluate(&z);
    let mut damping = DAMPING[0];
    for _ in 0..MOST_STEPS {
        let weights = weights(&jacobian);
        let residual = f.component_mul(&weights).norm();
        if !residual.is_finite() || !jacobian.iter().all(|entry| entry.is_finite()) {
            return Err(missed(&z, f64::INFINITY));
        }
        let singular = Singular::of(&weighted(&jacobian, &weights));
        let mut improved = false;
        while damping < DAMPING[1] {
            let target = -f.component_mul(&weights);
            let step = damped(&singular, &target, damping * residual * residual);
            let next = &z + &step;
            let (f_next, jacobian_next) = equations.evaluate(&next);
            let better = f_next.component_mul(&weights).norm() < 0.9 * residual;
            if better && jacobian_next.iter().all(|entry| entry.is_finite()) {
                (z, f, jacobian, improved) = (next, f_next, jacobian_next, true);
                damping = (damping / 8.0).max(1e-12);
                break;
            }
            // At rounding no damping helps.
            if residual < NEWTON_RESIDUAL {
                break;
            }
            damping *= 4.0;
        }
        if !improved {
            return if residual < NEWTON_RESIDUAL {
                Ok(Zero { z, singular })
            } else {
                Err(missed(&z, residual))
            };
        }
    }
    let residual = f.component_mul(&weights(&jacobian)).norm();
    Err(missed(&z, residual))
}

/// Solves `(JᵀJ + μ 1) step = Jᵀ target`.
fn damped(singular: &Singular<f64>, target: &DVector<f64>, damping: f64) -> DVector<f64> {
    let mut step = DVector::zeros(singular.right.nrows());
    for k in 0..singular.rank(NEWTON_RANK) {
        let square = singular.values[k] * singular.values[k];
        let along = singular.images.column(k).dot(target) / (square + damping);
        step.axpy(along, &singular.right.column(k), 1.0);
    }
    step
}

/// Weights that equalise the norms of the rows. Rows that are nearly zero stay so.
pub(crate) fn weights(jacobian: &DMatrix<f64>) -> DVector<f64> {
    /// Norm, relative to the largest, below which rows are not scaled up further.
    const SHORT: f64 = 1e-6;
    let lengths: Vec<f64> = jacobian.row_iter().map(|row| row.norm()).collect();
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let weight = |length: &f64| 1.0 / length.max(SHORT * longest).max(f64::MIN_POSITIVE);
    DVector::from_iterator(lengths.len(), lengths.iter().map(weight))
}

/// The Jacobian with weighted rows.
pub(crate) fn weighted(jacobian: &DMatrix<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
    let mut result = jacobian.clone();
    for (mut row, weight) in result.row_iter_mut().zip(weights.iter()) {
        row *= *weight;
    }
    result
}
