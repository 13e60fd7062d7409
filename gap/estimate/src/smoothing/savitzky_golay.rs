//! Polynomials fitted in a moving window (A. Savitzky and M. Golay, 1964).
//!
//! The published filter has fixed weights, for equal steps and the middle of a window. Here each
//! window is a separate least-squares fit, in polynomials that are orthonormal over its times (G.
//! E. Forsythe, 1957): steps may differ, values may be missing, and at the edges the last whole
//! window is evaluated off its middle. On equal steps the weights are the published ones.

use super::samples::{Estimate, Samples, SamplesError};

/// Highest degree; beyond it a wider window of lower degree is better.
pub const MOST_DEGREE: usize = 8;

/// A degree and a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SavitzkyGolay {
    degree: usize,
    count: usize,
}

impl SavitzkyGolay {
    /// Polynomials of a degree over a window of samples, whose number exceeds the degree.
    pub const fn new(degree: usize, count: usize) -> Self {
        Self { degree, count }
    }

    /// Samples of a window.
    pub const fn count(self) -> usize {
        self.count
    }

    /// Value and derivatives up to an order, which is at most the degree, at the times of the samples, also where the value
    /// is missing.
    ///
    /// Standard deviations are those for white noise of the standard deviation `std`; they do not include
    /// the bias of the polynomial, which [`super::window`] keeps below them.
    pub fn estimate(
        &self,
        samples: Samples<'_>,
        order: usize,
        std: f64,
    ) -> Result<Vec<Estimate>, SamplesError> {
        samples.at_least(self.count)?;
        let (times, values): (Vec<f64>, Vec<f64>) = samples.present().unzip();
        let mut fit = Fit::default();
        let estimates = samples.times().iter().map(|&t| {
            let window = self.around(t, &times);
            fit.find(&times[window.clone()], t, self.degree, order);
            let estimate = fit.evaluate(&values[window], std);
            let mut all = estimate.means.iter().chain(&estimate.stds);
            let is_finite = all.all(|number| number.is_finite());
            is_finite
                .then_some(estimate)
                .ok_or(SamplesError::NotFinite { t })
        });
        estimates.collect()
    }

    /// The window about a time: as many samples before as after, where available.
    fn around(&self, t: f64, times: &[f64]) -> std::ops::Range<usize> {
        let middle = times.partition_point(|&time| time < t);
        let first = middle.saturating_sub(self.count / 2);
        let first = first.min(times.len() - self.count);
        first..first + self.count
    }
}

/// Weights of the values at `times` in the derivative of an order at `t`, by a least-squares
/// polynomial; `None` if the times do not determine one.
pub fn weights(times: &[f64], t: f64, degree: usize, order: usize) -> Option<Vec<f64>> {
    if degree > MOST_DEGREE || order > degree || times.len() <= degree {
        return None;
    }
    let mut fit = Fit::default();
    fit.find(times, t, degree, order);
    let weights = fit.weights(order);
    weights.iter().all(|w| w.is_finite()).then_some(weights)
}

/// Orthonormal polynomials over the times of a window, and their derivatives at one time.
#[derive(Default)]
struct Fit {
    /// Half the width of the window in s: the unit of time in which the polynomials are written.
    scale: f64,
    /// Values at the samples, a row for each polynomial.
    basis: Vec<Vec<f64>>,
    /// Derivatives at the time by order, a row for each polynomial, in units of `scale`.
    derivatives: Vec<Vec<f64>>,
}

impl Fit {
    /// By the recurrence p₊ = (u − a) p − b p₋, with u the time from `t` in units of `scale`.
    fn find(&mut self, times: &[f64], t: f64, degree: usize, order: usize) {
        let far = times.iter().map(|time| (time - t).abs());
        self.scale = far.fold(0.0, f64::max);
        if self.scale <= 0.0 {
            self.scale = 1.0;
        }
        let u: Vec<f64> = times.iter().map(|time| (time - t) / self.scale).collect();
        let constant = 1.0 / (times.len() as f64).sqrt();
        self.basis = vec![vec![constant; times.len()]];
        self.derivatives = vec![vec![0.0; order + 1]];
        self.derivatives[0][0] = constant;
        let mut b = 0.0;
        for k in 0..degree {
            let p = &self.basis[k];
            let a: f64 = u.iter().zip(p).map(|(u, p)| u * p * p).sum();
            let before = |j: usize| if k == 0 { 0.0 } else { self.basis[k - 1][j] };
            let next: Vec<f64> = (0..u.len())
                .map(|j| (u[j] - a) * p[j] - b * before(j))
                .collect();
            // D^r (u − a) p = (u − a) D^r p + r D^(r−1) p, at u = 0.
            let d = &self.derivatives[k];
            let d_before = |r: usize| {
                if k == 0 {
                    0.0
                } else {
                    self.derivatives[k - 1][r]
                }
            };
            let lower = |r: usize| if r == 0 { 0.0 } else { r as f64 * d[r - 1] };
            let d_next: Vec<f64> = (0..=order)
                .map(|r| lower(r) - a * d[r] - b * d_before(r))
                .collect();
            b = next.iter().map(|x| x * x).sum::<f64>().sqrt();
            self.basis.push(next.iter().map(|x| x / b).collect());
            self.derivatives
                .push(d_next.iter().map(|x| x / b).collect());
        }
    }

    fn evaluate(&self, values: &[f64], std: f64) -> Estimate {
        let width = self.derivatives[0].len();
        let unit = |r: usize| self.scale.powi(-i32::try_from(r).unwrap_or(0));
        let (mut means, mut variances) = (vec![0.0; width], vec![0.0; width]);
        for (p, d) in self.basis.iter().zip(&self.derivatives) {
            let coefficient: f64 = p.iter().zip(values).map(|(p, y)| p * y).sum();
            for r in 0..width {
                means[r] += coefficient * d[r] * unit(r);
                variances[r] += std * std * d[r] * d[r] * unit(r + r);
            }
        }
        Estimate {
            means,
            stds: variances.into_iter().map(f64::sqrt).collect(),
        }
    }

    fn weights(&self, order: usize) -> Vec<f64> {
        let unit = self.scale.powi(-i32::try_from(order).unwrap_or(0));
        let mut weights = vec![0.0; self.basis[0].len()];
        for (p, d) in self.basis.iter().zip(&self.derivatives) {
            for (weight, p) in weights.iter_mut().zip(p) {
                *weight += d[order] * p * unit;
            }
        }
        weights
    }
}
