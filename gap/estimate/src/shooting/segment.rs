//! The segments of a run: residuals of their samples and their ends, with the derivatives of both
//! with respect to their initial states and the free values. The derivatives are those of the
//! numerical Runge–Kutta steps.

use nalgebra::{DMatrix, DVector};

use crate::EstimateError;
use crate::data::recording::Recording;
use crate::data::setup::Measured;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::matrix::{add_scaled, dot, multiply};
use crate::motion::closure::Closure;
use crate::motion::command::{self, OfOutputs, Switch};
use crate::motion::plant::{Place, Scratch};
use crate::motion::timeline::{Action, Advance};
use crate::motion::transition::{MOST_PARTS, STAGES, WEIGHTS, decays, is_uneven, within};

/// A segment. Derivatives with respect to its initial state, then to the free values.
pub(super) struct Segment {
    /// A row for each sample, in units of its noise: derivatives of the residual, the residual.
    pub(super) rows: DMatrix<f64>,
    /// State at the end.
    pub(super) end: DVector<f64>,
    /// Its derivatives.
    pub(super) by: DMatrix<f64>,
}

/// A motion with its derivatives.
pub(super) struct SegmentIntegrator<'a> {
    estimation: &'a Estimation<'a>,
    values: &'a [f64],
    run: usize,
    recording: &'a Recording,
    /// Free values, each with its derivative with respect to its coordinate.
    unknowns: &'a [(Unknown, f64)],
    n: usize,
    width: usize,
    z: Vec<f64>,
    /// n rows.
    by: Vec<f64>,
    held: Vec<f64>,
    rows: Vec<f64>,
    scratch: Scratch,
    closure: Option<Closure>,
}

impl<'a> SegmentIntegrator<'a> {
    pub(super) fn new(
        estimation: &'a Estimation<'_>,
        values: &'a [f64],
        run: usize,
        unknowns: &'a [(Unknown, f64)],
    ) -> Self {
        let plant = estimation.plant(run);
        let (n, width) = (plant.n, plant.n + unknowns.len());
        Self {
            estimation,
            values,
            run,
            recording: &estimation.recordings()[run],
            unknowns,
            n,
            width,
            z: vec![0.0; n],
            by: vec![0.0; n * width],
            held: vec![0.0; command::NUMBERS * plant.info().declared_inputs],
            rows: Vec::new(),
            scratch: plant.scratch(),
            closure: Closure::of(plant),
        }
    }

    /// All segments of the run: rows at which they begin, and states there.
    pub(super) fn along(
        mut self,
        nodes: &[usize],
        states: &[DVector<f64>],
    ) -> Result<Vec<Segment>, EstimateError> {
        let mut pieces = Vec::with_capacity(nodes.len());
        self.begin(nodes[0], &states[0])?;
        let mut is_first = true;
        for action in self.estimation.actions(self.run, self.values) {
            match action {
                Action::Advance(advance) => self.advance(advance, 1),
                Action::Switch { row, input } => {
                    let switch = Switch {
                        row,
                        input,
                        first: is_first,
                    };
                    let (setup, layout) = (self.estimation.setup(), self.estimation.layout());
                    let (values, recording) = (self.values, self.recording);
                    switch.apply(&mut self.held, setup, layout, values, recording);
                    is_first = false;
                }
                Action::Measure { row, channel } => {
                    let next = pieces.len() + 1;
                    if channel.is_none() && nodes.get(next) == Some(&row) {
                        pieces.push(self.end());
                        self.begin(row, &states[next])?;
                    }
                    self.measure(row, channel)?;
                }
            }
        }
        pieces.push(self.end());
        Ok(pieces)
    }

    /// A segment begins at a row, where loops are closed.
    fn begin(&mut self, row: usize, state: &DVector<f64>) -> Result<(), EstimateError> {
        self.z.copy_from_slice(state.as_slice());
        self.by.fill(0.0);
        let diagonal = self.by.iter_mut().step_by(self.width + 1);
        diagonal.take(self.n).for_each(|entry| *entry = 1.0);
        let Some(closure) = &mut self.closure else {
            return Ok(());
        };
        let (run, t, plant) = (
            self.run,
            self.recording.times()[row],
            self.estimation.plant(self.run),
        );
        let (layout, z) = (self.estimation.layout(), state.as_slice());
        let place = Place::new(layout, self.values, t, z, &self.held);
        closure
            .close(plant, place, &mut self.scratch, &mut self.z)
            .map_err(|source| EstimateError::Open { run, t, source })?;
        closure.follow(&mut self.by);
        for (column, &(unknown, stretch)) in (self.n..).zip(self.unknowns) {
            if let Unknown::Parameter(index) = unknown {
                for (state, slope) in closure.by_parameter(plant, place, &mut self.scratch, index) {
                    self.by[state * self.width + column] += stretch * slope;
                }
            }
        }
        Ok(())
    }

    fn end(&mut self) -> Segment {
        let columns = self.width + 1;
        let rows = std::mem::take(&mut self.rows);
        Segment {
            rows: DMatrix::from_row_slice(rows.len() / columns, columns, &rows),
            end: DVector::from_column_slice(&self.z),
            by: DMatrix::from_row_slice(self.n, self.width, &self.by),
        }
    }

    /// One step of the state and its derivatives, or parts of it if it is too long.
    fn advance(&mut self, advance: Advance, of: u32) {
        let Advance { t, h, .. } = advance;
        let (n, width) = (self.n, self.width);
        let (before, by_before) = (self.z.clone(), self.by.clone());
        let (mut stages, mut by_stage) = (before.repeat(WEIGHTS.len()), by_before.clone());
        let (mut rates, mut by_rates) = (vec![0.0; 4 * n], vec![0.0; n * width]);
        let (mut slopes, held) = (vec![0.0; 4 * n * n], self.held.clone());
        let plant = self.estimation.plant(self.run);
        let has_corners = self.estimation.setup().has_corners && self.closure.is_none();
        let is_checked = has_corners && of < MOST_PARTS;
        let own = plant.info().state_len();
        let mut parts = 1;
        for (i, weight) in WEIGHTS.into_iter().enumerate() {
            let part = if i == 0 { 0.0 } else { STAGES[i - 1] };
            let (layout, t) = (self.estimation.layout(), t + part * h);
            let place = Place::new(layout, self.values, t, &stages[i * n..][..n], &held);
            let rates = &mut rates[i * n..(i + 1) * n];
            let slopes = &mut slopes[i * n * n..][..n * n];
            plant.jacobian(place, &mut self.scratch, rates, slopes);
            if is_checked {
                parts = decays(slopes, n, own, h);
                if parts > 1 {
                    break;
                }
            }
            multiply(slopes, &by_stage, n, &mut by_rates);
            self.unknowns_in_rates(place, rates, &mut by_rates);
            add_scaled(h * weight, rates, &mut self.z);
            add_scaled(h * weight, &by_rates, &mut self.by);
            if let Some(next) = STAGES.get(i) {
                add_scaled(h * next, rates, &mut stages[(i + 1) * n..][..n]);
                by_stage.copy_from_slice(&by_before);
                add_scaled(h * next, &by_rates, &mut by_stage);
            }
        }
        if is_checked && parts == 1 {
            parts += u32::from(is_uneven(&stages, &rates, &slopes[..n * n], own));
        }
        if parts > 1 {
            (self.z, self.by) = (before, by_before);
            let parts = within(parts, of);
            for part in advance.parts(parts) {
                self.advance(part, of * parts);
            }
        }
    }

    /// Adds the direct effect of the free values on the rates.
    fn unknowns_in_rates(&mut self, place: Place<'_>, rates: &[f64], by_rates: &mut [f64]) {
        let plant = self.estimation.plant(self.run);
        let (states, count) = (plant.info().state_len(), plant.info().parameter_len());
        let is_parameter =
            |&(unknown, _): &(Unknown, f64)| matches!(unknown, Unknown::Parameter(_));
        let (mut slopes, mut filters) = (Vec::new(), Vec::new());
        if self.unknowns.iter().any(is_parameter) {
            slopes.resize(states * count, 0.0);
            plant.parameter_jacobian(place, &mut self.scratch, &mut slopes);
            filters = plant.filters_by_parameters(place, &mut self.scratch);
        }
        for (column, &(unknown, stretch)) in (self.n..).zip(self.unknowns) {
            match unknown {
                Unknown::Parameter(index) => {
                    for state in 0..states {
                        by_rates[state * self.width + column] +=
                            stretch * slopes[state * count + index];
                    }
                    for (state, slopes) in &filters {
                        by_rates[state * self.width + column] += stretch * slopes[index];
                    }
                }
                Unknown::Lag(lag) => {
                    let (tau, state) = (place.lags[lag], states + lag);
                    let gap = plant.gap(place, rates, lag);
                    by_rates[state * self.width + column] -= stretch * gap / (tau * tau);
                }
                _ => {}
            }
        }
    }

    /// Adds the samples of one delayed channel, or of all others.
    fn measure(&mut self, row: usize, only: Option<usize>) -> Result<(), EstimateError> {
        let (setup, layout) = (self.estimation.setup(), self.estimation.layout());
        let delay = only.map_or(0.0, |channel| self.values[layout.sensor_delay(channel)]);
        let (n, t) = (self.n, self.recording.times()[row] - delay);
        let count = setup.output_len();
        let (mut outputs, mut slopes) = (vec![0.0; count], vec![0.0; count * n]);
        let read = OfOutputs::of(self.recording, row, &self.held, setup, layout, self.values);
        let place = Place::new(layout, self.values, t, &self.z, &read.held);
        if count > 0 {
            let (plant, scratch) = (self.estimation.plant(self.run), &mut self.scratch);
            let z = plant.read_state(place, scratch, &read);
            let place = Place { z: &z, ..place };
            plant.outputs(place, scratch, &mut outputs, &mut slopes);
        }
        // Inputs that lag are not those of the motion.
        let first = setup.model.info().state_len();
        let mut by_lags = Vec::new();
        for slopes in slopes.chunks_exact_mut(n) {
            for (slope, [_, by]) in slopes[first..].iter_mut().zip(&read.lags) {
                by_lags.push(std::mem::take(slope) * by);
            }
        }
        let measured = self.recording.measured(row);
        for index in setup.sampled(measured, only) {
            let (scale, bias) = (layout.scale(index), layout.bias(index));
            let (scale, bias) = (self.values[scale], self.values[bias]);
            let weight = 1.0 / self.values[layout.noise(index)];
            let start = self.rows.len();
            self.rows.resize(start + self.width + 1, 0.0);
            let line = &mut self.rows[start..];
            let mut by_parameters = Vec::new();
            let quantity = match setup.reads(index) {
                Measured::State(state) => {
                    let by = &self.by[state * self.width..(state + 1) * self.width];
                    add_scaled(-weight * scale, by, line);
                    self.z[state]
                }
                Measured::Output(output) => {
                    for (slope, by) in slopes[output * n..(output + 1) * n]
                        .iter()
                        .zip(self.by.chunks_exact(self.width))
                    {
                        add_scaled(-weight * scale * slope, by, line);
                    }
                    let plant = self.estimation.plant(self.run);
                    let gradient = plant.output_gradient(place, &mut self.scratch, output, 1.0);
                    by_parameters = gradient.p;
                    outputs[output]
                }
            };
            for (column, &(unknown, stretch)) in (n..).zip(self.unknowns) {
                line[column] -= weight
                    * stretch
                    * match unknown {
                        Unknown::Bias(biased) if biased == index => 1.0,
                        Unknown::Scale(scaled) if scaled == index => quantity,
                        Unknown::Parameter(parameter) if !by_parameters.is_empty() => {
                            scale * by_parameters[parameter]
                        }
                        Unknown::Lag(lag) if lag < read.lags.len() => match setup.reads(index) {
                            Measured::Output(output) => {
                                scale * by_lags[output * read.lags.len() + lag]
                            }
                            Measured::State(_) => 0.0,
                        },
                        _ => 0.0,
                    };
            }
            line[self.width] = weight * (measured[index] - scale * quantity - bias);
            if !dot(line, line).is_finite() {
                return Err(EstimateError::Diverged { run: self.run, t });
            }
        }
        Ok(())
    }
}
