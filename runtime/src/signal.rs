//! Tabulated functions of time and their derivatives.

use crate::model::{Interpolation, SignalTable};
use crate::real::{Enclosure, Real};

/// Why a table is not a valid function of time.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SignalError {
    /// The table has no rows.
    #[error("signal `{name}` has no rows")]
    Empty {
        /// The signal.
        name: String,
    },
    /// The numbers of times and values differ.
    #[error("signal `{name}` has {times} times and {values} values")]
    Lengths {
        /// The signal.
        name: String,
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A time that is not greater than its predecessor, or is not finite.
    #[error("signal `{name}`: time {t} s of row {row} is not later than the row before")]
    TimesNotIncreasing {
        /// The signal.
        name: String,
        /// Row, counted from 0.
        row: usize,
        /// Its time in s.
        t: f64,
    },
    /// A value that is infinite or not a number.
    #[error("signal `{name}`: value {value} of row {row} is not finite")]
    ValueNotFinite {
        /// The signal.
        name: String,
        /// Row, counted from 0.
        row: usize,
        /// Its value.
        value: f64,
    },
}

/// A cubic polynomial of the time since some reference time.
pub type Cubic = [f64; 4];

/// Bounds on a polynomial over an interval of the time since its reference.
pub fn enclosed(cubic: Cubic, since: Enclosure) -> Enclosure {
    let [a, b, c, d] = cubic.map(Enclosure::constant);
    a + since * (b + since * (c + since * d))
}

/// The derivative of a polynomial of a given order.
pub fn differentiated(polynomial: Cubic, order: u8) -> Cubic {
    (0..order).fold(polynomial, |[_, b, c, d], _| [b, 2.0 * c, 3.0 * d, 0.0])
}

/// An interpolated table.
///
/// Between two rows it is a polynomial; integration steps must end at the times of the rows, see [`Signal::knots`].
/// At such a time the right-hand limit is returned.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Second derivatives at the rows; zeros unless the signal is a spline.
    curvatures: Vec<f64>,
    interpolation: Interpolation,
}

impl Signal {
    /// Checks a table and, for a spline, computes the second derivatives.
    pub fn new(table: &SignalTable) -> Result<Self, SignalError> {
        let name = || table.name.to_string();
        let (times, values) = (table.times.as_ref(), table.values.as_ref());
        if times.is_empty() {
            return Err(SignalError::Empty { name: name() });
        }
        if times.len() != values.len() {
            let (times, values) = (times.len(), values.len());
            return Err(SignalError::Lengths {
                name: name(),
                times,
                values,
            });
        }
        for (row, &t) in times.iter().enumerate() {
            if !t.is_finite() || (row > 0 && t <= times[row - 1]) {
                return Err(SignalError::TimesNotIncreasing {
                    name: name(),
                    row,
                    t,
                });
            }
        }
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            let value = values[row];
            return Err(SignalError::ValueNotFinite {
                name: name(),
                row,
                value,
            });
        }
        let curvatures = match table.interpolation {
            Interpolation::Cubic => natural_spline_curvatures(times, values),
            Interpolation::Hold | Interpolation::Linear => vec![0.0; times.len()],
        };
        let (times, values) = (times.to_vec(), values.to_vec());
        Ok(Self {
            times,
            values,
            curvatures,
            interpolation: table.interpolation,
        })
    }

    /// The times between which the signal is smooth, in s.
    pub fn knots(&self) -> &[f64] {
        &self.times
    }

    /// The values at the knots, in SI.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The second derivatives at the knots, from the right: those of a spline, otherwise zeros.
    pub fn curvatures(&self) -> &[f64] {
        &self.curvatures
    }

    /// The time derivative of order 0, 1 or 2 at `t`, in SI; NaN for higher orders.
    pub fn derivative(&self, t: f64, order: u8) -> f64 {
        if order > 2 || t.is_nan() {
            return f64::NAN;
        }
        let last = self.times.len() - 1;
        let rows_not_later = self.times.partition_point(|&time| time <= t);
        if rows_not_later == 0 || rows_not_later > last {
            let end = if rows_not_later == 0 {
                self.values[0]
            } else {
                self.values[last]
            };
            return if order == 0 { end } else { 0.0 };
        }
        let i = rows_not_later - 1;
        if self.interpolation == Interpolation::Hold {
            return if order == 0 { self.values[i] } else { 0.0 };
        }
        let step = self.times[i + 1] - self.times[i];
        let since = t - self.times[i];
        let (c_left, c_right) = (self.curvatures[i], self.curvatures[i + 1]);
        let jerk = (c_right - c_left) / step;
        let chord = (self.values[i + 1] - self.values[i]) / step;
        let slope = chord - step * (2.0 * c_left + c_right) / 6.0;
        match order {
            0 => self.values[i] + since * (slope + since * (c_left / 2.0 + since * jerk / 6.0)),
            1 => slope + since * (c_left + since * jerk / 2.0),
            _ => c_left + since * jerk,
        }
    }

    /// The signal as a polynomial of the time since `t`, up to the next knot.
    pub fn polynomial(&self, t: f64) -> Cubic {
        let [value, slope, curvature] = [0, 1, 2].map(|order| self.derivative(t, order));
        let right = self.times.partition_point(|&time| time <= t);
        let jerk = match right.checked_sub(1) {
            Some(left) if right < self.times.len() => {
                let change = self.curvatures[right] - self.curvatures[left];
                change / (self.times[right] - self.times[left])
            }
            _ => 0.0,
        };
        [value, slope, curvature / 2.0, jerk / 6.0]
    }

    /// The value at `t` in SI.
    pub fn value(&self, t: f64) -> f64 {
        self.derivative(t, 0)
    }
}

/// Second derivatives of the natural cubic spline at its knots, by elimination in the tridiagonal
/// system (de Boor, *A Practical Guide to Splines*, chapter IV).
fn natural_spline_curvatures(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    let mut curvatures = vec![0.0; n];
    // After elimination: curvature[i] = curvatures[i] − ratio[i] · curvature[i + 1].
    let mut ratio = vec![0.0; n];
    for i in 1..n.saturating_sub(1) {
        let (left, right) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        let chord_left = (values[i] - values[i - 1]) / left;
        let chord_right = (values[i + 1] - values[i]) / right;
        let pivot = 2.0 * (left + right) - left * ratio[i - 1];
        ratio[i] = right / pivot;
        curvatures[i] = (6.0 * (chord_right - chord_left) - left * curvatures[i - 1]) / pivot;
    }
    for i in (1..n.saturating_sub(1)).rev() {
        curvatures[i] -= ratio[i] * curvatures[i + 1];
    }
    curvatures
}
