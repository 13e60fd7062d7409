//! The segments of a run: residuals of their samples and their ends, with the derivatives of both
//! with respect to their initial states and the free values. The derivatives are those of the
//! numerical Runge–Kutta steps.

use nalgebra::{DMatrix, DVector};

use crate::EstimateError;
use crate::data::setup::Measured;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::matrix::{add_scaled, dot, multiply};
use crate::motion::plant::{Place, Plant, Scratch, StateSpace};
use crate::motion::timeline::{Action, Advance};
use crate::motion::transition::{STAGES, WEIGHTS};
use crate::motion::unfiltered::{Stage, Unfiltered};

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
    motion: Unfiltered<'a>,
    run: usize,
    /// Free values, each with its derivative with respect to its coordinate.
    unknowns: &'a [(Unknown, f64)],
    n: usize,
    width: usize,
    /// Derivatives of the state, n rows.
    by: Vec<f64>,
    rows: Vec<f64>,
}

impl<'a> SegmentIntegrator<'a> {
    pub(super) fn new(
        estimation: &'a Estimation<'_>,
        values: &'a [f64],
        run: usize,
        unknowns: &'a [(Unknown, f64)],
    ) -> Self {
        let recording = &estimation.recordings()[run];
        let motion = Unfiltered::new(estimation.system(run), values, recording);
        let n = motion.z.len();
        let width = n + unknowns.len();
        Self {
            estimation,
            motion,
            run,
            unknowns,
            n,
            width,
            by: vec![0.0; n * width],
            rows: Vec::new(),
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
        for action in self.estimation.actions(self.run, self.motion.values) {
            match action {
                Action::Advance(advance) => self.advance(advance, 1),
                Action::Switch { row, input } => {
                    self.motion.switch(row, input, is_first);
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
        self.motion.z.copy_from_slice(state.as_slice());
        self.by.fill(0.0);
        let diagonal = self.by.iter_mut().step_by(self.width + 1);
        diagonal.take(self.n).for_each(|entry| *entry = 1.0);
        let (run, t) = (self.run, self.motion.recording.times()[row]);
        let closed = self.motion.close(t);
        closed.map_err(|source| EstimateError::Open { run, t, source })?;
        let motion = &mut self.motion;
        let Some(closure) = &motion.closure else {
            return Ok(());
        };
        let (layout, plant) = (motion.system.layout, motion.system.plant);
        let place = Place::new(layout, motion.values, t, state.as_slice(), &motion.held);
        let scratch = &mut motion.scratch;
        closure.follow(&mut self.by);
        for (column, &(unknown, stretch)) in (self.n..).zip(self.unknowns) {
            if let Unknown::Parameter(index) = unknown {
                for (state, slope) in closure.by_parameter(plant, place, scratch, index) {
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
            end: DVector::from_column_slice(&self.motion.z),
            by: DMatrix::from_row_slice(self.n, self.width, &self.by),
        }
    }

    /// One step of the state and its derivatives, or parts of it if it is too long.
    fn advance(&mut self, advance: Advance, of: u32) {
        let (n, h, unknowns) = (self.n, advance.h, self.unknowns);
        let plant = self.motion.system.plant;
        let (before, mut by, mut by_stage) = (&self.by, self.by.clone(), self.by.clone());
        let mut by_rates = vec![0.0; n * self.width];
        let mut follow = |stage: Stage<'_>, scratch: &mut Scratch| {
            multiply(stage.slopes, &by_stage, n, &mut by_rates);
            unknowns_in_rates(plant, unknowns, &stage, scratch, &mut by_rates);
            add_scaled(h * WEIGHTS[stage.index], &by_rates, &mut by);
            if let Some(next) = STAGES.get(stage.index) {
                by_stage.copy_from_slice(before);
                add_scaled(h * next, &by_rates, &mut by_stage);
            }
        };
        let parts = self.motion.step(advance, of, Some(&mut follow));
        if parts == 1 {
            self.by = by;
            return;
        }
        for part in advance.parts(parts) {
            self.advance(part, of * parts);
        }
    }

    /// Adds the samples of one delayed channel, or of all others.
    fn measure(&mut self, row: usize, only: Option<usize>) -> Result<(), EstimateError> {
        let motion = &mut self.motion;
        let StateSpace {
            setup,
            plant,
            layout,
        } = motion.system;
        let n = self.n;
        let count = setup.output_len();
        let (mut outputs, mut slopes) = (vec![0.0; count], vec![0.0; count * n]);
        let (read, t) = motion.reading(row, only);
        let place = Place::new(layout, motion.values, t, &motion.z, &read.held);
        if count > 0 {
            let z = plant.read_state(place, &mut motion.scratch, &read);
            let place = Place { z: &z, ..place };
            plant.outputs(place, &mut motion.scratch, &mut outputs, &mut slopes);
        }
        // Inputs that lag are not those of the motion.
        let first = setup.model.info().state_len();
        let mut by_lags = Vec::new();
        for slopes in slopes.chunks_exact_mut(n) {
            for (slope, [_, by]) in slopes[first..].iter_mut().zip(&read.lags) {
                by_lags.push(std::mem::take(slope) * by);
            }
        }
        let measured = motion.recording.measured(row);
        for index in setup.sampled(measured, only) {
            let (scale, bias) = (layout.scale(index), layout.bias(index));
            let (scale, bias) = (motion.values[scale], motion.values[bias]);
            let weight = 1.0 / motion.values[layout.noise(index)];
            let start = self.rows.len();
            self.rows.resize(start + self.width + 1, 0.0);
            let line = &mut self.rows[start..];
            let mut by_parameters = Vec::new();
            let quantity = match setup.reads(index) {
                Measured::State(state) => {
                    let by = &self.by[state * self.width..(state + 1) * self.width];
                    add_scaled(-weight * scale, by, line);
                    motion.z[state]
                }
                Measured::Output(output) => {
                    for (slope, by) in slopes[output * n..(output + 1) * n]
                        .iter()
                        .zip(self.by.chunks_exact(self.width))
                    {
                        add_scaled(-weight * scale * slope, by, line);
                    }
                    let gradient = plant.output_gradient(place, &mut motion.scratch, output, 1.0);
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

/// Adds the direct effect of the free values on the rates at a stage to their derivatives, n rows.
fn unknowns_in_rates(
    plant: &Plant<'_>,
    unknowns: &[(Unknown, f64)],
    stage: &Stage<'_>,
    scratch: &mut Scratch,
    by_rates: &mut [f64],
) {
    let place = stage.place;
    let (states, count) = (plant.info().state_len(), plant.info().parameter_len());
    let width = plant.n + unknowns.len();
    let is_parameter = |&(unknown, _): &(Unknown, f64)| matches!(unknown, Unknown::Parameter(_));
    let (mut slopes, mut filters) = (Vec::new(), Vec::new());
    if unknowns.iter().any(is_parameter) {
        slopes.resize(states * count, 0.0);
        plant.parameter_jacobian(place, scratch, &mut slopes);
        filters = plant.filters_by_parameters(place, scratch);
    }
    for (column, &(unknown, stretch)) in (plant.n..).zip(unknowns) {
        match unknown {
            Unknown::Parameter(index) => {
                for state in 0..states {
                    by_rates[state * width + column] += stretch * slopes[state * count + index];
                }
                for (state, slopes) in &filters {
                    by_rates[state * width + column] += stretch * slopes[index];
                }
            }
            Unknown::Lag(lag) => {
                let (tau, state) = (place.lags[lag], states + lag);
                let gap = plant.gap(place, stage.rates, lag);
                by_rates[state * width + column] -= stretch * gap / (tau * tau);
            }
            _ => {}
        }
    }
}
