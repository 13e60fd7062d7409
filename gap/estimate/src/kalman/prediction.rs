//! Predictions over longer horizons, from the filtered state at a row, without later measurements.

use super::filter::Pass;
use crate::EstimateError;
use crate::data::recording::Recording;
use crate::data::setup::Measured;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::matrix::add_scaled;
use crate::motion::closure::Closure;
use crate::motion::command::{OfOutputs, Switch};
use crate::motion::plant::{Place, Scratch, StateSpace};
use crate::motion::timeline::{Action, Advance};
use crate::motion::transition::{MOST_PARTS, STAGES, WEIGHTS, decays, is_uneven, within};

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
        self.from_origins(values, run, origins, |pass, row, later| {
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
        self.from_origins(values, run, origins, |pass, row, later| {
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
    fn from_origins<'s>(
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
    system: StateSpace<'a>,
    values: &'a [f64],
    recording: &'a Recording,
    origin: usize,
    z: Vec<f64>,
    held: Vec<f64>,
    scratch: Scratch,
    closure: Option<Closure>,
    /// States and rates of the stages.
    stages: Vec<f64>,
    rates: Vec<f64>,
    /// ∂ż/∂z at the first stage.
    slopes: Vec<f64>,
}

impl<'a> Walk<'a> {
    fn new(pass: &Pass<'a>, recording: &'a Recording) -> Self {
        let n = pass.sizes.n;
        Self {
            system: pass.system,
            values: pass.values,
            recording,
            origin: 0,
            z: vec![0.0; n],
            held: vec![0.0; pass.sizes.commands],
            scratch: pass.system.plant.scratch(),
            closure: pass.closure.clone(),
            stages: vec![0.0; WEIGHTS.len() * n],
            rates: vec![0.0; WEIGHTS.len() * n],
            slopes: vec![0.0; n * n],
        }
    }

    /// Starts from the state of the filter.
    fn begin(&mut self, pass: &Pass<'_>, row: usize) {
        self.z.copy_from_slice(&pass.z);
        self.held.copy_from_slice(&pass.held);
        self.origin = row;
    }

    /// Advances until every channel was sampled at the horizon; for an infinite one all samples are
    /// reported.
    fn on(&mut self, actions: &[Action], horizon: f64, predicted: &mut Vec<Predicted>) {
        let mut open = vec![true; self.system.setup.channels.len()];
        let everything = horizon.is_infinite();
        for &action in actions {
            match action {
                Action::Advance(advance) => self.advance(advance),
                Action::Switch { row, input } => {
                    let StateSpace { setup, layout, .. } = self.system;
                    let switch = Switch {
                        row,
                        input,
                        first: false,
                    };
                    let (values, recording) = (self.values, self.recording);
                    switch.apply(&mut self.held, setup, layout, values, recording);
                }
                Action::Measure { row, channel } => {
                    let horizon = if everything { 0.0 } else { horizon };
                    if !is_reported(self.recording, self.origin, row, horizon) {
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
        let measured = self.recording.measured(row);
        let mut outputs = Vec::new();
        for channel in self.system.setup.sampled(measured, only) {
            if !std::mem::take(&mut open[channel]) {
                continue;
            }
            let quantity = match self.system.setup.reads(channel) {
                Measured::State(state) => self.z[state],
                Measured::Output(output) => {
                    if outputs.is_empty() {
                        outputs = vec![0.0; self.system.plant.info().output_len()];
                        let delay = |channel| self.values[self.system.layout.sensor_delay(channel)];
                        let t = self.recording.times()[row] - only.map_or(0.0, delay);
                        let StateSpace { setup, layout, .. } = self.system;
                        let (recording, held) = (self.recording, &self.held);
                        let read = OfOutputs::of(recording, row, held, setup, layout, self.values);
                        let place = Place::new(layout, self.values, t, &self.z, &read.held);
                        let (plant, scratch) = (self.system.plant, &mut self.scratch);
                        let z = plant.read_state(place, scratch, &read);
                        plant.output_values(Place { z: &z, ..place }, scratch, &mut outputs);
                    }
                    outputs[output]
                }
            };
            let scale = self.values[self.system.layout.scale(channel)];
            let bias = self.values[self.system.layout.bias(channel)];
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

    /// A step of the same method as that of the filter.
    fn advance(&mut self, advance: Advance) {
        self.step(advance, 1);
        let t = advance.t + advance.h;
        if let Some(closure) = &mut self.closure {
            let open = self.z.clone();
            let place = Place::new(self.system.layout, self.values, t, &open, &self.held);
            // A prediction without a solution of the loop constraints has infinite errors.
            if closure
                .close(self.system.plant, place, &mut self.scratch, &mut self.z)
                .is_err()
            {
                self.z.fill(f64::NAN);
            }
        }
    }

    /// A step, or parts of it if it is too long.
    fn step(&mut self, advance: Advance, of: u32) {
        let (Advance { t, h, .. }, n) = (advance, self.z.len());
        let plant = self.system.plant;
        let has_corners = self.system.setup.has_corners && self.closure.is_none();
        let is_checked = has_corners && of < MOST_PARTS;
        let own = plant.info().state_len();
        let (mut after, mut parts) = (self.z.clone(), 1);
        self.stages[..n].copy_from_slice(&self.z);
        for (stage, weight) in WEIGHTS.into_iter().enumerate() {
            let part = if stage == 0 { 0.0 } else { STAGES[stage - 1] };
            let (stages, later) = self.stages.split_at_mut((stage + 1) * n);
            let (t, z) = (t + part * h, &stages[stage * n..]);
            let place = Place::new(self.system.layout, self.values, t, z, &self.held);
            let rates = &mut self.rates[stage * n..(stage + 1) * n];
            if is_checked && stage == 0 {
                plant.jacobian(place, &mut self.scratch, rates, &mut self.slopes);
                parts = decays(&self.slopes, n, own, h);
                if parts > 1 {
                    break;
                }
            } else {
                plant.rates(place, &mut self.scratch, rates);
            }
            add_scaled(h * weight, rates, &mut after);
            if let Some(next) = STAGES.get(stage) {
                later[..n].copy_from_slice(&self.z);
                add_scaled(h * next, rates, &mut later[..n]);
            }
        }
        if is_checked && parts == 1 {
            let is_uneven = is_uneven(&self.stages, &self.rates, &self.slopes, own);
            parts += u32::from(is_uneven);
        }
        if parts == 1 {
            self.z = after;
            return;
        }
        let parts = within(parts, of);
        for part in advance.parts(parts) {
            self.step(part, of * parts);
        }
    }
}
