//! Smoothing splines with generalised cross-validation (P. Craven and G. Wahba, 1979).
//!
//! A spline of order m keeps the m-th derivative small: it minimises the mean square of the
//! residuals plus λ times the integral of that derivative squared. That is the mean of a
//! [`Kinematic`] motion, and its covariance the Bayesian one (G. Wahba, 1983): intervals from it
//! have their nominal coverage on average over the record. The smoothing is chosen without
//! knowledge of the noise, by leave-one-out prediction; the noise level follows.

use super::kinematic::{Kinematic, best_smoothing_time};
use super::samples::{Estimate, Samples, SamplesError};

/// A spline through noisy samples.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothingSpline {
    /// Value and derivatives below order m, at the times of the samples.
    pub estimate: Estimate,
    /// Standard deviation of the samples.
    pub std: f64,
    /// Effective number of parameters: the trace of the smoothing matrix.
    pub degrees_of_freedom: f64,
}

impl SmoothingSpline {
    /// The spline of order m, of degree 2m − 1, that cross-validation chooses.
    pub fn cross_validated(order: usize, samples: Samples<'_>) -> Result<Self, SamplesError> {
        samples.at_least(order + 2)?;
        let tau =
            best_smoothing_time(samples, |tau| Ok(Fitted::new(order, tau, samples)?.score()))?;
        let fitted = Fitted::new(order, tau, samples)?;
        let std = fitted.noise_level();
        // Residuals are zero only for samples without noise.
        let model = Kinematic::with_smoothing_time(order, 1.0, tau, samples)?;
        let model = model.scaled(std.max(f64::MIN_POSITIVE.sqrt()))?;
        Ok(Self {
            estimate: model.smooth(samples)?.estimate,
            std,
            degrees_of_freedom: fitted.trace,
        })
    }
}

/// Criterion of cross-validation.
struct Fitted {
    count: f64,
    /// Sum of the squared residuals.
    squares: f64,
    trace: f64,
}

impl Fitted {
    fn new(order: usize, tau: f64, samples: Samples<'_>) -> Result<Self, SamplesError> {
        // With a noise level of one the variance of a value is its weight in its own estimate.
        let model = Kinematic::with_smoothing_time(order, 1.0, tau, samples)?;
        let estimate = model.smooth(samples)?.estimate;
        let mut fitted = Self {
            count: 0.0,
            squares: 0.0,
            trace: 0.0,
        };
        for (row, value) in samples.values().iter().enumerate() {
            if !value.is_nan() {
                fitted.count += 1.0;
                fitted.squares += (value - estimate.at(row)[0]).powi(2);
                fitted.trace += estimate.covariance(row)[0];
            }
        }
        Ok(fitted)
    }

    fn score(&self) -> f64 {
        self.count * self.squares / (self.count - self.trace).powi(2)
    }

    fn noise_level(&self) -> f64 {
        (self.squares / (self.count - self.trace)).sqrt()
    }
}
