//! Tests whether whitened innovations are white noise of variance 1 (Y. Bar-Shalom, X. R. Li and T.
//! Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 5.4).

use super::chi_squared::chi_squared_quantile;
use crate::kalman::filter::Innovation;

/// Test statistics of innovations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Consistency {
    /// Number of scalars.
    pub count: usize,
    /// Sum of the normalised innovations squared; χ² of as many degrees of freedom.
    pub squares: f64,
    /// Acceptance interval of `squares`.
    pub band: [f64; 2],
    /// Lag-1 autocorrelation of the whitened innovations.
    pub correlation: f64,
    /// Acceptance interval of `correlation`, which is normal with variance 1/count.
    pub correlation_band: [f64; 2],
}

impl Consistency {
    /// Of innovations in the order of time, such as those of a channel, with acceptance intervals
    /// of a probability, such as 0.99.
    pub fn of<'i>(innovations: impl IntoIterator<Item = &'i Innovation>, level: f64) -> Self {
        let whitened: Vec<f64> = innovations.into_iter().map(Innovation::whitened).collect();
        let (count, tail) = (whitened.len(), 0.5 * (1.0 - level));
        let squares: f64 = whitened.iter().map(|e| e * e).sum();
        let products: f64 = whitened.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let freedom = count as f64;
        // The square of a normal number is χ² of one degree.
        let reach = (chi_squared_quantile(level, 1.0) / freedom).sqrt();
        Self {
            count,
            squares,
            band: [tail, 1.0 - tail].map(|p| chi_squared_quantile(p, freedom)),
            correlation: products / squares,
            correlation_band: [-reach, reach],
        }
    }

    /// Whether the correlation is inside its interval.
    pub fn is_white(&self) -> bool {
        (self.correlation_band[0]..=self.correlation_band[1]).contains(&self.correlation)
    }
}
