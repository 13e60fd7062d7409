//! Likelihood of recordings under a model, with gradient and innovations.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::EstimateError;
use crate::data::layout::Layout;
use crate::data::recording::Recording;
use crate::data::setup::{Measured, Setup};
use crate::data::unknown::Unknown;
use crate::kalman::filter::{Innovation, Pass};
use crate::motion::plant::{Plant, StateSpace};
use crate::motion::timeline::{Action, timeline};
use crate::motion::transition::stages_len;
use crate::parallel::in_parallel;

/// Up to this number of rows the start of a thread costs more than it saves.
const FEW_ROWS: usize = 200;

/// Largest memory of the tapes of all recordings in bytes, 16 GiB; more indicates a wrong unit of the times.
const MOST_BYTES: f64 = (1_u64 << 34) as f64;

/// A setup with recordings: functions of the values that [`Layout`] lists.
pub struct Estimation<'a> {
    setup: &'a Setup<'a>,
    plant: Plant<'a>,
    /// Of runs with parameters of their own.
    plants: BTreeMap<usize, Plant<'a>>,
    recordings: &'a [Recording],
    layout: Layout,
    knots: Vec<f64>,
    /// Tapes of passes that are over: a search needs one after the other, and fresh memory is slow.
    tapes: Mutex<Vec<Vec<f64>>>,
}

impl<'a> Estimation<'a> {
    /// Checks that setup and recordings are consistent.
    pub fn new(setup: &'a Setup<'a>, recordings: &'a [Recording]) -> Result<Self, EstimateError> {
        setup.check(recordings)?;
        fits_in_memory(setup, recordings)?;
        let plant = Plant::new(setup, &[])?;
        let mut plants = BTreeMap::new();
        let layout = Layout::of(setup, recordings.len());
        for (run, recording) in recordings.iter().enumerate() {
            let differences = recording.differences();
            for &(parameter, _) in differences {
                layout.place(Unknown::Parameter(parameter))?;
            }
            if !differences.is_empty() {
                plants.insert(run, Plant::new(setup, differences)?);
            }
        }
        Ok(Self {
            setup,
            knots: plant.knots(),
            plant,
            plants,
            recordings,
            layout,
            tapes: Mutex::default(),
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

    /// The equations of all states in a run.
    pub(super) fn plant(&self, run: usize) -> &Plant<'a> {
        self.plants.get(&run).unwrap_or(&self.plant)
    }

    /// The state-space model of a run.
    pub(super) fn system(&self, run: usize) -> StateSpace<'_> {
        StateSpace {
            setup: self.setup,
            plant: self.plant(run),
            layout: self.layout,
        }
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
            // The state of a lag starts at its input, that of a filter at its first reading.
            let inputs = self.setup.lagging.iter();
            let inputs = inputs.map(|&input| recording.inputs(0)[input]);
            let channels = self.setup.lagging_channels();
            let channels = channels.map(|channel| first_reading(recording, channel));
            let drifting = self.setup.drifting.iter();
            let drifting = drifting.map(|&parameter| values_of_spec[parameter]);
            let added = inputs.chain(channels).chain(drifting);
            for (initial, added) in initial[state.len()..].iter_mut().zip(added) {
                *initial = added;
            }
        }
        values
    }

    /// The log-likelihood of all recordings.
    pub fn log_likelihood(&self, values: &[f64]) -> Result<f64, EstimateError> {
        self.log_likelihood_within(values, &[])
    }

    /// The same, with a largest number of steps for each run.
    pub(crate) fn log_likelihood_within(
        &self,
        values: &[f64],
        most_steps: &[usize],
    ) -> Result<f64, EstimateError> {
        self.check(values)?;
        let of_run = |run| Ok(self.pass(run, values, false, most_steps)?.log_likelihood());
        Ok(self.over_runs(of_run)?.into_iter().sum())
    }

    /// The log-likelihood of all recordings and its gradient with respect to all values.
    ///
    /// The gradient is that of the discretised likelihood: to rounding if the model has formulas
    /// for its adjoint ([`Model::has_adjoint`]), else to the accuracy of differences of its
    /// Jacobians.
    ///
    /// [`Model::has_adjoint`]: appell_runtime::model::Model::has_adjoint
    pub fn gradient(&self, values: &[f64]) -> Result<(f64, Vec<f64>), EstimateError> {
        let kept = self.kept(values, &[], &[])?;
        Ok((kept.log_likelihood(), kept.slopes().gradient))
    }

    /// The innovations of all measured scalars, run by run.
    pub fn innovations(&self, values: &[f64]) -> Result<Vec<Vec<Innovation>>, EstimateError> {
        self.check(values)?;
        let of_run = |run| {
            let pass = self.pass(run, values, false, &[])?;
            Ok(pass
                .samples
                .iter()
                .map(|sample| sample.innovation)
                .collect())
        };
        self.over_runs(of_run)
    }

    /// Something of each run, in their order.
    pub(super) fn over_runs<T: Send>(
        &self,
        of: impl Fn(usize) -> Result<T, EstimateError> + Sync,
    ) -> Result<Vec<T>, EstimateError> {
        let runs = 0..self.recordings.len();
        let rows = self.recordings.iter().map(|run| run.times().len());
        if rows.sum::<usize>() < FEW_ROWS {
            return runs.map(of).collect();
        }
        in_parallel(runs, of).into_iter().collect()
    }

    /// The filter along a run; without `most_steps` in any number of steps.
    pub(super) fn pass<'b>(
        &'b self,
        run: usize,
        values: &'b [f64],
        keeps: bool,
        most_steps: &[usize],
    ) -> Result<Pass<'b>, EstimateError> {
        let actions = self.actions(run, values);
        let tape = keeps.then(|| self.blank_tape());
        let mut pass = self.fresh(run, values, &actions, tape, most_steps);
        for &action in &actions {
            pass.act(&self.recordings[run], action)?;
        }
        Ok(pass)
    }

    /// The tapes; a poisoned lock is ignored, as no code panics while holding it.
    pub(super) fn tapes(&self) -> MutexGuard<'_, Vec<Vec<f64>>> {
        self.tapes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A tape for a pass that is kept.
    pub(super) fn blank_tape(&self) -> Vec<f64> {
        let mut tape = self.tapes().pop().unwrap_or_default();
        tape.clear();
        tape
    }

    /// The filter before the first of the `actions` of a run.
    pub(super) fn fresh<'b>(
        &'b self,
        run: usize,
        values: &'b [f64],
        actions: &[Action],
        tape: Option<Vec<f64>>,
        most_steps: &[usize],
    ) -> Pass<'b> {
        let recording = &self.recordings[run];
        let mut pass = Pass::new(self.system(run), values, run, recording, actions, tape);
        pass.most_steps = most_steps.get(run).copied().unwrap_or(usize::MAX);
        pass
    }

    /// Steps, changes of inputs and samples of a run.
    pub(super) fn actions(&self, run: usize, values: &[f64]) -> Vec<Action> {
        let recording = &self.recordings[run];
        timeline(self.setup, &self.layout, recording, &self.knots, values)
    }

    /// Rejects values for which the filter is undefined.
    pub(super) fn check(&self, values: &[f64]) -> Result<(), EstimateError> {
        self.check_ranges(values)?;
        for run in 0..self.layout.runs {
            if let Some(channel) = self.determined_channel(run, values) {
                return Err(EstimateError::Value {
                    what: format!("noise of channel {channel}"),
                    value: 0.0,
                    demand: "positive where no spread or disturbance makes its samples uncertain",
                });
            }
        }
        Ok(())
    }

    /// Rejects values outside their ranges.
    pub(super) fn check_ranges(&self, values: &[f64]) -> Result<(), EstimateError> {
        let layout = &self.layout;
        if values.len() != layout.len() {
            return Err(EstimateError::ValueCount {
                expected: layout.len(),
                found: values.len(),
            });
        }
        let demand =
            |range: Range<usize>, what: &str, demand, holds: &dyn Fn(usize, f64) -> bool| {
                let values = &values[range];
                let fails = |&index: &usize| {
                    let value = values[index];
                    !(value.is_finite() && holds(index, value))
                };
                match (0..values.len()).find(fails) {
                    Some(index) => Err(EstimateError::Value {
                        what: format!("{what} {index}"),
                        value: values[index],
                        demand,
                    }),
                    None => Ok(()),
                }
            };
        let any = |_: usize, _: f64| true;
        let not_negative = |_: usize, value: f64| value >= 0.0;
        let not_zero = |_: usize, value: f64| value != 0.0;
        let positive = |_: usize, value: f64| value > 0.0;
        let admitted = |channel: usize, delay: f64| {
            let longest = self.setup.channels[channel].longest_delay;
            (0.0..=longest.unwrap_or(0.0)).contains(&delay)
        };
        let levels = layout.disturbance(0)..layout.noise(0);
        demand(0..levels.start, "parameter", "finite", &any)?;
        demand(levels, "level of disturbance", "0 or more", &not_negative)?;
        let noise = layout.noise(0)..layout.bias(0);
        demand(noise, "noise of channel", "0 or more", &not_negative)?;
        let bias = layout.bias(0)..layout.scale(0);
        demand(bias, "bias of channel", "finite", &any)?;
        let scale = layout.scale(0)..layout.sensor_delay(0);
        demand(scale, "scale of channel", "other than 0", &not_zero)?;
        let delays = layout.sensor_delay(0)..layout.lag(0);
        let range = "between 0 and the longest delay of its channel";
        demand(delays, "delay of channel", range, &admitted)?;
        let lags = layout.lag(0)..layout.input_delay(0);
        demand(lags, "lag", "positive", &positive)?;
        let delays = layout.input_delay(0)..layout.initial(0);
        demand(delays, "delay of input", "0 or more", &not_negative)?;
        for run in 0..layout.runs {
            let initial = layout.initial(run)..layout.spread(run);
            demand(initial, "initial state", "finite", &any)?;
            let spread = layout.spread(run)..layout.initial(run + 1);
            demand(
                spread,
                "spread of initial state",
                "0 or more",
                &not_negative,
            )?;
        }
        Ok(())
    }

    /// A channel without noise of which a sample is certain beforehand, so that its innovation has no
    /// variance.
    ///
    /// Without disturbances the rank of P is at most the number of states with a spread, and each
    /// sample without noise lowers it by one. At the first row no disturbance has acted yet.
    fn determined_channel(&self, run: usize, values: &[f64]) -> Option<usize> {
        let (layout, setup, recording) = (&self.layout, self.setup, &self.recordings[run]);
        let channels = 0..setup.channels.len();
        let exact: Vec<usize> = channels
            .filter(|&channel| values[layout.noise(channel)] == 0.0)
            .collect();
        if exact.is_empty() {
            return None;
        }
        let spreads = &values[layout.spread(run)..][..layout.states];
        let rank = spreads.iter().filter(|&&spread| spread > 0.0).count();
        let levels = &values[layout.disturbance(0)..layout.noise(0)];
        let is_disturbed = levels.iter().any(|&level| level > 0.0);
        let times = recording.times();
        let is_sampled = |row: usize, channel: usize| {
            let is_used = match setup.channels[channel].longest_delay {
                // A delayed sample may be taken after the first row, even if it belongs to it.
                Some(longest) => !is_disturbed && times[row] >= times[0] + longest,
                None => true,
            };
            is_used && !recording.measured(row)[channel].is_nan()
        };
        // A state without spread is known at the first row, unless it follows from others.
        let is_known = |channel: usize| match setup.reads(channel) {
            Measured::State(state) => spreads[state] == 0.0,
            Measured::Output(_) => false,
        };
        if setup.model.dependent_coordinates().is_empty() {
            let is_undelayed = |channel: usize| setup.channels[channel].longest_delay.is_none();
            let mut first = exact.iter().copied();
            let known = first.find(|&c| is_undelayed(c) && is_sampled(0, c) && is_known(c));
            if known.is_some() {
                return known;
            }
        }
        let rows = if is_disturbed { 1 } else { times.len() };
        (0..rows)
            .flat_map(|row| exact.iter().map(move |&channel| (row, channel)))
            .filter(|&(row, channel)| is_sampled(row, channel))
            .nth(rank)
            .map(|(_, channel)| channel)
    }
}

/// The first measured value of a channel, 0 if it has none.
fn first_reading(recording: &Recording, channel: usize) -> f64 {
    let rows = 0..recording.times().len();
    let mut readings = rows.map(|row| recording.measured(row)[channel]);
    readings.find(|reading| !reading.is_nan()).unwrap_or(0.0)
}

/// Checks the length of the tapes.
fn fits_in_memory(setup: &Setup<'_>, recordings: &[Recording]) -> Result<(), EstimateError> {
    let steps = |recording: &Recording| {
        let times = recording.times();
        let length = times[times.len() - 1] - times[0];
        (length / setup.longest_step).max(times.len() as f64)
    };
    let steps: f64 = recordings.iter().map(steps).sum();
    let bytes = steps * (size_of::<f64>() * stages_len(setup.state_len())) as f64;
    if bytes > MOST_BYTES {
        return Err(EstimateError::TooManySteps { steps, bytes });
    }
    Ok(())
}
