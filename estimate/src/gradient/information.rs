//! Fast Fisher information of some values, for the curvature of a search.
//!
//! Values that affect the mean are differentiated in one pass ([`tangent`](super::tangent)). Levels
//! of disturbances and of noise change the gains and the variances of innovations; they are
//! differentiated by differences along the longest recording, and their information is scaled with
//! the number of rows. The expected cross-information of the two is zero.

use nalgebra::DMatrix;

use super::tangent::Direction;
use crate::EstimateError;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::fitting::free::{Free, Selection};
use crate::kalman::filter::Innovation;

impl Estimation<'_> {
    /// Fisher information of the coordinates of some values, without priors.
    pub fn information(
        &self,
        values: &[f64],
        free: &[Free],
    ) -> Result<DMatrix<f64>, EstimateError> {
        Ok(self.information_of_means(values, free)? + self.information_of_levels(values, free)?)
    }

    /// The part of values that affect the mean.
    pub(crate) fn information_of_means(
        &self,
        values: &[f64],
        free: &[Free],
    ) -> Result<DMatrix<f64>, EstimateError> {
        let selection = Selection::new(&self.layout(), free)?;
        let directions: Vec<Direction> = free.iter().map(|f| Direction::Value(f.unknown)).collect();
        let tangent = self.tangent(values, &directions, None)?;
        let mut information = tangent.slopes.tr_mul(&tangent.slopes);
        for i in 0..free.len() {
            let stretch = free[i].stretch(selection.value(values, i));
            information.row_mut(i).scale_mut(stretch);
            information.column_mut(i).scale_mut(stretch);
        }
        Ok(information)
    }

    /// The part of levels.
    pub(crate) fn information_of_levels(
        &self,
        values: &[f64],
        free: &[Free],
    ) -> Result<DMatrix<f64>, EstimateError> {
        let selection = Selection::new(&self.layout(), free)?;
        let mut information = DMatrix::zeros(free.len(), free.len());
        let levels: Vec<usize> = (0..free.len()).filter(|&i| is_level(&free[i])).collect();
        let run = self.longest();
        let base = self.samples(run, values)?;
        let mut slopes = DMatrix::zeros(2 * base.len(), levels.len());
        for (column, &level) in levels.iter().enumerate() {
            let change = free[level].small_change(selection.value(values, level));
            let changed = self.samples(run, &selection.changed(values, level, change))?;
            for (row, (changed, base)) in changed.iter().zip(&base).enumerate() {
                let by_residual = (changed.white_residual - base.white_residual) / change;
                let by_variance = (changed.white_variance / base.white_variance).ln() / change;
                slopes[(2 * row, column)] = by_residual / base.white_variance.sqrt();
                slopes[(2 * row + 1, column)] = by_variance / std::f64::consts::SQRT_2;
            }
        }
        let rows = |run: usize| self.recordings()[run].times().len();
        let all: usize = (0..self.recordings().len()).map(rows).sum();
        let scale = all as f64 / rows(run) as f64;
        let block = slopes.tr_mul(&slopes) * scale;
        for (row, &i) in levels.iter().enumerate() {
            for (column, &j) in levels.iter().enumerate() {
                information[(i, j)] = block[(row, column)];
            }
        }
        Ok(information)
    }

    fn longest(&self) -> usize {
        let rows = |run: &usize| self.recordings()[*run].times().len();
        let runs = 0..self.recordings().len();
        runs.max_by_key(rows).unwrap_or(0)
    }

    fn samples(&self, run: usize, values: &[f64]) -> Result<Vec<Innovation>, EstimateError> {
        let pass = self.pass(run, values, false)?;
        Ok(pass
            .samples
            .iter()
            .map(|sample| sample.innovation)
            .collect())
    }
}

/// Whether a value affects the variances of innovations and not their mean.
pub(crate) fn is_level(free: &Free) -> bool {
    matches!(
        free.unknown,
        Unknown::Disturbance(_) | Unknown::Noise(_) | Unknown::Spread { .. }
    )
}
