//! Measured values at increasing times, and estimates of them.

/// Why samples or settings are invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SamplesError {
    /// The numbers of values and times differ.
    #[error("there are {times} times and {values} values")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A time that does not follow its predecessor, or is not finite.
    #[error("time {t} s of row {row} is not later than the row before")]
    TimesNotIncreasing {
        /// Row, counted from 0.
        row: usize,
        /// Its time in s.
        t: f64,
    },
    /// A value that is infinite.
    #[error("value {value} of row {row} is not finite")]
    Infinite {
        /// Row, counted from 0.
        row: usize,
        /// Its value.
        value: f64,
    },
    /// Fewer values than the method needs.
    #[error("{found} values are too few: {needed} are needed")]
    TooFew {
        /// Number of values present.
        found: usize,
        /// Number needed.
        needed: usize,
    },
    /// Overflow of the arithmetic.
    #[error("the estimate is not finite near {t} s")]
    NotFinite {
        /// Time in s.
        t: f64,
    },
}

/// Values of one quantity at strictly increasing times; NaN where one is missing.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'s> {
    times: &'s [f64],
    values: &'s [f64],
}

impl<'s> Samples<'s> {
    /// Checks times and values.
    pub fn new(times: &'s [f64], values: &'s [f64]) -> Result<Self, SamplesError> {
        if times.len() != values.len() {
            let (times, values) = (times.len(), values.len());
            return Err(SamplesError::Lengths { times, values });
        }
        for (row, &t) in times.iter().enumerate() {
            if !t.is_finite() || (row > 0 && t <= times[row - 1]) {
                return Err(SamplesError::TimesNotIncreasing { row, t });
            }
        }
        if let Some(row) = values.iter().position(|value| value.is_infinite()) {
            let value = values[row];
            return Err(SamplesError::Infinite { row, value });
        }
        Ok(Self { times, values })
    }

    /// Times in s.
    pub const fn times(&self) -> &'s [f64] {
        self.times
    }

    /// Values; NaN where one is missing.
    pub const fn values(&self) -> &'s [f64] {
        self.values
    }

    /// Times and values without missing ones.
    pub fn present(&self) -> impl Iterator<Item = (f64, f64)> + 's {
        let pairs = self.times.iter().zip(self.values);
        pairs
            .filter(|(_, value)| !value.is_nan())
            .map(|(&t, &value)| (t, value))
    }

    /// Number of values present; an error if fewer than needed.
    pub(super) fn at_least(&self, needed: usize) -> Result<usize, SamplesError> {
        let found = self.present().count();
        if found < needed {
            return Err(SamplesError::TooFew { found, needed });
        }
        Ok(found)
    }
}

/// A quantity and its time derivatives at a time, by order.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The value and its derivatives.
    pub means: Vec<f64>,
    /// Their standard deviations.
    pub stds: Vec<f64>,
}
