//! Recordings.

use std::ops::Range;

use appell_runtime::Signal;
use appell_runtime::model::{Interpolation, SignalTable};

use super::held::Held;
use crate::EstimateError;

/// One uninterrupted recording, in SI.
///
/// Measurements are taken at the times of their rows. An input is held from the time of its row to
/// that of the next, or joined to it by a straight line or a natural cubic spline. Times may be irregular.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    times: Vec<f64>,
    inputs: Vec<f64>,
    measurements: Vec<f64>,
    columns: [usize; 2],
    /// How each input runs from row to row.
    interpolation: Vec<Interpolation>,
    /// Second derivatives at the rows of each input that is a spline, nothing for others.
    curvatures: Vec<Vec<f64>>,
    /// Inputs before its first row, held from row to row: delayed ones arrive later.
    earlier: Held,
    /// If rows were left out: each input from row to row as the first two coefficients of [`Recording::polynomial`].
    lines: Vec<[f64; 2]>,
    /// The inputs of outputs at their full rate, and whether outputs are means over the interval about their row.
    of_outputs: Option<(Held, bool)>,
    /// Parameters of the run, each with its difference from the value of all runs.
    differences: Vec<(usize, f64)>,
}

/// How late an input acts, in s.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Late {
    pub(crate) delay: f64,
    /// The time constant of its lag, zero without one.
    pub(crate) lag: f64,
}

/// A row of inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Row {
    /// Of the recording.
    Own(usize),
    /// Before it.
    Earlier(usize),
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
            interpolation: vec![Interpolation::Hold; columns[0]],
            curvatures: vec![Vec::new(); columns[0]],
            earlier: Held::none(columns[0]),
            lines: Vec::new(),
            of_outputs: None,
            differences: Vec::new(),
            columns,
        })
    }

    /// The same recording with inputs of rows before its first one; those that are not finite, or not in order, are
    /// ignored.
    #[must_use]
    pub fn after(mut self, times: &[f64], inputs: &[f64]) -> Self {
        let count = self.columns[0];
        for (&t, row) in times.iter().zip(inputs.chunks_exact(count.max(1))) {
            let is_next = self.earlier.times.last().is_none_or(|last| t > *last);
            if is_next && t < self.times[0] && row.iter().all(|value| value.is_finite()) {
                self.earlier.times.push(t);
                self.earlier.inputs.extend_from_slice(row);
            }
        }
        self
    }

    /// The same recording of a mechanism that differs from that of the other runs: parameters, each with its difference
    /// in SI.
    #[must_use]
    pub fn with_differences(mut self, differences: Vec<(usize, f64)>) -> Self {
        self.differences = differences;
        self
    }

    /// Parameters that differ from those of the other runs, each with its difference in SI.
    pub fn differences(&self) -> &[(usize, f64)] {
        &self.differences
    }

    /// The same recording with inputs that were held between more rows than it has: from row to row each is the line with
    /// the same mean and the same first moment. With the mean alone a fast servo would seem delayed.
    #[must_use]
    pub fn subsampled(mut self, times: Vec<f64>, inputs: Vec<f64>) -> Self {
        let count = self.columns[0];
        let all = match Held::of(times, inputs, count) {
            Some(all) if !all.times.is_empty() => all,
            _ => return self,
        };
        let ends = self.times.iter().skip(1).copied().map(Some).chain([None]);
        let rows = self.times.iter().copied().zip(ends);
        self.lines = rows
            .flat_map(|(from, to)| {
                let all = &all;
                (0..count).map(move |input| match to {
                    Some(to) => all.line(input, [from, to]),
                    None => [all.held_at(input, from), 0.0],
                })
            })
            .collect();
        self
    }

    /// The same recording with inputs that are held from each of these times to the next, to which its measured outputs
    /// react at once: outputs are means from half a row before their time to half a row after it, or are read at it.
    #[must_use]
    pub fn with_outputs(mut self, are_means: bool, times: Vec<f64>, inputs: Vec<f64>) -> Self {
        let held = Held::of(times, inputs, self.columns[0]).filter(|held| held.times.len() > 1);
        self.of_outputs = held.map(|held| (held, are_means));
        self
    }

    /// A held input to which an output at a time reacts, with its slope, where it acts with a delay; `None` if it is that
    /// of the motion.
    pub(crate) fn of_output(&self, input: usize, t: f64, delay: f64) -> Option<[f64; 2]> {
        let (held, are_means) = self.outputs_of(input)?;
        if !are_means {
            return Some([held.held_at(input, t - delay), 0.0]);
        }
        let ends = held.about(t).map(|end| end - delay);
        let [first, last] = ends.map(|end| held.held_at(input, end));
        let slope = (last - first) / (ends[1] - ends[0]);
        Some([held.mean_between(input, ends), slope])
    }

    /// The same with a lag, with its derivative by the time constant.
    pub(crate) fn of_lagged_output(&self, input: usize, t: f64, late: Late) -> Option<[f64; 2]> {
        let (held, are_means) = self.outputs_of(input)?;
        let at = |t: f64| held.lagged_at(input, t - late.delay, late.lag);
        if !are_means {
            return Some(at(t));
        }
        // u̅ = l̅ + τ dl/dt on average.
        let ends = held.about(t);
        let [first, last] = ends.map(at);
        let change = [0, 1].map(|i| (last[i] - first[i]) / (ends[1] - ends[0]));
        let mean = held.mean_between(input, ends.map(|end| end - late.delay));
        Some([
            mean - late.lag * change[0],
            -change[0] - late.lag * change[1],
        ])
    }

    /// The inputs of outputs, and whether these are means, where one is held.
    fn outputs_of(&self, input: usize) -> Option<(&Held, bool)> {
        let (held, are_means) = self.of_outputs.as_ref()?;
        let is_held = input < held.count && self.interpolation[input] == Interpolation::Hold;
        is_held.then_some((held, *are_means))
    }

    /// The duration of the output at a time, if outputs are means.
    pub(crate) fn duration_of_output(&self, t: f64) -> Option<f64> {
        let (held, are_means) = self.of_outputs.as_ref()?;
        let [from, to] = held.about(t);
        are_means.then_some(to - from)
    }

    /// Of a rate that follows a held input: the difference of its mean over the time of an output from its value at the
    /// middle, per unit of its slope.
    pub(crate) fn kinks_of_output(&self, input: usize, t: f64, late: Late) -> f64 {
        let Some((held, true)) = self.outputs_of(input) else {
            return 0.0;
        };
        let ends = held.about(t).map(|end| end - late.delay);
        let kinks = held.kinks(input, ends, t - late.delay);
        if late.lag == 0.0 {
            return kinks;
        }
        // By parts from u = l + τ dl/dt.
        let [now, _] = held.lagged_at(input, t - late.delay, late.lag);
        let mean = self.of_lagged_output(input, t, late);
        kinks + mean.map_or(0.0, |[mean, _]| late.lag * (now - mean))
    }

    /// Number of rows of inputs before the first one.
    pub(crate) fn earlier_len(&self) -> usize {
        self.earlier.times.len()
    }

    /// The time of a row.
    pub(crate) fn time_of(&self, row: Row) -> f64 {
        match row {
            Row::Own(row) => self.times[row],
            Row::Earlier(row) => self.earlier.times[row],
        }
    }

    /// An input from the time of a row to that of the next, as [`Recording::polynomial`].
    pub(crate) fn command(&self, row: Row, input: usize) -> [f64; 4] {
        match row {
            Row::Own(row) => self.polynomial(row, input),
            Row::Earlier(row) => [self.earlier.at(row, input), 0.0, 0.0, 0.0],
        }
    }

    /// An input at a time that may be before the first row; then the first known value if it is before all others.
    pub(crate) fn input_before(&self, input: usize, t: f64) -> f64 {
        if t >= self.times[0] || self.earlier_len() == 0 {
            return self.inputs(0)[input];
        }
        self.earlier.held_at(input, t)
    }

    /// By how much an input that lags is ahead of its first row there, and the derivative of that by its time constant.
    pub(crate) fn lag_before(&self, input: usize, time_constant: f64) -> [f64; 2] {
        if self.earlier_len() == 0 {
            return [0.0; 2];
        }
        let [lagged, slope] = self.earlier.lagged_at(input, self.times[0], time_constant);
        [lagged - self.inputs(0)[input], slope]
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

    /// The same recording with inputs that run on between rows: one interpolation for each, held where none is given.
    pub fn interpolated(mut self, inputs: &[Interpolation]) -> Result<Self, EstimateError> {
        for input in 0..self.columns[0] {
            let interpolation = inputs.get(input).copied().unwrap_or(Interpolation::Hold);
            self.interpolation[input] = interpolation;
            self.curvatures[input] = if interpolation == Interpolation::Cubic {
                let rows = 0..self.times.len();
                let values: Vec<f64> = rows.map(|row| self.inputs(row)[input]).collect();
                let signal = Signal::new(&SignalTable {
                    name: format!("input {input}").into(),
                    times: self.times.clone().into(),
                    values: values.into(),
                    interpolation,
                })?;
                signal.curvatures().to_vec()
            } else {
                Vec::new()
            };
        }
        Ok(self)
    }

    /// Whether an input runs on between rows.
    pub(crate) fn is_joined(&self, input: usize) -> bool {
        self.interpolation[input] != Interpolation::Hold || !self.lines.is_empty()
    }

    /// An input from the time of a row to that of the next, as the coefficients of the powers of the time since that
    /// row.
    pub fn polynomial(&self, row: usize, input: usize) -> [f64; 4] {
        if let Some([value, slope]) = self.lines.get(row * self.columns[0] + input) {
            return [*value, *slope, 0.0, 0.0];
        }
        let value = self.inputs(row)[input];
        if !self.is_joined(input) || row + 1 >= self.times.len() {
            return [value, 0.0, 0.0, 0.0];
        }
        let step = self.times[row + 1] - self.times[row];
        let chord = (self.inputs(row + 1)[input] - value) / step;
        let curvatures = &self.curvatures[input];
        let [left, right] = [row, row + 1].map(|row| curvatures.get(row).copied().unwrap_or(0.0));
        let slope = chord - step * (2.0 * left + right) / 6.0;
        [value, slope, 0.5 * left, (right - left) / (6.0 * step)]
    }

    /// Means of the inputs from the time of a row to that of the next.
    pub fn mean_inputs(&self, row: usize) -> Vec<f64> {
        let next = (row + 1).min(self.times.len() - 1);
        let step = self.times[next] - self.times[row];
        let mean = |input: usize| {
            let [c0, c1, c2, c3] = self.polynomial(row, input);
            c0 + step * (c1 / 2.0 + step * (c2 / 3.0 + step * c3 / 4.0))
        };
        (0..self.columns[0]).map(mean).collect()
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
        let own = rows.start * inputs..rows.end * inputs;
        let curvatures = self.curvatures.iter();
        let curvatures = curvatures.map(|all| all.get(rows.clone()).unwrap_or_default().to_vec());
        Self {
            times: self.times[rows.clone()].to_vec(),
            inputs: self.inputs[own.clone()].to_vec(),
            measurements: self.measurements[rows.start * channels..rows.end * channels].to_vec(),
            curvatures: curvatures.collect(),
            earlier: Held::none(inputs),
            lines: self.lines.get(own).unwrap_or_default().to_vec(),
            ..self.clone()
        }
    }

    /// The same recording with other measurements.
    pub fn with_measurements(&self, measurements: Vec<f64>) -> Result<Self, EstimateError> {
        let checked = Self::new(self.times.clone(), self.inputs.clone(), measurements)?;
        Ok(Self {
            measurements: checked.measurements,
            columns: checked.columns,
            differences: Vec::new(),
            ..self.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at 0, 2 and 4 s of an input that steps up by one each second.
    fn stairs() -> Result<Recording, EstimateError> {
        let recording = Recording::new(vec![0.0, 2.0, 4.0], vec![0.5, 2.5, 4.0], Vec::new())?;
        let (times, inputs) = full_rate();
        Ok(recording.subsampled(times, inputs))
    }

    fn full_rate() -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..5).map(f64::from).collect();
        (times.clone(), times)
    }

    #[test]
    fn inputs_between_the_rows_that_are_left_keep_their_mean_and_first_moment()
    -> Result<(), EstimateError> {
        let recording = stairs()?;
        // 0 for a second, then 1: the integral is 1, the moment about the middle 1/2.
        let [value, slope, ..] = recording.polynomial(0, 0);
        assert!((value + 0.25).abs() < 1e-14 && (slope - 0.75).abs() < 1e-14);
        let integral = 2.0 * value + 2.0 * slope;
        let moment = slope * 2.0_f64.powi(3) / 12.0;
        assert!((integral - 1.0).abs() < 1e-14 && (moment - 0.5).abs() < 1e-14);
        assert!(recording.is_joined(0));
        Ok(())
    }

    #[test]
    fn an_input_that_lags_begins_where_those_before_have_left_it() -> Result<(), EstimateError> {
        let recording = Recording::new(vec![3.0, 4.0], vec![5.0, 5.0], vec![])?;
        assert_eq!(recording.lag_before(0, 0.4).map(f64::to_bits), [0, 0]);
        // From 1 to 2 for a second, then to 4 for another one.
        let recording = recording.after(&[0.0, 1.0, 2.0], &[1.0, 2.0, 4.0]);
        let lagged = |tau: f64| {
            let decay = (-1.0 / tau).exp();
            4.0 + decay * (2.0 + decay * (1.0 - 2.0) - 4.0) - 5.0
        };
        let [ahead, slope] = recording.lag_before(0, 0.4);
        assert!((ahead - lagged(0.4)).abs() < 1e-15);
        let difference = (lagged(0.4 + 1e-6) - lagged(0.4 - 1e-6)) / 2e-6;
        assert!((slope - difference).abs() < 1e-9);
        Ok(())
    }

    #[test]
    fn outputs_are_means_of_an_input_that_lags_too() -> Result<(), EstimateError> {
        let (times, inputs) = full_rate();
        let means = stairs()?.with_outputs(true, times.clone(), inputs.clone());
        let readings = stairs()?.with_outputs(false, times, inputs);
        let late = |lag| Late { delay: 0.25, lag };
        // By quadrature: the stairs, filtered, from 1.5 to 2.5 s.
        let lag = 0.3;
        let lagged = |t: f64| {
            let steps = (1..5)
                .map(|step| f64::from(step) + 0.25)
                .filter(|step| *step < t);
            steps
                .map(|step| 1.0 - ((step - t) / lag).exp())
                .sum::<f64>()
        };
        let parts = 100_000;
        let middles = (0..parts).map(|part| 1.5 + (f64::from(part) + 0.5) / f64::from(parts));
        let mean = middles.clone().map(lagged).sum::<f64>() / f64::from(parts);
        let moment = middles.map(|t| {
            let arm = if t < 2.0 { 1.5 - t } else { 2.5 - t };
            arm * (lagged(t) - lagged(2.0)) / f64::from(parts)
        });
        let of = |lag| {
            means
                .of_lagged_output(0, 2.0, late(lag))
                .unwrap_or_default()
        };
        assert!((of(lag)[0] - mean).abs() < 1e-8);
        let slope = (of(lag + 1e-5)[0] - of(lag - 1e-5)[0]) / 2e-5;
        assert!((of(lag)[1] - slope).abs() < 1e-8);
        let kinks = means.kinks_of_output(0, 2.0, late(lag));
        assert!((kinks - moment.sum::<f64>()).abs() < 1e-6);
        let now = readings
            .of_lagged_output(0, 2.0, late(lag))
            .unwrap_or_default();
        assert!((now[0] - lagged(2.0)).abs() < 1e-14);
        // A short lag is none.
        let [short, none] = [1e-9, 0.0].map(|lag| means.kinks_of_output(0, 2.0, late(lag)));
        assert!((short - none).abs() < 1e-8);
        Ok(())
    }

    #[test]
    fn outputs_are_means_about_their_row_or_readings_with_its_command() -> Result<(), EstimateError>
    {
        let (times, inputs) = full_rate();
        let means = stairs()?.with_outputs(true, times.clone(), inputs.clone());
        assert_eq!(means.of_output(0, 2.0, 0.0), Some([1.5, 1.0]));
        assert_eq!(means.of_output(0, 2.0, 1.0), Some([0.5, 1.0]));
        // A rate that follows the input has a kink at the row, and its mean over ±1/2 is 1/8 above it.
        let late = |delay, lag| Late { delay, lag };
        let kinks = [0.0, 0.25].map(|delay| means.kinks_of_output(0, 2.0, late(delay, 0.0)));
        assert_eq!(
            kinks.map(f64::to_bits),
            [0.125_f64, 0.03125].map(f64::to_bits)
        );
        let readings = stairs()?.with_outputs(false, times, inputs);
        assert_eq!(readings.of_output(0, 2.0, 0.0), Some([2.0, 0.0]));
        assert_eq!(stairs()?.of_output(0, 2.0, 0.0), None);
        Ok(())
    }
}
