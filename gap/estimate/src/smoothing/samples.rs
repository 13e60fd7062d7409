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
    /// A setting that is not a positive number.
    #[error("the {what} must be a positive number, not {value}")]
    NotPositive {
        /// Which setting.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A degree or order of differentiation outside the range of the method.
    #[error("the {what} must lie between {least} and {most}, not {value}")]
    Outside {
        /// Which setting.
        what: &'static str,
        /// Its value.
        value: usize,
        /// Smallest one.
        least: usize,
        /// Largest one.
        most: usize,
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

/// A positive and finite setting.
pub(super) fn positive(what: &'static str, value: f64) -> Result<f64, SamplesError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(SamplesError::NotPositive { what, value })
    }
}

/// A setting between two bounds.
pub(super) fn within(
    what: &'static str,
    value: usize,
    [least, most]: [usize; 2],
) -> Result<usize, SamplesError> {
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(SamplesError::Outside {
            what,
            value,
            least,
            most,
        })
    }
}

/// A quantity and its time derivatives at the times of samples, with the covariance of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Quantities at a time: the value and its derivatives.
    width: usize,
    /// `width` numbers for each time.
    means: Vec<f64>,
    /// `width` × `width` numbers for each time.
    covariances: Vec<f64>,
}

impl Estimate {
    /// A value and `order` derivatives at a number of times, all zero.
    pub(super) fn zeros(times: usize, order: usize) -> Self {
        let width = order + 1;
        Self {
            width,
            means: vec![0.0; times * width],
            covariances: vec![0.0; times * width * width],
        }
    }

    /// Number of times.
    pub fn len(&self) -> usize {
        self.means.len() / self.width
    }

    /// Whether there is no time.
    pub fn is_empty(&self) -> bool {
        self.means.is_empty()
    }

    /// Value and derivatives at the time of a row, from order 0.
    pub fn at(&self, row: usize) -> &[f64] {
        &self.means[row * self.width..][..self.width]
    }

    /// Their covariance, row by row.
    pub fn covariance(&self, row: usize) -> &[f64] {
        let entries = self.width * self.width;
        &self.covariances[row * entries..][..entries]
    }

    /// Standard deviation of the derivative of an order.
    pub fn std(&self, row: usize, order: usize) -> f64 {
        self.covariance(row)[order * (self.width + 1)].sqrt()
    }

    /// The derivative of an order at all times.
    pub fn derivative(&self, order: usize) -> Vec<f64> {
        (0..self.len()).map(|row| self.at(row)[order]).collect()
    }

    /// Both at the time of a row, mutable.
    pub(super) fn entry(&mut self, row: usize) -> (&mut [f64], &mut [f64]) {
        let entries = self.width * self.width;
        (
            &mut self.means[row * self.width..][..self.width],
            &mut self.covariances[row * entries..][..entries],
        )
    }
}
