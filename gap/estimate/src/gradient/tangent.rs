//! Derivatives of all innovations with respect to some values, by one pass of the filter.
//!
//! The gains of the filter are held: their changes multiply innovations, which have zero mean, and
//! so do not enter the Fisher information of the mean. Each column costs no more than one row of
//! the covariance, be it for a parameter, a bias, a delay that is not part of the setup, or a
//! candidate force.
//!
//! Every column is predictable: its contribution to a reading does not depend on that reading. A controller computes
//! its command from the reading of the same row, so that the command contains the noise of the reading and would be
//! correlated with the innovation. The command of a row therefore acts on later readings only.

use nalgebra::DMatrix;

use super::direction::{Along, Direction, Shapes, Tangent};
use crate::EstimateError;
use crate::data::setup::Measured;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::kalman::filter::{Innovation, Pass};
use crate::kalman::tape::{Record, SampleTape};
use crate::matrix::{add_scaled, dot, multiply, multiply_add};
use crate::motion::command;
use crate::motion::plant::{Place, Plant, Scratch};
use crate::motion::timeline::{Action, Advance};
use crate::motion::transition::{Span, added_by_rate, by_constant_rates};

impl Estimation<'_> {
    /// The tangent of all recordings at some values.
    pub fn tangent(
        &self,
        values: &[f64],
        directions: &[Direction],
        shapes: Option<Shapes<'_>>,
    ) -> Result<Tangent, EstimateError> {
        self.check(values)?;
        let layout = self.layout();
        for direction in directions {
            if let Direction::Value(unknown) = *direction {
                layout.place(unknown)?;
            }
        }
        let candidates = shapes.map_or(0, |shapes| {
            let setup = self.setup();
            shapes.count
                * match shapes.along {
                    Along::Disturbances => setup.disturbances.len(),
                    Along::Channels => setup.channels.len(),
                }
        });
        let columns = directions.len() + candidates;
        let runs = self.over_runs(|run| {
            let actions = self.actions(run, values);
            let mut pass = self.fresh(run, values, &actions, None, &[]);
            pass.is_disturbed |= shapes.is_some_and(|own| own.along == Along::Disturbances);
            let mut forward = Forward::new(self, pass, directions, shapes, columns);
            forward.over(&actions)?;
            Ok((forward.pass.samples, forward.rows, forward.added_squares))
        })?;
        let mut added_squares = vec![0.0; candidates];
        let mut samples: Vec<(usize, Innovation, &[f64])> = Vec::new();
        for (run, (own, rows, squares)) in runs.iter().enumerate() {
            samples.extend(own.iter().enumerate().map(|(row, sample)| {
                let slopes = &rows[row * columns..(row + 1) * columns];
                (run, sample.innovation, slopes)
            }));
            add_scaled(1.0, squares, &mut added_squares);
        }
        let steps: usize = (self.recordings().iter())
            .map(|recording| recording.times().len() - 1)
            .sum();
        for square in &mut added_squares {
            *square /= steps.max(1) as f64;
        }
        samples.sort_by_key(|(run, sample, _)| (*run, sample.row, sample.channel));
        let slopes: Vec<&[f64]> = samples.iter().map(|(.., own)| *own).collect();
        Ok(Tangent {
            samples: (samples.iter())
                .map(|(run, sample, _)| (*run, *sample))
                .collect(),
            slopes: DMatrix::from_vec(columns, samples.len(), slopes.concat()),
            added_squares,
        })
    }
}

/// Derivatives of the state along a run.
pub(super) struct Forward<'p, 'a> {
    estimation: &'p Estimation<'a>,
    pub(super) pass: Pass<'p>,
    directions: Vec<Direction>,
    shapes: Option<Shapes<'p>>,
    columns: usize,
    /// By each direction, n rows.
    z: Vec<f64>,
    moved: Vec<f64>,
    /// Direct effect on the rates.
    added: Vec<f64>,
    /// Increments of a step by constant rates.
    increments: Vec<f64>,
    by_parameters: Vec<f64>,
    by_states: Vec<f64>,
    by_inputs: Vec<f64>,
    tried: Vec<f64>,
    rates: Vec<f64>,
    scratch: Scratch,
    /// The inputs that were held before those of the present row.
    earlier: Vec<f64>,
    /// Whether inputs have changed since the last step.
    switched: bool,
    /// Derivatives of the whitened innovations.
    pub(super) rows: Vec<f64>,
    /// The mean time between rows in s.
    interval: f64,
    added_squares: Vec<f64>,
}

impl<'p, 'a> Forward<'p, 'a> {
    pub(super) fn new(
        estimation: &'p Estimation<'a>,
        pass: Pass<'p>,
        directions: &[Direction],
        shapes: Option<Shapes<'p>>,
        columns: usize,
    ) -> Self {
        let (setup, n) = (estimation.setup(), pass.sizes.n);
        let directions: Vec<Direction> = directions
            .iter()
            .map(|&direction| match direction {
                Direction::Value(Unknown::InputDelay(index)) => {
                    Direction::LateInput(setup.delayed[index])
                }
                Direction::Value(Unknown::SensorDelay(channel)) => Direction::LateChannel(channel),
                other => other,
            })
            .collect();
        let info = setup.model.info();
        let zeros = |len| vec![0.0; len];
        let candidates = columns - directions.len();
        let recording = &estimation.recordings()[pass.run];
        let times = recording.times();
        let samples = times.len() * setup.channels.len();
        let whole = times.last().zip(times.first());
        let whole = whole.map_or(0.0, |(last, first)| last - first);
        let mut z = zeros(n * columns);
        for (column, direction) in directions.iter().enumerate() {
            match *direction {
                Direction::Value(Unknown::Initial { run, state }) if run == pass.run => {
                    z[state * columns + column] = 1.0;
                }
                Direction::Value(Unknown::Lag(lag)) => {
                    let moved = pass.before.get(lag).map_or(0.0, |[_, slope]| *slope);
                    z[(info.state_len() + lag) * columns + column] = moved;
                }
                _ => {}
            }
        }
        Self {
            estimation,
            directions,
            shapes,
            columns,
            z,
            moved: zeros(n * columns),
            added: zeros(n * columns),
            increments: zeros(n * n),
            by_parameters: zeros(info.state_len() * info.parameter_len()),
            by_states: zeros(info.state_len() * info.state_len()),
            by_inputs: zeros(info.state_len() * info.input_len()),
            tried: zeros(shapes.map_or(0, |shapes| shapes.count)),
            rates: zeros(n),
            scratch: pass.system.plant.scratch(),
            earlier: pass.held.clone(),
            switched: false,
            rows: Vec::with_capacity(columns * samples),
            interval: whole / (times.len() - 1).max(1) as f64,
            added_squares: zeros(candidates),
            pass,
        }
    }

    pub(super) fn over(&mut self, actions: &[Action]) -> Result<(), EstimateError> {
        actions.iter().try_for_each(|&action| self.act(action))
    }

    fn act(&mut self, action: Action) -> Result<(), EstimateError> {
        let (records, samples) = (self.pass.records.len(), self.pass.samples.len());
        let recording = &self.estimation.recordings()[self.pass.run];
        if matches!(action, Action::Advance(_)) && std::mem::take(&mut self.switched) {
            self.switch();
        }
        self.pass.act(recording, action)?;
        match action {
            Action::Advance(_) => {
                let mut tape = std::mem::take(&mut self.pass.tape);
                for record in records..self.pass.records.len() {
                    let record = self.pass.records[record].clone();
                    self.follow(&record, &mut tape);
                }
                self.pass.tape = tape;
                self.earlier.clone_from(&self.pass.held);
            }
            Action::Switch { .. } if records > 0 => self.switched = true,
            Action::Switch { .. } => self.earlier.clone_from(&self.pass.held),
            Action::Measure { .. } => self.measure(samples),
        }
        self.close(action, recording);
        Ok(())
    }

    /// Follows a step.
    fn follow(&mut self, record: &Record, tape: &mut [f64]) {
        if let Record::Advance { advance, tape: at } = *record {
            self.advance(advance, &mut tape[at..]);
        } else if let Some(mut parts) = self.pass.in_parts(record, tape) {
            for part in &parts.records {
                self.follow(part, &mut parts.tape);
            }
        }
    }

    /// Projects onto the dependent coordinates.
    fn close(&mut self, action: Action, recording: &crate::Recording) {
        let Some(closure) = &self.pass.closure else {
            return;
        };
        closure.follow(&mut self.z);
        let t = action.end(recording);
        let place = self.pass.place(t, &self.pass.z, &self.pass.held);
        for (column, direction) in self.directions.iter().enumerate() {
            if let Direction::Value(Unknown::Parameter(index)) = *direction {
                let plant = self.pass.system.plant;
                for (state, slope) in closure.by_parameter(plant, place, &mut self.scratch, index) {
                    self.z[state * self.columns + column] += slope;
                }
            }
        }
    }

    /// Z ← F Z + H, where H is the increment by the direct effect on the rates, with that at the midpoint of the step.
    fn advance(&mut self, advance: Advance, tape: &mut [f64]) {
        let (n, columns) = (self.pass.sizes.n, self.columns);
        let info = self.estimation.setup().model.info();
        let (states, parameters) = (info.state_len(), info.parameter_len());
        // Lags may be as short as the step: their slopes follow its stages.
        let lagged = self.lagged(advance, tape);
        let disturbances = self.pass.sizes.disturbances;
        let plant = self.pass.system.plant;
        let on = self.pass.sizes.step(tape);
        let middle = &on.stages.z[n..2 * n];
        let t = advance.t + 0.5 * advance.h;
        let place = self.pass.place(t, middle, on.held);
        self.added.fill(0.0);
        if self.directions.iter().any(is_parameter) {
            plant.parameter_jacobian(place, &mut self.scratch, &mut self.by_parameters);
        }
        for (column, direction) in self.directions.iter().enumerate() {
            if let Direction::Value(Unknown::Parameter(index)) = *direction {
                for state in 0..states {
                    self.added[state * columns + column] =
                        self.by_parameters[state * parameters + index];
                }
            }
        }
        if let Some(shapes) = self
            .shapes
            .filter(|shapes| shapes.along == Along::Disturbances)
        {
            plant.at(place, &mut self.scratch, |at| {
                (shapes.values)(self.pass.run, at, &mut self.tried);
            });
            for (j, first) in (self.directions.len()..columns)
                .step_by(shapes.count.max(1))
                .enumerate()
            {
                let mut square = 0.0_f64;
                for i in 0..n {
                    let column = on.columns[i * disturbances + j];
                    if column == 0.0 {
                        continue;
                    }
                    let row = &mut self.added[i * columns + first..][..shapes.count];
                    add_scaled(column, &self.tried, row);
                    let root = &on.root[i * n..(i + 1) * n];
                    let variance = dot(root, root);
                    if variance > 0.0 {
                        square = square.max(column * column / variance);
                    }
                }
                let first = first - self.directions.len();
                let added = &mut self.added_squares[first..][..shapes.count];
                for (added, tried) in added.iter_mut().zip(&self.tried) {
                    *added += advance.h * self.interval * tried * tried * square;
                }
            }
        }
        for (column, direction) in self.directions.iter().enumerate() {
            if let Direction::LateInput(input) = *direction {
                let slope = command::slope(on.held, input, place.t);
                if slope != 0.0 {
                    let (by_states, by_inputs) = (&mut self.by_states, &mut self.by_inputs);
                    let by = by_input(plant, place, &mut self.scratch, by_states, by_inputs, input);
                    for (state, by) in by.into_iter().enumerate() {
                        self.added[state * columns + column] -= slope * by;
                    }
                }
            }
        }
        by_constant_rates(&on.stages, n, advance.h, &mut self.increments);
        multiply(on.f, &self.z, n, &mut self.moved);
        multiply_add(&self.increments, &self.added, n, &mut self.moved);
        std::mem::swap(&mut self.z, &mut self.moved);
        for (column, added) in lagged {
            for (state, added) in added.into_iter().enumerate() {
                self.z[state * columns + column] += added;
            }
        }
    }

    /// Increments of a step by the direct effect of directions on the rates of lags, each with its
    /// column.
    fn lagged(&mut self, advance: Advance, tape: &mut [f64]) -> Vec<(usize, Vec<f64>)> {
        const ALL: [usize; 4] = [0, 1, 2, 3];
        let (n, states) = (
            self.pass.sizes.n,
            self.estimation.setup().model.info().state_len(),
        );
        let (lags, plant) = (self.pass.lags(), self.pass.system.plant);
        let on = self.pass.sizes.step(tape);
        let (layout, values) = (self.pass.system.layout, self.pass.values);
        let span = Span::new(layout, values, advance, on.held);
        let stage = |i: usize| span.place(i, &on.stages.z[i * n..(i + 1) * n]);
        let added = |state, rates| added_by_rate(&on.stages, n, advance.h, state, rates);
        let mut filters = [const { Vec::new() }; 4];
        if self.directions.iter().any(is_parameter) {
            filters = ALL.map(|i| plant.filters_by_parameters(stage(i), &mut self.scratch));
        }
        let mut lagged = Vec::new();
        for (column, direction) in self.directions.iter().enumerate() {
            match *direction {
                Direction::Value(Unknown::Lag(lag)) => {
                    let rates = ALL.map(|i| {
                        let rates = &on.stages.k[i * n..(i + 1) * n];
                        -plant.gap(stage(i), rates, lag) / (lags[lag] * lags[lag])
                    });
                    lagged.push((column, added(states + lag, rates)));
                }
                Direction::Value(Unknown::Parameter(index)) => {
                    for (place, &(state, _)) in filters[0].iter().enumerate() {
                        let rates = ALL.map(|i| filters[i][place].1[index]);
                        lagged.push((column, added(state, rates)));
                    }
                }
                _ => {}
            }
        }
        lagged
    }

    /// A later input would have had its previous values for longer.
    fn switch(&mut self) {
        let plant = self.pass.system.plant;
        for (column, direction) in self.directions.iter().enumerate() {
            let Direction::LateInput(input) = *direction else {
                continue;
            };
            let t = command::since(&self.pass.held, input);
            let [old, new] =
                [&self.earlier, &self.pass.held].map(|held| command::value(held, input, t));
            if old.to_bits() == new.to_bits() {
                continue;
            }
            let place = self.pass.place(t, &self.pass.z, &self.pass.held);
            let (by_states, by_inputs) = (&mut self.by_states, &mut self.by_inputs);
            let by = by_input(plant, place, &mut self.scratch, by_states, by_inputs, input);
            for (state, by) in by.into_iter().enumerate() {
                self.z[state * self.columns + column] += (old - new) * by;
            }
        }
    }

    fn measure(&mut self, first: usize) {
        let (n, columns) = (self.pass.sizes.n, self.columns);
        // The inputs of outputs that were read are on record.
        let (held, lags) = match self.pass.records.last() {
            Some(Record::Measure { held, lags, .. }) if !held.is_empty() => {
                (held.clone(), lags.clone())
            }
            _ => (self.pass.held.clone(), Vec::new()),
        };
        let states = self.estimation.setup().model.info().state_len();
        for index in first..self.pass.samples.len() {
            let sample = self.pass.samples[index];
            let channel = sample.innovation.channel;
            let (by_states, by_parameters, by_inputs) = self.output_slope(index, &held, &lags);
            let t = self.pass.time_of(&sample.innovation);
            let SampleTape { c, a, z, .. } =
                self.pass.sizes.sample(&mut self.pass.tape[sample.tape..]);
            let (values, earlier) = (self.pass.values, &self.earlier);
            let place = Place::new(self.pass.system.layout, values, t, z, earlier);
            let start = self.rows.len();
            self.rows.resize(start + columns, 0.0);
            let row = &mut self.rows[start..];
            for (state, &slope) in c.iter().enumerate() {
                if slope != 0.0 {
                    add_scaled(-slope, &self.z[state * columns..(state + 1) * columns], row);
                }
            }
            for (column, direction) in self.directions.iter().enumerate() {
                row[column] += match *direction {
                    Direction::Value(Unknown::Bias(biased)) if biased == channel => -1.0,
                    Direction::Value(Unknown::Scale(scaled)) if scaled == channel => {
                        -sample.quantity
                    }
                    Direction::Value(Unknown::Parameter(index)) if !by_parameters.is_empty() => {
                        -by_parameters[index]
                    }
                    Direction::LateChannel(late) if late == channel => {
                        self.pass
                            .system
                            .plant
                            .rates(place, &mut self.scratch, &mut self.rates);
                        dot(c, &self.rates) + command::by_time(&self.earlier, &by_inputs, t)
                    }
                    Direction::LateInput(input) if !by_inputs.is_empty() => {
                        by_inputs[input] * command::slope(&held, input, t)
                    }
                    Direction::Value(Unknown::Lag(lag))
                        if lag < lags.len() && !by_states.is_empty() =>
                    {
                        -by_states[states + lag] * lags[lag][1]
                    }
                    _ => 0.0,
                };
            }
            if let Some(shapes) = self.shapes.filter(|shapes| shapes.along == Along::Channels) {
                self.pass.system.plant.at(place, &mut self.scratch, |at| {
                    (shapes.values)(self.pass.run, at, &mut self.tried);
                });
                let first = self.directions.len() + channel * shapes.count;
                add_scaled(-1.0, &self.tried, &mut row[first..][..shapes.count]);
            }
            let s = sample.innovation.white_variance;
            for i in 0..n {
                add_scaled(a[i] / s, row, &mut self.z[i * columns..(i + 1) * columns]);
            }
            let deviation = s.sqrt();
            for entry in row {
                *entry /= deviation;
            }
        }
    }

    /// Derivatives of an output that is read with respect to the states, the parameters and the declared inputs; none for
    /// a state.
    fn output_slope(
        &mut self,
        index: usize,
        held: &[f64],
        lags: &[[f64; 2]],
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let sample = self.pass.samples[index];
        let setup = self.estimation.setup();
        let channel = sample.innovation.channel;
        let Measured::Output(output) = setup.reads(channel) else {
            return (Vec::new(), Vec::new(), Vec::new());
        };
        let scale = self.pass.values[self.pass.system.layout.scale(channel)];
        let t = self.pass.time_of(&sample.innovation);
        let mut z = self.pass.z.clone();
        for (own, [value, _]) in z[setup.model.info().state_len()..].iter_mut().zip(lags) {
            *own = *value;
        }
        let place = self.pass.place(t, &z, held);
        let plant = self.pass.system.plant;
        let by = plant.output_gradient(place, &mut self.scratch, output, scale);
        (by.z, by.p, by.u)
    }
}

/// Derivatives of the rates of all states with respect to a declared input; of the model's own by the two matrices.
fn by_input(
    plant: &Plant<'_>,
    place: Place<'_>,
    scratch: &mut Scratch,
    by_states: &mut [f64],
    by_inputs: &mut [f64],
    input: usize,
) -> Vec<f64> {
    let info = plant.info();
    let (states, inputs) = (info.state_len(), info.input_len());
    let mut by = vec![0.0; plant.n];
    if let Some(lag) = plant.lag_of(input) {
        by[states + lag] = 1.0 / place.lags[lag];
        return by;
    }
    let mut rates = vec![0.0; states];
    plant.at(place, scratch, |at| {
        plant.model.jacobians(at, &mut rates, by_states, by_inputs);
    });
    for (state, by) in by[..states].iter_mut().enumerate() {
        *by = by_inputs[state * inputs + input];
    }
    for (state, slope) in plant.filters_by_input(place, scratch, input) {
        by[state] += slope;
    }
    by
}

fn is_parameter(direction: &Direction) -> bool {
    matches!(direction, Direction::Value(Unknown::Parameter(_)))
}
