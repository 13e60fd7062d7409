//! Robust (sandwich) covariance from block scores.
//!
//! If the model is wrong, or noise is not white, neighbouring scores are correlated and the inverse
//! information is too small. Blocks longer than this correlation are independent (P. J. Huber,
//! 1967; H. R. Künsch, *The jackknife and the bootstrap for general stationary observations*,
//! 1989).

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use crate::EstimateError;
use crate::fitting::fit::{Fit, inverse};
use crate::gradient::sensitivity::Sensitivity;

/// Scores of a fit in blocks of rows.
#[derive(Debug, Clone)]
pub struct Blocks {
    /// Inverse of the curvature.
    covariance: DMatrix<f64>,
    /// Score of each block.
    scores: Vec<DVector<f64>>,
}

impl Blocks {
    /// Blocks of a number of rows within runs. `sensitivity` is that of the fit.
    pub fn of(fit: &Fit, sensitivity: &Sensitivity, rows: usize) -> Result<Self, EstimateError> {
        let all = sensitivity.scores();
        let mut blocks: BTreeMap<(usize, usize), DVector<f64>> = BTreeMap::new();
        for (place, (run, sample)) in sensitivity.samples.iter().enumerate() {
            let block = (*run, sample.row / rows.max(1));
            let sum = blocks
                .entry(block)
                .or_insert_with(|| DVector::zeros(all.ncols()));
            *sum += all.row(place).transpose();
        }
        Ok(Self {
            covariance: inverse(&fit.curvature, &fit.at_limit)?,
            scores: blocks.into_values().collect(),
        })
    }

    /// Number of blocks. With fewer than about twenty the covariance is unreliable.
    pub fn len(&self) -> usize {
        self.scores.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.scores.is_empty()
    }

    /// The robust covariance of the coordinates, `H⁻¹ J H⁻¹`: H the observed curvature, J the sum of the
    /// squares of the scores about their mean.
    pub fn covariance(&self) -> DMatrix<f64> {
        let centred = self.centred();
        let k = self.covariance.nrows();
        let mut squares = DMatrix::zeros(k, k);
        for score in &centred {
            squares += score * score.transpose();
        }
        // Correction for the estimated mean.
        let count = centred.len() as f64;
        let correction = count / (count - 1.0).max(1.0);
        &self.covariance * squares * &self.covariance * correction
    }

    /// Bootstrap changes of the coordinates: blocks drawn with replacement, one scoring step each
    /// (P. Kline and A. Santos, *A score based approach to wild bootstrap inference*, 2012). The
    /// same `seed` gives the same draws.
    pub fn bootstrap(&self, draws: usize, seed: u64) -> Vec<DVector<f64>> {
        let centred = self.centred();
        let mut random = SplitMix64::seed_from_u64(seed);
        let count = centred.len() as u64;
        let change = |_| {
            let mut sum = DVector::zeros(self.covariance.nrows());
            for _ in 0..count {
                let place = usize::try_from(random.next_u64() % count).unwrap_or(0);
                sum += &centred[place];
            }
            &self.covariance * sum
        };
        (0..draws).map(change).collect()
    }

    fn centred(&self) -> Vec<DVector<f64>> {
        let mut mean = DVector::zeros(self.covariance.nrows());
        for score in &self.scores {
            mean += score;
        }
        mean /= self.scores.len().max(1) as f64;
        self.scores.iter().map(|score| score - &mean).collect()
    }
}
