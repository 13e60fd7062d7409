//! Gains that follow an operating condition, such as the speed.
//!
//! A law is designed at each of several values of a condition; gains, desired values and offsets
//! are interpolated linearly between them and constant beyond.

use nalgebra::{DMatrix, DVector};

/// A law about one steady motion: u = u₀ − K (y − y₀).
#[derive(Debug, Clone, PartialEq)]
pub struct OperatingLaw {
    /// K, a row for each input, a column for each state y.
    pub gain: DMatrix<f64>,
    /// y₀, the states on the steady motion.
    pub states: DVector<f64>,
    /// u₀, the inputs on the steady motion.
    pub inputs: DVector<f64>,
}

impl OperatingLaw {
    /// u₀ − K (y − y₀) for the states y.
    #[must_use]
    pub fn asked(&self, y: &DVector<f64>) -> DVector<f64> {
        &self.inputs - &self.gain * (y - &self.states)
    }
}

/// Laws at values of a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct GainSchedule {
    values: Vec<f64>,
    laws: Vec<OperatingLaw>,
}

/// Why a schedule is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ScheduleError {
    /// No value of the condition.
    #[error("a schedule needs at least one value of its condition")]
    Empty,
    /// The values do not increase.
    #[error("the values of a schedule must increase, but {after} follows {before}")]
    Order {
        /// A value.
        before: f64,
        /// The next one.
        after: f64,
    },
    /// Laws of different dimensions.
    #[error("the law at {0} has other inputs or states than the first")]
    Shape(f64),
}

impl GainSchedule {
    /// Laws at increasing values of the condition.
    pub fn new(laws: Vec<(f64, OperatingLaw)>) -> Result<Self, ScheduleError> {
        let (values, laws): (Vec<f64>, Vec<OperatingLaw>) = laws.into_iter().unzip();
        let first = laws.first().ok_or(ScheduleError::Empty)?;
        let shape = |law: &OperatingLaw| (law.gain.shape(), law.states.len(), law.inputs.len());
        if let Some(place) = laws.iter().position(|law| shape(law) != shape(first)) {
            return Err(ScheduleError::Shape(values[place]));
        }
        let ordered = |pair: &&[f64]| pair[0].is_nan() || pair[1].is_nan() || pair[0] >= pair[1];
        if let Some(pair) = values.windows(2).find(ordered) {
            return Err(ScheduleError::Order {
                before: pair[0],
                after: pair[1],
            });
        }
        Ok(Self { values, laws })
    }

    /// The law at a value of the condition.
    #[must_use]
    pub fn at(&self, value: f64) -> OperatingLaw {
        let after = self.values.partition_point(|node| *node <= value);
        let (Some(before), true) = (after.checked_sub(1), after < self.values.len()) else {
            return self.laws[after.min(self.laws.len() - 1)].clone();
        };
        let part = (value - self.values[before]) / (self.values[after] - self.values[before]);
        let [low, high] = [&self.laws[before], &self.laws[after]];
        OperatingLaw {
            gain: &low.gain + (&high.gain - &low.gain) * part,
            states: low.states.lerp(&high.states, part),
            inputs: low.inputs.lerp(&high.inputs, part),
        }
    }

    /// The values of the condition with their laws.
    pub fn laws(&self) -> impl Iterator<Item = (f64, &OperatingLaw)> {
        self.values.iter().copied().zip(&self.laws)
    }
}
