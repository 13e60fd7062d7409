//! Prediction errors on held-out runs.

use appell_estimate::{Estimation, Predicted, Unknown};

use super::IdentifyError;
use super::drift::{self, Drift};
use super::problem::begin;
use crate::held_out::{AHEAD, HORIZONS, origins};
use appell_recordings::{DataSet, Part, Run};

/// Largest number of rows of a run from which predictions start.
const ORIGINS: usize = 200;
/// Most points of a trace.
const POINTS: usize = 2000;

/// RMS prediction error, in units of the noise of the fitted model.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// Horizon in s: 0 is one step, infinity the free run to the end.
    pub horizon: f64,
    /// Column; `None` for all together.
    pub column: Option<String>,
    /// Of the nominal model.
    pub nominal: f64,
    /// Of the fitted model.
    pub fitted: f64,
}

/// A channel with its predictions, [`AHEAD`] ahead.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// File of the run.
    pub run: String,
    /// Column.
    pub column: String,
    /// Times in s.
    pub times: Vec<f64>,
    /// Measurement in SI.
    pub measured: Vec<f64>,
    /// Prediction of the nominal model in SI.
    pub nominal: Vec<f64>,
    /// Prediction of the fitted model in SI.
    pub fitted: Vec<f64>,
}

/// The held-out runs under the nominal and the fitted model.
pub(super) struct Test<'a> {
    runs: Vec<&'a Run>,
    columns: Vec<String>,
    estimation: &'a Estimation<'a>,
    /// Values of the nominal and of the fitted model.
    values: [Vec<f64>; 2],
    /// Noise of the fitted model.
    noise: Vec<f64>,
}

impl<'a> Test<'a> {
    /// `fits` are values of the nominal and of the fitted model on other runs.
    pub(super) fn new(
        set: &'a DataSet,
        estimation: &'a Estimation<'a>,
        fits: [&[f64]; 2],
        drifts: &[Drift],
    ) -> Result<Self, IdentifyError> {
        let (layout, channels) = (
            estimation.layout(),
            set.measured(estimation.setup().model.info()),
        );
        let first_run = layout.place(Unknown::Initial { run: 0, state: 0 })?;
        let mut values = Vec::new();
        for fit in fits {
            let mut own = estimation.nominal();
            // The values before those of the runs have the same indices.
            own[..first_run].copy_from_slice(&fit[..first_run]);
            begin(estimation, &mut own)?;
            drift::begin(drifts, estimation, &mut own)?;
            values.push(own);
        }
        let noise = (0..channels.len()).map(|channel| {
            let place = layout.place(Unknown::Noise(channel))?;
            Ok(fits[1][place])
        });
        let noise = noise.collect::<Result<_, IdentifyError>>()?;
        let [fitted, nominal] = [values.pop(), values.pop()].map(Option::unwrap_or_default);
        Ok(Self {
            runs: set
                .runs
                .iter()
                .filter(|run| run.part == Part::Test)
                .collect(),
            columns: channels.iter().map(|(c, _)| c.column.clone()).collect(),
            estimation,
            values: [nominal, fitted],
            noise,
        })
    }

    /// Errors over all runs, of all channels and of each.
    pub(super) fn errors(&self) -> Result<Vec<HeldOut>, IdentifyError> {
        let mut errors = Vec::new();
        for horizon in HORIZONS {
            let [nominal, fitted] = &self.values;
            let (nominal, fitted) = (self.sums(nominal, horizon)?, self.sums(fitted, horizon)?);
            let all = (None, 0..self.columns.len());
            let each = self.columns.iter().enumerate();
            let each = each.map(|(index, column)| (Some(column.clone()), index..index + 1));
            for (column, channels) in std::iter::once(all).chain(each) {
                errors.push(HeldOut {
                    horizon,
                    column,
                    nominal: root(&nominal[channels.clone()]),
                    fitted: root(&fitted[channels]),
                });
            }
        }
        Ok(errors)
    }

    /// Sum of squares and count by channel.
    fn sums(&self, values: &[f64], horizon: f64) -> Result<Vec<(f64, f64)>, IdentifyError> {
        let mut sums = vec![(0.0, 0.0); self.columns.len()];
        let mut add = |channel: usize, residual: f64| {
            let (squares, count) = &mut sums[channel];
            *squares += (residual / self.noise[channel]).powi(2);
            *count += 1.0;
        };
        if horizon <= 0.0 {
            let runs = self.estimation.innovations(values)?;
            for (recording, innovations) in self.estimation.recordings().iter().zip(runs) {
                let first = origins(recording, ORIGINS).first().copied();
                for one in innovations {
                    if Some(one.row) >= first {
                        add(one.channel, one.residual);
                    }
                }
            }
            return Ok(sums);
        }
        for (run, recording) in self.estimation.recordings().iter().enumerate() {
            let mut origins = origins(recording, ORIGINS);
            if horizon.is_infinite() {
                origins.truncate(1);
            }
            let predictions = self
                .estimation
                .predictions(values, run, horizon, &origins)?;
            for one in predictions {
                add(one.channel, one.residual);
            }
        }
        Ok(sums)
    }

    /// Every channel of every run with its predictions.
    pub(super) fn traces(&self) -> Result<Vec<Trace>, IdentifyError> {
        let mut traces = Vec::new();
        for (index, run) in self.runs.iter().enumerate() {
            let recording = &self.estimation.recordings()[index];
            let origins = origins(recording, POINTS);
            let predictions =
                |values: &[f64]| self.estimation.predictions(values, index, AHEAD, &origins);
            let [nominal, fitted] = &self.values;
            let (nominal, fitted) = (predictions(nominal)?, predictions(fitted)?);
            for (channel, column) in self.columns.iter().enumerate() {
                let own = |predicted: &[Predicted]| -> Vec<Predicted> {
                    let own = predicted.iter().filter(|one| one.channel == channel);
                    own.copied().collect()
                };
                let (nominal, fitted) = (own(&nominal), own(&fitted));
                let value = |one: &Predicted| recording.measured(one.row)[channel];
                let guess = |one: &Predicted| value(one) - one.residual;
                traces.push(Trace {
                    run: run.name.clone(),
                    column: column.clone(),
                    times: fitted
                        .iter()
                        .map(|one| recording.times()[one.row])
                        .collect(),
                    measured: fitted.iter().map(value).collect(),
                    nominal: nominal.iter().map(guess).collect(),
                    fitted: fitted.iter().map(guess).collect(),
                });
            }
        }
        Ok(traces)
    }
}

fn root(sums: &[(f64, f64)]) -> f64 {
    let squares: f64 = sums.iter().map(|(squares, _)| squares).sum();
    let counts: f64 = sums.iter().map(|(_, count)| count).sum();
    (squares / counts).sqrt()
}
