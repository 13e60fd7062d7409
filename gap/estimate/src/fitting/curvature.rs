//! Curvature of the log-posterior at a point.
//!
//! - *Expected*: Fisher information, positive semidefinite, correct if the model is.
//! - *Observed*: from gradients at neighbouring points, for any model. If it is not positive
//!   definite, it is modified in the metric of the expected one (Y. Dauphin et al., *Identifying
//!   and attacking the saddle point problem*, 2014).
//! - *Updated*: from the steps of a search (BFGS with Powell's damping; J. Nocedal and S. J.
//!   Wright, *Numerical Optimization*, 2006, procedure 18.2).

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::posterior::{Point, Posterior};
use crate::EstimateError;
use crate::gradient::sensitivity::Sensitivity;

/// Step of the differences of gradients, in expected standard deviations.
const DIFFERENCE: f64 = 1e-2;
/// Least curvature in any direction, relative to the expected one.
const LEAST: f64 = 1e-3;

impl Posterior<'_, '_> {
    /// Expected curvature, made positive definite.
    pub(crate) fn expected(&self, point: &Point) -> Result<DMatrix<f64>, EstimateError> {
        let data = Sensitivity::of(self.estimation, &point.values, self.selection.free)?;
        let prior = DMatrix::from_diagonal(&self.selection.prior_information());
        Ok(data.information() + prior)
    }

    /// Observed curvature, by differences of the exact gradient.
    pub(crate) fn observed(
        &self,
        point: &Point,
        expected: &DMatrix<f64>,
    ) -> Result<DMatrix<f64>, EstimateError> {
        let count = point.coordinates.len();
        let mut columns = DMatrix::zeros(count, count);
        for i in 0..count {
            let change = DIFFERENCE * scale(expected[(i, i)]);
            let slope = |change: f64| -> Result<DVector<f64>, EstimateError> {
                let mut step = DVector::zeros(count);
                step[i] = change;
                let beside = self.moved(point, &step)?;
                let moved = beside.coordinates[i] - point.coordinates[i];
                Ok((&point.gradient - &beside.gradient) / moved)
            };
            // One-sided at a limit.
            let column = slope(-change)
                .ok()
                .filter(|column| column.iter().all(|entry| entry.is_finite()));
            columns.set_column(i, &column.map_or_else(|| slope(change), Ok)?);
        }
        Ok(mended(&(0.5 * (&columns + columns.transpose())), expected))
    }
}

/// One standard deviation of an entry of an information matrix; 1 where there is no information.
fn scale(information: f64) -> f64 {
    if information > 0.0 {
        information.sqrt().recip()
    } else {
        1.0
    }
}

/// The curvature with its eigenvalues, relative to the expected one, made positive.
fn mended(observed: &DMatrix<f64>, expected: &DMatrix<f64>) -> DMatrix<f64> {
    if expected.is_empty() {
        return expected.clone();
    }
    let scales = expected.diagonal().map(scale);
    let scaled = |matrix: &DMatrix<f64>| {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
            matrix[(i, j)] * scales[i] * scales[j]
        })
    };
    let mut metric = scaled(expected);
    for i in 0..metric.nrows() {
        // Values without information keep their scale; a small term keeps the root real.
        metric[(i, i)] = metric[(i, i)].max(1.0) + 1e-9;
    }
    let Some(root) = metric.cholesky().map(|factor| factor.l()) else {
        return expected.clone();
    };
    let inverse = root
        .clone()
        .solve_lower_triangular(&DMatrix::identity(scales.len(), scales.len()));
    let Some(inverse) = inverse else {
        return expected.clone();
    };
    let whitened = &inverse * scaled(observed) * inverse.transpose();
    if whitened.iter().any(|entry| !entry.is_finite()) {
        return expected.clone();
    }
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = SymmetricEigen::new(whitened);
    let positive = eigenvalues.map(|value| value.abs().max(LEAST));
    let back = root * eigenvectors;
    let mended = &back * DMatrix::from_diagonal(&positive) * back.transpose();
    DMatrix::from_fn(scales.len(), scales.len(), |i, j| {
        mended[(i, j)] / (scales[i] * scales[j])
    })
}

/// Updates the curvature by the change of the gradient along a step; it stays positive definite.
pub(crate) fn learn(curvature: &mut DMatrix<f64>, from: &Point, to: &Point) {
    let moved = &to.coordinates - &from.coordinates;
    let change = &from.gradient - &to.gradient;
    let expected = &*curvature * &moved;
    let (bent, along) = (moved.dot(&expected), moved.dot(&change));
    if bent <= 0.0 || !along.is_finite() {
        return;
    }
    let part = if along >= 0.2 * bent {
        1.0
    } else {
        0.8 * bent / (bent - along)
    };
    let change = change * part + &expected * (1.0 - part);
    let along = moved.dot(&change);
    *curvature += &change * change.transpose() / along - &expected * expected.transpose() / bent;
}
