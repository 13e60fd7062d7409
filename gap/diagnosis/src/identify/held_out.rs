//! Prediction errors on held-out runs.

use std::ops::Range;

use appell_estimate::{Estimation, Predicted, Unknown};

use super::IdentifyError;
use super::drift::{self, Drift};
use super::problem::begun;
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
        let channels = set.measured(estimation.setup().model.info());
        let carried = |fit: &[f64]| -> Result<Vec<f64>, IdentifyError> {
            let mut values = begun(estimation, fit)?;
            drift::begin(drifts, estimation, &mut values)?;
            Ok(values)
        };
        let noise = (0..channels.len()).map(|channel| {
            let place = estimation.layout().place(Unknown::Noise(channel))?;
            Ok(fits[1][place])
        });
        Ok(Self {
            runs: (set.runs.iter())
                .filter(|run| run.part == Part::Test)
                .collect(),
            columns: channels.iter().map(|(c, _)| c.column.clone()).collect(),
            estimation,
            values: [carried(fits[0])?, carried(fits[1])?],
            noise: noise.collect::<Result<_, IdentifyError>>()?,
        })
    }

    /// Errors over all runs, of all channels and of each.
    pub(super) fn errors(&self) -> Result<Vec<HeldOut>, IdentifyError> {
        let mut errors = Vec::new();
        for horizon in HORIZONS {
            let [nominal, fitted] = &self.values;
            let (nominal, fitted) = (self.sums(nominal, horizon)?, self.sums(fitted, horizon)?);
            let mut add = |column: Option<&String>, channels: Range<usize>| {
                errors.push(HeldOut {
                    horizon,
                    column: column.cloned(),
                    nominal: root(&nominal[channels.clone()]),
                    fitted: root(&fitted[channels]),
                });
            };
            add(None, 0..self.columns.len());
            for (index, column) in self.columns.iter().enumerate() {
                add(Some(column), index..index + 1);
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
                let is_own = |one: &&Predicted| one.channel == channel;
                let nominal = nominal.iter().filter(is_own);
                let fitted = fitted.iter().filter(is_own);
                let value = |one: &Predicted| recording.measured(one.row)[channel];
                let guess = |one: &Predicted| value(one) - one.residual;
                traces.push(Trace {
                    run: run.name.clone(),
                    column: column.clone(),
                    times: (fitted.clone())
                        .map(|one| recording.times()[one.row])
                        .collect(),
                    measured: fitted.clone().map(value).collect(),
                    nominal: nominal.map(guess).collect(),
                    fitted: fitted.map(guess).collect(),
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
