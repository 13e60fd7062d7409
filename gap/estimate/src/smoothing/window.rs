//! Choice of the window width: a trade-off between variance and bias.
//!
//! The rule of A. Goldenshluger and O. Lepski (2011), averaged over the record. A wide window is
//! compared with every narrower one. Noise alone makes their estimates differ by the difference of
//! their variances, because least squares over the wide window is the more efficient of two unbiased
//! estimates (J. Hausman, 1978); the excess of the squared difference is due to bias. The window with
//! the smallest sum of bias and variance is taken.

use super::samples::{Samples, SamplesError};
use super::savitzky_golay::SavitzkyGolay;

/// Ratio of one window to the next narrower one, in tenths.
const GROWTH: usize = 13;
/// Significance, in standard deviations, of the excess of a mean square.
const CHANCE: f64 = 2.0;

/// The window for the derivative of an order, for white noise of the standard deviation `std`.
pub fn chosen(
    samples: Samples<'_>,
    degree: usize,
    order: usize,
    std: f64,
) -> Result<SavitzkyGolay, SamplesError> {
    let narrowest = (degree + 2) | 1;
    let present = samples.at_least(2 * narrowest)?;
    let mut tried: Vec<Tried> = Vec::new();
    let mut count = narrowest;
    while count <= present / 2 {
        let filter = SavitzkyGolay::new(degree, count);
        tried.push(Tried::new(filter, samples, order, std)?);
        count = (count * GROWTH / 10).max(count + 2) | 1;
    }
    let rows = inside(samples.times().len());
    let risk = |wide: usize| {
        let bias = tried[..wide]
            .iter()
            .map(|narrow| tried[wide].bias(narrow, rows.clone(), present))
            .fold(0.0, f64::max);
        bias + tried[wide].variance(rows.clone())
    };
    let best = (0..tried.len()).min_by(|&a, &b| risk(a).total_cmp(&risk(b)));
    let narrowest = SavitzkyGolay::new(degree, narrowest);
    Ok(best.map_or(narrowest, |best| tried[best].filter))
}

/// The middle half of a record, where every window is complete.
fn inside(rows: usize) -> std::ops::Range<usize> {
    rows / 4..(rows - rows / 4)
}

struct Tried {
    filter: SavitzkyGolay,
    derivative: Vec<f64>,
    /// Its variance, at each time.
    variance: Vec<f64>,
}

impl Tried {
    fn new(
        filter: SavitzkyGolay,
        samples: Samples<'_>,
        order: usize,
        std: f64,
    ) -> Result<Self, SamplesError> {
        let estimates = filter.estimate(samples, order, std)?;
        let derivative = estimates.iter().map(|own| own.means[order]);
        let variance = estimates.iter().map(|own| own.stds[order].powi(2));
        Ok(Self {
            filter,
            derivative: derivative.collect(),
            variance: variance.collect(),
        })
    }

    fn variance(&self, rows: std::ops::Range<usize>) -> f64 {
        mean(self.variance[rows].iter().copied())
    }

    /// Excess of the mean squared difference from a narrower window over noise.
    fn bias(&self, narrow: &Self, rows: std::ops::Range<usize>, present: usize) -> f64 {
        let difference = rows
            .clone()
            .map(|row| (self.derivative[row] - narrow.derivative[row]).powi(2));
        let noise = narrow.variance(rows.clone()) - self.variance(rows.clone());
        // Estimates of overlapping windows are correlated: one counts for each window.
        let chance = CHANCE * (2.0 * narrow.filter.count() as f64 / present as f64).sqrt();
        mean(difference) - noise * (1.0 + chance)
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}
