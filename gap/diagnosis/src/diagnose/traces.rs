//! Plots of held-out runs: channels with their predictions, and errors over the
//! horizon.

use appell_estimate::Estimation;

use super::DiagnoseError;
use super::alternative::columns;
use super::bench::Bench;
use super::compare::Comparison;
use super::evidence::Fitted;
use super::held_out::{HeldOut, Leader};
use super::prediction::{noise, stated, taken_over};
use super::report::{Ahead, Trace};
use crate::held_out::{AHEAD, HORIZONS, origins};

/// Largest number of points of a trace.
const POINTS: usize = 1000;
/// Number of rows from which the expected error is computed.
const EXPECTED_FROM: usize = 25;

impl HeldOut {
    /// Errors at all horizons.
    pub(super) fn horizons(
        &self,
        bench: &Bench<'_>,
        comparison: &Comparison,
        leader: &Leader<'_>,
    ) -> Result<Vec<Ahead>, DiagnoseError> {
        if self.recordings.is_empty() {
            return Ok(Vec::new());
        }
        let refitted = comparison.nominal();
        let noise = noise(bench, comparison.best())?;
        let nominal = stated(bench, refitted)?;
        let ahead = |horizon: f64| {
            let error = |fitted: &Fitted| -> Result<f64, DiagnoseError> {
                Ok(self.errors(bench, fitted, &noise, horizon)?.mean().sqrt())
            };
            let floor = if horizon.is_finite() {
                Some(leader.floor(horizon)?)
            } else {
                None
            };
            Ok(Ahead {
                horizon,
                nominal: error(&nominal)?,
                refitted: error(refitted)?,
                with_effect: leader.errors(horizon)?.mean().sqrt(),
                noise_floor: floor,
            })
        };
        HORIZONS.into_iter().map(ahead).collect()
    }

    /// The channels of the first run.
    pub(super) fn traces(
        &self,
        bench: &Bench<'_>,
        comparison: &Comparison,
        leader: &Leader<'_>,
    ) -> Result<Vec<Trace>, DiagnoseError> {
        let Some(recording) = self.recordings.first() else {
            return Ok(Vec::new());
        };
        let refitted = comparison.nominal();
        let nominal = self.predicted(bench, &stated(bench, refitted)?)?;
        let refitted = self.predicted(bench, refitted)?;
        let with_effect = leader.runs.predicted(leader.bench, leader.fitted)?;
        let deviations = leader.runs.deviations(leader.bench, leader.fitted)?;
        let led = columns(leader.bench);
        let rows = recording.times().len();
        let channels = bench.set.measured(bench.effects.info());
        let mut traces = Vec::new();
        for (index, (channel, _)) in channels.iter().enumerate() {
            let Some(own) = led.iter().position(|column| *column == channel.column) else {
                continue;
            };
            let told: Vec<usize> = (0..rows)
                .filter(|&row| nominal[index][row].is_finite() || with_effect[own][row].is_finite())
                .collect();
            let of = |values: &dyn Fn(usize) -> f64| -> Vec<f64> {
                let rows = told.iter();
                rows.map(|&row| channel.unit.from_si(values(row))).collect()
            };
            traces.push(Trace {
                run: self.names[0].clone(),
                column: channel.column.clone(),
                unit: channel.unit.text.clone(),
                times: told.iter().map(|&row| recording.times()[row]).collect(),
                measured: of(&|row| recording.measured(row)[index]),
                nominal: of(&|row| nominal[index][row]),
                refitted: of(&|row| refitted[index][row]),
                with_effect: of(&|row| with_effect[own][row]),
                deviation: channel.unit.from_si(deviations[own]),
            });
        }
        Ok(traces)
    }

    /// Predictions of the first run in SI, by channel and row; NaN without a prediction.
    fn predicted(
        &self,
        bench: &Bench<'_>,
        fitted: &Fitted,
    ) -> Result<Vec<Vec<f64>>, DiagnoseError> {
        let recording = &self.recordings[0];
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let rows = recording.times().len();
        let mut predicted = vec![vec![f64::NAN; rows]; bench.measured.len()];
        for one in estimation.predictions(&values, 0, AHEAD, &origins(recording, POINTS))? {
            let value = recording.measured(one.row)[one.channel] - one.residual;
            predicted[one.channel][one.row] = value;
        }
        Ok(predicted)
    }

    /// Expected standard deviations of the errors of a true hypothesis in SI, by channel.
    fn deviations(&self, bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<f64>, DiagnoseError> {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let origins = origins(&self.recordings[0], EXPECTED_FROM);
        let mut sums = vec![(0.0, 0.0); bench.measured.len()];
        for (_, channel, variance) in estimation.expected_errors(&values, 0, AHEAD, &origins)? {
            sums[channel].0 += variance;
            sums[channel].1 += 1.0;
        }
        let means = sums.into_iter();
        Ok(means
            .map(|(sum, count): (f64, f64)| (sum / count.max(1.0)).sqrt())
            .collect())
    }
}
