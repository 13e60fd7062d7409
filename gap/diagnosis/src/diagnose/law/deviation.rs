//! The band of a law.

use appell_estimate::Unknown;
use nalgebra::DMatrix;

use super::super::evidence::Fitted;

/// Standard deviations of linear functions of some values of a fit.
pub(super) struct Deviation {
    /// Indices of the values among the free ones.
    free: Vec<Option<usize>>,
    covariance: Option<DMatrix<f64>>,
}

impl Deviation {
    pub(super) fn of(fitted: &Fitted, places: &[usize]) -> Self {
        let place = |place: &usize| {
            let mut free = fitted.fit.free.iter();
            free.position(|free| free.unknown == Unknown::Parameter(*place))
        };
        Self {
            free: places.iter().map(place).collect(),
            covariance: fitted.fit.covariance().ok(),
        }
    }

    /// Standard deviation of the sum of the values times these coefficients.
    pub(super) fn along(&self, slopes: &[f64]) -> f64 {
        let mut variance = 0.0;
        for (i, a) in self.free.iter().zip(slopes) {
            for (j, b) in self.free.iter().zip(slopes) {
                if let (Some(i), Some(j), Some(covariance)) = (i, j, &self.covariance) {
                    variance += a * b * covariance[(*i, *j)];
                }
            }
        }
        variance.max(0.0).sqrt()
    }
}
