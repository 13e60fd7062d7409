//! Running mean and standard deviation.

use super::beta::student_95;

/// Sums of finite numbers, updated as B. P. Welford proposes (1962).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// How many.
    pub count: u64,
    /// How many were not finite.
    pub missing: u64,
    /// Their mean.
    pub mean: f64,
    /// Sum of squared deviations.
    squares: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Self {
            count: 0,
            missing: 0,
            mean: 0.0,
            squares: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
        }
    }
}

impl Moments {
    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            self.missing += 1;
            return;
        }
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    /// The standard deviation of a single number; NaN for less than two.
    pub fn deviation(&self) -> f64 {
        (self.squares / (self.count as f64 - 1.0)).sqrt()
    }

    /// The interval of 95 % for the mean of independent numbers.
    pub fn interval(&self) -> Option<[f64; 2]> {
        let n = self.count as f64;
        (self.count > 1).then(|| {
            let half = student_95(n - 1.0) * self.deviation() / n.sqrt();
            [self.mean - half, self.mean + half]
        })
    }
}
