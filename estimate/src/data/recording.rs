//! Recordings.

use std::ops::Range;

use crate::EstimateError;

/// One uninterrupted recording, in SI.
///
/// Measurements are taken at the times of their rows. An input is held from the time of its row to
/// that of the next. Times may be irregular.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    times: Vec<f64>,
    inputs: Vec<f64>,
    measurements: Vec<f64>,
    columns: [usize; 2],
}

impl Recording {
    /// Checks a recording. `times` in s; `inputs` and `measurements` row by row, a column for each
    /// declared input of the model and for each channel; a missing measurement is NaN.
    pub fn new(
        times: Vec<f64>,
        inputs: Vec<f64>,
        measurements: Vec<f64>,
    ) -> Result<Self, EstimateError> {
        let rows = times.len();
        if rows < 2 {
            return Err(EstimateError::TooShort { rows });
        }
        let later = |row: usize| row == 0 || times[row] > times[row - 1];
        if let Some(row) = (0..rows).find(|&row| !times[row].is_finite() || !later(row)) {
            return Err(EstimateError::TimesNotIncreasing { row, t: times[row] });
        }
        let columns = |what, table: &[f64]| {
            let columns = table.len() / rows;
            let error = EstimateError::Lengths {
                what,
                rows,
                columns: columns + 1,
                found: table.len(),
            };
            table
                .len()
                .is_multiple_of(rows)
                .then_some(columns)
                .ok_or(error)
        };
        let columns = [
            columns("inputs", &inputs)?,
            columns("measurements", &measurements)?,
        ];
        if let Some(place) = inputs.iter().position(|value| !value.is_finite()) {
            return Err(EstimateError::InputNotFinite {
                row: place / columns[0],
                input: place % columns[0],
                value: inputs[place],
            });
        }
        if let Some(place) = measurements.iter().position(|value| value.is_infinite()) {
            return Err(EstimateError::MeasurementInfinite {
                row: place / columns[1],
                channel: place % columns[1],
            });
        }
        Ok(Self {
            times,
            inputs,
            measurements,
            columns,
        })
    }

    /// Times in s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Number of inputs.
    pub fn input_len(&self) -> usize {
        self.columns[0]
    }

    /// Number of channels.
    pub fn channel_len(&self) -> usize {
        self.columns[1]
    }

    /// The inputs held from the time of a row.
    pub fn inputs(&self, row: usize) -> &[f64] {
        &self.inputs[row * self.columns[0]..(row + 1) * self.columns[0]]
    }

    /// The measurements at the time of a row; NaN where missing.
    pub fn measured(&self, row: usize) -> &[f64] {
        &self.measurements[row * self.columns[1]..(row + 1) * self.columns[1]]
    }

    /// Some of its rows.
    #[must_use]
    pub fn part(&self, rows: Range<usize>) -> Self {
        let [inputs, channels] = self.columns;
        Self {
            times: self.times[rows.clone()].to_vec(),
            inputs: self.inputs[rows.start * inputs..rows.end * inputs].to_vec(),
            measurements: self.measurements[rows.start * channels..rows.end * channels].to_vec(),
            columns: self.columns,
        }
    }

    /// The same recording with other measurements.
    pub fn with_measurements(&self, measurements: Vec<f64>) -> Result<Self, EstimateError> {
        Self::new(self.times.clone(), self.inputs.clone(), measurements)
    }
}
