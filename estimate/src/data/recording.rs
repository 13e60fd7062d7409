//! Recordings.

use std::ops::Range;

use crate::EstimateError;

/// One uninterrupted recording, in SI.
///
/// Measurements are taken at the times of their rows. An input is held from the time of its row to
/// that of the next, or joined to it by a straight line. Times may be irregular.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    times: Vec<f64>,
    inputs: Vec<f64>,
    measurements: Vec<f64>,
    columns: [usize; 2],
    /// Whether each input is joined by lines.
    joined: Vec<bool>,
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
            joined: vec![false; columns[0]],
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

    /// The same recording with some inputs joined by straight lines from row to row.
    #[must_use]
    pub fn joined_by_lines(mut self, inputs: &[usize]) -> Self {
        for (input, joined) in self.joined.iter_mut().enumerate() {
            *joined = inputs.contains(&input);
        }
        self
    }

    /// Whether an input is joined by lines.
    pub(crate) fn is_joined(&self, input: usize) -> bool {
        self.joined[input]
    }

    /// The slope of an input from the time of a row on: zero where it is held.
    pub fn slope(&self, row: usize, input: usize) -> f64 {
        if !self.joined[input] || row + 1 >= self.times.len() {
            return 0.0;
        }
        let change = self.inputs(row + 1)[input] - self.inputs(row)[input];
        change / (self.times[row + 1] - self.times[row])
    }

    /// Means of the inputs from the time of a row to that of the next.
    pub fn mean_inputs(&self, row: usize) -> Vec<f64> {
        let next = (row + 1).min(self.times.len() - 1);
        let half = 0.5 * (self.times[next] - self.times[row]);
        let inputs = self.inputs(row).iter().enumerate();
        let mean = |(input, value): (usize, &f64)| value + half * self.slope(row, input);
        inputs.map(mean).collect()
    }

    /// The inputs at the time of a row, and from then on where they are held.
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
            joined: self.joined.clone(),
        }
    }

    /// The same recording with other measurements.
    pub fn with_measurements(&self, measurements: Vec<f64>) -> Result<Self, EstimateError> {
        let same = Self::new(self.times.clone(), self.inputs.clone(), measurements)?;
        Ok(Self {
            joined: self.joined.clone(),
            ..same
        })
    }
}
