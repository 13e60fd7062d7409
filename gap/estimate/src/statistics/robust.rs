//! Robust (sandwich) covariance from block scores.
//!
//! If the model is wrong, or noise is not white, neighbouring scores are correlated and the inverse
//! information is too small. Blocks longer than this correlation are independent (P. J. Huber,
//! 1967; H. R. Künsch, *The jackknife and the bootstrap for general stationary observations*,
//! 1989).

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::EstimateError;
use crate::fitting::fit::{Fit, inverse};
use crate::gradient::sensitivity::Sensitivity;

/// The robust covariance of the coordinates, `H⁻¹ J H⁻¹`: H the observed curvature, J the sum of the
/// squares of the scores of blocks about their mean.
///
/// A block has a number of `rows` within a run; with fewer than about twenty blocks the covariance is
/// unreliable. `sensitivity` is that of the fit.
pub fn robust_covariance(
    fit: &Fit,
    sensitivity: &Sensitivity,
    rows: usize,
) -> Result<DMatrix<f64>, EstimateError> {
    let all = sensitivity.scores();
    let mut blocks: BTreeMap<(usize, usize), DVector<f64>> = BTreeMap::new();
    for (place, (run, sample)) in sensitivity.samples.iter().enumerate() {
        let block = (*run, sample.row / rows.max(1));
        let sum = blocks
            .entry(block)
            .or_insert_with(|| DVector::zeros(all.ncols()));
        *sum += all.row(place).transpose();
    }
    let covariance = inverse(&fit.curvature, &fit.at_limit)?;
    let k = covariance.nrows();
    let mut mean = DVector::zeros(k);
    for score in blocks.values() {
        mean += score;
    }
    mean /= blocks.len().max(1) as f64;
    let mut squares = DMatrix::zeros(k, k);
    for score in blocks.values() {
        let centred = score - &mean;
        squares += &centred * centred.transpose();
    }
    // Correction for the estimated mean.
    let count = blocks.len() as f64;
    let correction = count / (count - 1.0).max(1.0);
    Ok(&covariance * squares * &covariance * correction)
}
