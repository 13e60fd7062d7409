//! Likelihood of recordings under a model, with gradient and innovations.

use std::ops::Range;

use super::EstimateError;
use crate::data::layout::Layout;
use crate::data::recording::Recording;
use crate::data::setup::Setup;
use crate::data::unknown::Unknown;
use crate::gradient::adjoint::adjoint;
use crate::kalman::filter::{Innovation, Pass};
use crate::motion::plant::Plant;
use crate::motion::timeline::{Action, timeline};

/// A setup with recordings: functions of the values that [`Layout`] lists.
pub struct Estimation<'a> {
    setup: &'a Setup<'a>,
    plant: Plant<'a>,
    recordings: &'a [Recording],
    layout: Layout,
    knots: Vec<f64>,
}

impl<'a> Estimation<'a> {
    /// Checks that setup and recordings are consistent.
    pub fn new(setup: &'a Setup<'a>, recordings: &'a [Recording]) -> Result<Self, EstimateError> {
        setup.check(recordings)?;
        let plant = Plant::new(setup)?;
        Ok(Self {
            setup,
            knots: plant.knots(),
            plant,
            recordings,
            layout: Layout::of(setup, recordings.len()),
        })
    }

    /// Indices of the values.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Its setup.
    pub fn setup(&self) -> &'a Setup<'a> {
        self.setup
    }

    /// The equations of all states.
    pub(super) fn plant(&self) -> &Plant<'a> {
        &self.plant
    }

    /// Its recordings.
    pub fn recordings(&self) -> &'a [Recording] {
        self.recordings
    }

    /// Values of the spec: its parameters, its initial state without uncertainty, scales of 1,
    /// levels, noise, biases and delays of 0, lags of 0.01 s. Noise has to be set.
    pub fn nominal(&self) -> Vec<f64> {
        let (info, layout) = (self.setup.model.info(), self.layout);
        let mut values = vec![0.0; layout.len()];
        let values_of_spec = info.default_parameters();
        values[..layout.parameters].copy_from_slice(&values_of_spec);
        values[layout.scale(0)..layout.sensor_delay(0)].fill(1.0);
        values[layout.lag(0)..layout.input_delay(0)].fill(0.01);
        let state = info.initial_state();
        for (run, recording) in self.recordings.iter().enumerate() {
            let initial = &mut values[layout.initial(run)..];
            initial[..state.len()].copy_from_slice(&state);
            // The state of a lag starts at its input.
            let inputs = self.setup.lagging.iter();
            let inputs = inputs.map(|&input| recording.inputs(0)[input]);
            let drifting = self.setup.drifting.iter();
            let added = inputs.chain(drifting.map(|&parameter| values_of_spec[parameter]));
            for (initial, added) in initial[state.len()..].iter_mut().zip(added) {
                *initial = added;
            }
        }
        values
    }

    /// The log-likelihood of all recordings.
    pub fn log_likelihood(&self, values: &[f64]) -> Result<f64, EstimateError> {
        self.check(values)?;
        let runs = 0..self.recordings.len();
        runs.map(|run| Ok(self.pass(run, values, false)?.log_likelihood()))
            .sum()
    }

    /// The log-likelihood of all recordings and its gradient with respect to all values.
    ///
    /// The gradient is that of the discretised likelihood: to rounding if the model has formulas
    /// for its adjoint ([`Model::has_adjoint`]), else to the accuracy of differences of its
    /// Jacobians.
    ///
    /// [`Model::has_adjoint`]: appell_runtime::model::Model::has_adjoint
    pub fn gradient(&self, values: &[f64]) -> Result<(f64, Vec<f64>), EstimateError> {
        self.check(values)?;
        let (mut sum, mut gradient) = (0.0, vec![0.0; self.layout.len()]);
        for run in 0..self.recordings.len() {
            let mut pass = self.pass(run, values, true)?;
            sum += pass.log_likelihood();
            adjoint(&mut pass, &(0..usize::MAX), &mut gradient);
        }
        Ok((sum, gradient))
    }

    /// The gradient of the log-likelihood of some rows of a run, given all rows before them: their
    /// score. One for each range.
    pub fn scores(
        &self,
        values: &[f64],
        run: usize,
        rows: &[Range<usize>],
    ) -> Result<Vec<Vec<f64>>, EstimateError> {
        self.check(values)?;
        self.layout.place(Unknown::Initial { run, state: 0 })?;
        let mut pass = self.pass(run, values, true)?;
        let score = |rows| {
            let mut gradient = vec![0.0; self.layout.len()];
            adjoint(&mut pass, rows, &mut gradient);
            gradient
        };
        Ok(rows.iter().map(score).collect())
    }

    /// The innovations of all measured scalars, run by run.
    pub fn innovations(&self, values: &[f64]) -> Result<Vec<Vec<Innovation>>, EstimateError> {
        self.check(values)?;
        let of_run = |run| {
            let pass = self.pass(run, values, false)?;
            Ok(pass
                .samples
                .iter()
                .map(|sample| sample.innovation)
                .collect())
        };
        (0..self.recordings.len()).map(of_run).collect()
    }

    /// The filter along a run.
    pub(super) fn pass<'b>(
        &'b self,
        run: usize,
        values: &'b [f64],
        keeps: bool,
    ) -> Result<Pass<'b>, EstimateError> {
        let recording = &self.recordings[run];
        let model = (self.setup, &self.plant, self.layout);
        Pass::over(
            model,
            values,
            (run, recording),
            &self.actions(run, values),
            keeps,
        )
    }

    /// The filter before the first of the `actions` of a run.
    pub(super) fn fresh<'b>(
        &'b self,
        run: usize,
        values: &'b [f64],
        actions: &[Action],
    ) -> Pass<'b> {
        let recording = &self.recordings[run];
        let model = (self.setup, &self.plant, self.layout);
        Pass::new(model, values, (run, recording), actions, false)
    }

    /// Steps, changes of inputs and samples of a run.
    pub(super) fn actions(&self, run: usize, values: &[f64]) -> Vec<Action> {
        let recording = &self.recordings[run];
        timeline(self.setup, &self.layout, recording, &self.knots, values)
    }

    /// Rejects values for which the filter is undefined.
    pub(super) fn check(&self, values: &[f64]) -> Result<(), EstimateError> {
        let layout = &self.layout;
        if values.len() != layout.len() {
            return Err(EstimateError::ValueCount {
                expected: layout.len(),
                found: values.len(),
            });
        }
        let demand = |range: Range<usize>, what: &str, demand, holds: &dyn Fn(f64) -> bool| {
            let mut places = range.clone();
            let error = |place: usize| EstimateError::Value {
                what: format!("{what} {}", place - range.start),
                value: values[place],
                demand,
            };
            match places.find(|&place| !(values[place].is_finite() && holds(values[place]))) {
                Some(place) => Err(error(place)),
                None => Ok(()),
            }
        };
        let not_negative = &|value| value >= 0.0;
        let levels = layout.disturbance(0)..layout.noise(0);
        demand(0..levels.start, "parameter", "finite", &|_| true)?;
        demand(levels, "level of disturbance", "0 or more", not_negative)?;
        let noise = layout.noise(0)..layout.bias(0);
        demand(noise, "noise of channel", "0 or more", not_negative)?;
        let bias = layout.bias(0)..layout.scale(0);
        demand(bias, "bias of channel", "finite", &|_| true)?;
        let scale = layout.scale(0)..layout.sensor_delay(0);
        demand(scale, "scale of channel", "other than 0", &|value| {
            value != 0.0
        })?;
        for (index, channel) in self.setup.channels.iter().enumerate() {
            let place = layout.sensor_delay(index);
            let longest = channel.longest_delay.unwrap_or(0.0);
            let holds = |value| (0.0..=longest).contains(&value);
            let range = "between 0 and the longest delay of its channel";
            demand(place..place + 1, "delay of a channel", range, &holds)?;
        }
        let lags = layout.lag(0)..layout.input_delay(0);
        demand(lags, "lag", "positive", &|value| value > 0.0)?;
        let delays = layout.input_delay(0)..layout.initial(0);
        demand(delays, "delay of input", "0 or more", not_negative)?;
        for run in 0..layout.runs {
            let initial = layout.initial(run)..layout.spread(run);
            demand(initial, "initial state", "finite", &|_| true)?;
            let spread = layout.spread(run)..layout.initial(run + 1);
            demand(spread, "spread of initial state", "0 or more", not_negative)?;
        }
        Ok(())
    }
}
