//! Fast Fisher information of some values, for the curvature of a search.
//!
//! Values that affect the mean are differentiated in one pass ([`tangent`](super::tangent)). Levels
//! of disturbances and of noise change the gains and the variances of innovations; they are
//! differentiated in another one ([`levels`](super::levels)) along the longest recording, and their information
//! is scaled with the number of rows. The expected cross-information of the two is zero.

use nalgebra::DMatrix;

use super::levels;
use crate::EstimateError;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::fitting::free::{Free, Selection};

impl Estimation<'_> {
    /// Fisher information of the coordinates of some values, without priors.
    pub fn information(
        &self,
        values: &[f64],
        free: &[Free],
    ) -> Result<DMatrix<f64>, EstimateError> {
        let of_levels = self.information_of_levels(values, free, f64::INFINITY)?;
        Ok(self.information_of_means(values, free)? + of_levels)
    }

    /// The part of values that affect the mean.
    pub(crate) fn information_of_means(
        &self,
        values: &[f64],
        free: &[Free],
    ) -> Result<DMatrix<f64>, EstimateError> {
        let selection = Selection::new(&self.layout(), free)?;
        let tangent = self.tangent(values, &selection.directions(), None)?;
        let information = &tangent.slopes * tangent.slopes.transpose();
        Ok(selection.stretched(information, values))
    }

    /// The part of levels, with residuals of at most `largest` standard deviations: larger ones of a wrong model say
    /// nothing of the expected information.
    pub(crate) fn information_of_levels(
        &self,
        values: &[f64],
        free: &[Free],
        largest: f64,
    ) -> Result<DMatrix<f64>, EstimateError> {
        let selection = Selection::new(&self.layout(), free)?;
        let mut information = DMatrix::zeros(free.len(), free.len());
        let levels: Vec<usize> = (0..free.len())
            .filter(|&i| free[i].unknown.is_level())
            .collect();
        if levels.is_empty() {
            return Ok(information);
        }
        let run = self.longest();
        let unknowns: Vec<Unknown> = levels.iter().map(|&i| free[i].unknown).collect();
        let block = levels::information(self, run, values, &unknowns, largest)?;
        let rows = |run: usize| self.recordings()[run].times().len();
        let all: usize = (0..self.recordings().len()).map(rows).sum();
        let scale = all as f64 / rows(run) as f64;
        let stretch = |i: usize| free[i].stretch(selection.value(values, i));
        for (row, &i) in levels.iter().enumerate() {
            for (column, &j) in levels.iter().enumerate() {
                information[(i, j)] = scale * stretch(i) * stretch(j) * block[(row, column)];
            }
        }
        Ok(information)
    }

    fn longest(&self) -> usize {
        let rows = |run: &usize| self.recordings()[*run].times().len();
        let runs = 0..self.recordings().len();
        runs.max_by_key(rows).unwrap_or(0)
    }
}
