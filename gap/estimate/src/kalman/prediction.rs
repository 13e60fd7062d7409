//! Predictions over longer horizons, from the filtered state at a row, without later measurements.

use super::filter::Pass;
use crate::EstimateError;
use crate::data::recording::Recording;
use crate::data::setup::Measured;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::motion::plant::{Place, StateSpace};
use crate::motion::timeline::{Action, Advance};
use crate::motion::unfiltered::Unfiltered;

/// Prediction error of a measured scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Origin: the last row used.
    pub origin: usize,
    /// Row of the measured value.
    pub row: usize,
    /// Channel.
    pub channel: usize,
    /// Measured minus predicted value, in SI.
    pub residual: f64,
}

impl Estimation<'_> {
    /// Predictions of all channels of a run in the row `horizon` s ahead, or the first later one,
    /// from each of the rows `origins`, which increase. An infinite horizon stands for all later
    /// rows. Predictions that overflow have infinite errors.
    pub fn predictions(
        &self,
        values: &[f64],
        run: usize,
        horizon: f64,
        origins: &[usize],
    ) -> Result<Vec<Predicted>, EstimateError> {
        let mut predicted = Vec::new();
        let mut walk = None;
        self.at_origins(values, run, origins, |pass, row, later| {
            let walk = walk.get_or_insert_with(|| Walk::new(pass, &self.recordings()[run]));
            walk.begin(pass, row);
            walk.on(later, horizon, &mut predicted);
        })?;
        Ok(predicted)
    }

    /// Variances in SI of the errors of [`Estimation::predictions`] if the model and its levels are
    /// correct, each with its origin and its channel.
    pub fn expected_errors(
        &self,
        values: &[f64],
        run: usize,
        horizon: f64,
        origins: &[usize],
    ) -> Result<Vec<(usize, usize, f64)>, EstimateError> {
        let mut expected = Vec::new();
        self.at_origins(values, run, origins, |pass, row, later| {
            let recording = &self.recordings()[run];
            let mut ahead = self.fresh(run, values, later, None, &[]);
            ahead.z.copy_from_slice(&pass.z);
            ahead.root.copy_from_slice(&pass.root);
            ahead.held.copy_from_slice(&pass.held);
            let mut open = vec![true; self.setup().channels.len()];
            for &action in later {
                let Action::Measure { row: met, .. } = action else {
                    // Predictions that overflow have no expected variance.
                    if ahead.act(recording, action).is_err() {
                        break;
                    }
                    continue;
                };
                if !is_reported(recording, row, met, horizon) {
                    continue;
                }
                // Measurements are not used here.
                let (z, root) = (ahead.z.clone(), ahead.root.clone());
                if ahead.act(recording, action).is_ok() {
                    for innovation in ahead.samples.iter().map(|sample| sample.innovation) {
                        if std::mem::take(&mut open[innovation.channel]) {
                            expected.push((row, innovation.channel, innovation.variance));
                        }
                    }
                }
                ahead.samples.clear();
                ahead.z.copy_from_slice(&z);
                ahead.root.copy_from_slice(&root);
                if !open.contains(&true) {
                    break;
                }
            }
        })?;
        Ok(expected)
    }

    /// Passes on the filter at each of the rows `origins`, which increase, with the actions that follow.
    fn at_origins<'s>(
        &'s self,
        values: &'s [f64],
        run: usize,
        origins: &[usize],
        mut begin: impl FnMut(&Pass<'s>, usize, &[Action]),
    ) -> Result<(), EstimateError> {
        self.check(values)?;
        self.layout().place(Unknown::Initial { run, state: 0 })?;
        let actions = self.actions(run, values);
        let mut pass = self.fresh(run, values, &actions, None, &[]);
        for (index, &action) in actions.iter().enumerate() {
            pass.act(&self.recordings()[run], action)?;
            if let Action::Measure { row, channel: None } = action
                && origins.binary_search(&row).is_ok()
            {
                begin(&pass, row, &actions[index + 1..]);
            }
        }
        Ok(())
    }
}

/// Whether a row is far enough ahead of another to be reported. A delayed channel counts with its
/// row, so that the same values are compared for any delay.
fn is_reported(recording: &Recording, origin: usize, row: usize, horizon: f64) -> bool {
    let ahead = recording.times()[row] - recording.times()[origin];
    // Times of rows are rounded.
    row > origin && ahead >= horizon * (1.0 - 1e-9)
}

/// A motion without corrections.
struct Walk<'a> {
    motion: Unfiltered<'a>,
    origin: usize,
}

impl<'a> Walk<'a> {
    fn new(pass: &Pass<'a>, recording: &'a Recording) -> Self {
        let mut motion = Unfiltered::new(pass.system, pass.values, recording);
        motion.closure.clone_from(&pass.closure);
        Self { motion, origin: 0 }
    }

    /// Starts from the state of the filter.
    fn begin(&mut self, pass: &Pass<'_>, row: usize) {
        self.motion.z.copy_from_slice(&pass.z);
        self.motion.held.copy_from_slice(&pass.held);
        self.origin = row;
    }

    /// Advances until every channel was sampled at the horizon; for an infinite one all samples are
    /// reported.
    fn on(&mut self, actions: &[Action], horizon: f64, predicted: &mut Vec<Predicted>) {
        let mut open = vec![true; self.motion.system.setup.channels.len()];
        let everything = horizon.is_infinite();
        for &action in actions {
            match action {
                Action::Advance(advance) => self.advance(advance),
                Action::Switch { row, input } => self.motion.switch(row, input, false),
                Action::Measure { row, channel } => {
                    let horizon = if everything { 0.0 } else { horizon };
                    if !is_reported(self.motion.recording, self.origin, row, horizon) {
                        continue;
                    }
                    self.compare(row, channel, &mut open, predicted);
                    if everything {
                        open.fill(true);
                    } else if !open.contains(&true) {
                        return;
                    }
                }
            }
        }
    }

    /// Reports the channels that were sampled for a row and are still pending.
    fn compare(
        &mut self,
        row: usize,
        only: Option<usize>,
        open: &mut [bool],
        predicted: &mut Vec<Predicted>,
    ) {
        let motion = &mut self.motion;
        let StateSpace {
            setup,
            plant,
            layout,
        } = motion.system;
        let measured = motion.recording.measured(row);
        let mut outputs = Vec::new();
        for channel in setup.sampled(measured, only) {
            if !std::mem::take(&mut open[channel]) {
                continue;
            }
            let quantity = match setup.reads(channel) {
                Measured::State(state) => motion.z[state],
                Measured::Output(output) => {
                    if outputs.is_empty() {
                        outputs = vec![0.0; plant.info().output_len()];
                        let (read, t) = motion.reading(row, only);
                        let place = Place::new(layout, motion.values, t, &motion.z, &read.held);
                        let z = plant.read_state(place, &mut motion.scratch, &read);
                        let place = Place { z: &z, ..place };
                        plant.output_values(place, &mut motion.scratch, &mut outputs);
                    }
                    outputs[output]
                }
            };
            let scale = motion.values[layout.scale(channel)];
            let bias = motion.values[layout.bias(channel)];
            let residual = measured[channel] - scale * quantity - bias;
            predicted.push(Predicted {
                origin: self.origin,
                row,
                channel,
                residual: if residual.is_nan() {
                    f64::INFINITY
                } else {
                    residual
                },
            });
        }
    }

    fn advance(&mut self, advance: Advance) {
        self.step(advance, 1);
        // A prediction without a solution of the loop constraints has infinite errors.
        if self.motion.close(advance.t + advance.h).is_err() {
            self.motion.z.fill(f64::NAN);
        }
    }

    /// A step, or parts of it if it is too long.
    fn step(&mut self, advance: Advance, of: u32) {
        let parts = self.motion.step(advance, of, None);
        if parts > 1 {
            for part in advance.parts(parts) {
                self.step(part, of * parts);
            }
        }
    }
}
