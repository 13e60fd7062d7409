//! The square-root extended Kalman filter (Bierman 1977; Särkkä, *Bayesian Filtering and
//! Smoothing*, 2013, section 5.2).
//!
//! Time: z⁺ by a Runge–Kutta step, subdivided at kinks of the rates if `has_corners` is set;
//! P⁺ = F (P + N) Fᵀ + N, where N is half of the noise of the step: half enters before it and half
//! after. Measurements: one scalar after the other, all linearised about the state before the first
//! of them, which is the update with all at once where noise is independent. The residuals of these
//! scalars are independent of each other and of all earlier ones: squares and logarithms of their
//! variances add up to the likelihood. Where coordinates depend on each other, loops are closed
//! after each of the two.

use std::f64::consts::TAU;

use super::process_noise::{directions, disturbed};
use super::square_root::potter;
use super::tape::{Record, Sample, SampleTape, Sizes};
use crate::EstimateError;
use crate::data::recording::Recording;
use crate::data::setup::Measured;
use crate::matrix::{add_scaled, dot, multiply, pieces, scale, transposed_multiply};
use crate::motion::closure::Closure;
use crate::motion::command::{self, OfOutputs, Switch};
use crate::motion::plant::{Place, Scratch, StateSpace};
use crate::motion::timeline::{Action, Advance};
use crate::motion::transition::{MOST_PARTS, Span, step, within};

/// The innovation of a measured scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Innovation {
    /// Row of the recording.
    pub row: usize,
    /// Channel.
    pub channel: usize,
    /// Sampling time in s.
    pub t: f64,
    /// Measured value minus its prediction from all earlier rows, in SI.
    pub residual: f64,
    /// Variance of that residual.
    pub variance: f64,
    /// Measured value minus its prediction from all earlier rows and the channels before it in the
    /// row. Divided by the square root of `white_variance` it is white noise of variance 1.
    pub white_residual: f64,
    /// Its variance.
    pub white_variance: f64,
}

impl Innovation {
    /// White noise of variance 1 if the model and the noise levels are correct.
    pub fn whitened(&self) -> f64 {
        self.white_residual / self.white_variance.sqrt()
    }

    /// Its contribution to the log-likelihood.
    pub fn log_likelihood(&self) -> f64 {
        let (e, s) = (self.white_residual, self.white_variance);
        -0.5 * ((TAU * s).ln() + e * e / s)
    }
}

/// A measured scalar.
#[derive(Clone, Copy)]
struct Reading {
    row: usize,
    channel: usize,
    /// Sampling time in s.
    t: f64,
    measured: f64,
    /// Offset of its numbers on the tape.
    tape: usize,
    /// Offset of those of the first scalar of its moment.
    prior: usize,
}

/// One run of the filter along a recording.
pub(crate) struct Pass<'a> {
    pub(crate) system: StateSpace<'a>,
    pub(crate) values: &'a [f64],
    pub(crate) run: usize,
    pub(crate) sizes: Sizes,
    /// Whether the tape keeps the whole pass, not only the last action.
    keeps: bool,
    /// Number of steps so far, those included that were cut into parts, and the largest one.
    pub(crate) steps: usize,
    pub(crate) most_steps: usize,
    /// Whether the tape has the directions of the disturbances: without process noise they do not matter.
    pub(crate) is_disturbed: bool,
    pub(crate) tape: Vec<f64>,
    pub(crate) records: Vec<Record>,
    pub(crate) samples: Vec<Sample>,
    pub(crate) z: Vec<f64>,
    pub(crate) root: Vec<f64>,
    pub(crate) held: Vec<f64>,
    /// Of each lag of an input: how far inputs before the first row have moved it, and the derivative by its time
    /// constant.
    pub(crate) before: Vec<[f64; 2]>,
    scratch: Scratch,
    pub(crate) closure: Option<Closure>,
    spread: Vec<f64>,
    wide: Vec<f64>,
    /// Sᵀ c.
    projection: Vec<f64>,
    outputs: Vec<f64>,
    output_slopes: Vec<f64>,
}

impl<'a> Pass<'a> {
    /// Before the first action. Without an empty `tape` to keep it on only the innovations remain.
    pub(crate) fn new(
        system: StateSpace<'a>,
        values: &'a [f64],
        run: usize,
        recording: &Recording,
        actions: &[Action],
        tape: Option<Vec<f64>>,
    ) -> Self {
        let mut pass = Self::blank(system, values, run);
        pass.keeps = tape.is_some();
        pass.records.reserve(actions.len());
        let samples = recording.times().len() * pass.system.setup.channels.len();
        pass.samples.reserve(samples);
        if let Some(tape) = tape {
            pass.tape = tape;
            let steps = actions
                .iter()
                .filter(|a| matches!(a, Action::Advance(_)))
                .count();
            let sizes = pass.sizes;
            pass.tape
                .reserve(steps * sizes.step_len() + samples * sizes.sample_len());
        }
        pass.start(recording);
        pass
    }

    /// Before any position.
    pub(crate) fn blank(system: StateSpace<'a>, values: &'a [f64], run: usize) -> Self {
        let StateSpace { setup, plant, .. } = system;
        let (n, info) = (plant.n, plant.info());
        let outputs = setup.output_len();
        let sizes = Sizes {
            n,
            commands: command::NUMBERS * info.declared_inputs,
            disturbances: setup.disturbances.len(),
        };
        let zeros = |len| vec![0.0; len];
        let first = system.layout.disturbance(0);
        let levels = &values[first..first + sizes.disturbances];
        Self {
            system,
            values,
            run,
            sizes,
            keeps: false,
            steps: 0,
            most_steps: usize::MAX,
            is_disturbed: levels.iter().any(|&level| level != 0.0),
            tape: Vec::new(),
            records: Vec::new(),
            samples: Vec::new(),
            z: zeros(n),
            root: zeros(n * n),
            held: zeros(sizes.commands),
            before: Vec::new(),
            scratch: plant.scratch(),
            closure: Closure::of(plant),
            spread: zeros(2 * n * (n + sizes.disturbances)),
            wide: zeros(n * (n + 2 * sizes.disturbances)),
            projection: zeros(n),
            outputs: zeros(outputs),
            output_slopes: zeros(outputs * n),
        }
    }

    pub(crate) fn act(
        &mut self,
        recording: &Recording,
        action: Action,
    ) -> Result<(), EstimateError> {
        if !self.keeps {
            self.tape.clear();
        }
        match action {
            Action::Advance(advance) => self.advance(advance, 1)?,
            Action::Switch { row, input } => {
                let first = self.records.is_empty();
                let StateSpace { setup, layout, .. } = self.system;
                let switch = Switch { row, input, first };
                switch.apply(&mut self.held, setup, layout, self.values, recording);
                if !first {
                    return Ok(());
                }
            }
            Action::Measure { row, channel } => self.measure(recording, row, channel)?,
        }
        self.close(action.end(recording))
    }

    pub(crate) fn log_likelihood(&self) -> f64 {
        let samples = self.samples.iter();
        samples
            .map(|sample| sample.innovation.log_likelihood())
            .sum()
    }

    /// A point at a time, state and commands.
    pub(crate) fn place<'p>(&self, t: f64, z: &'p [f64], held: &'p [f64]) -> Place<'p>
    where
        'a: 'p,
    {
        Place::new(self.system.layout, self.values, t, z, held)
    }

    pub(crate) fn lags(&self) -> &'a [f64] {
        let start = self.system.layout.lag(0);
        &self.values[start..start + self.system.layout.lags]
    }

    /// The initial state. Inputs before the first row have moved the lags of inputs.
    fn start(&mut self, recording: &Recording) {
        let n = self.sizes.n;
        let (initial, spread) = (
            self.system.layout.initial(self.run),
            self.system.layout.spread(self.run),
        );
        self.z.copy_from_slice(&self.values[initial..initial + n]);
        for i in 0..n {
            self.root[i * (n + 1)] = self.values[spread + i];
        }
        let setup = self.system.setup;
        let before = setup.lagging.iter().zip(self.lags());
        self.before = before
            .map(|(&input, &lag)| recording.lag_before(input, lag))
            .collect();
        let first = setup.model.info().state_len();
        for (lag, [ahead, _]) in self.z[first..].iter_mut().zip(&self.before) {
            *lag += ahead;
        }
    }

    /// Room on the tape.
    fn record(&mut self, len: usize) -> usize {
        let start = self.tape.len();
        self.tape.resize(start + len, 0.0);
        start
    }

    /// Advances by a step, one of `of` parts of a whole one, or by parts of it if it is too long.
    fn advance(&mut self, advance: Advance, of: u32) -> Result<(), EstimateError> {
        self.steps += 1;
        if self.steps > self.most_steps {
            return Err(EstimateError::Diverged {
                run: self.run,
                t: advance.t,
            });
        }
        let tape = self.record(self.sizes.step_len());
        self.records.push(Record::Advance { advance, tape });
        let (n, d) = (self.sizes.n, self.sizes.disturbances);
        let h = advance.h;
        let mut on = self.sizes.step(&mut self.tape[tape..]);
        on.held.copy_from_slice(&self.held);
        on.root.copy_from_slice(&self.root);
        on.stages.z[..n].copy_from_slice(&self.z);
        let span = Span::new(self.system.layout, self.values, advance, on.held);
        if self.is_disturbed {
            directions(
                self.system.setup,
                self.system.plant,
                span.place(0, &self.z),
                &mut self.scratch,
                on.columns,
            );
        }
        // Loops are closed only after whole steps.
        let is_cut = self.system.setup.has_corners && self.closure.is_none() && of < MOST_PARTS;
        let plant = self.system.plant;
        let own = if is_cut { plant.info().state_len() } else { 0 };
        let after = [&mut *on.after, &mut *on.f];
        let (scratch, stages) = (&mut self.scratch, &mut on.stages);
        let parts = step(plant, span, scratch, stages, after, own, self.is_disturbed);
        if parts > 1 {
            self.tape.truncate(tape);
            self.records.pop();
            return self.advance_in_parts(advance, of, within(parts, of));
        }
        if self.is_disturbed {
            let layout = self.system.layout;
            let noise = |j| self.values[layout.disturbance(j)] * (0.5 * h).sqrt();
            let roots = [&mut self.spread[..], &mut self.wide[..]];
            let step = [&*on.f, on.root, on.columns];
            disturbed(step, [n, d], noise, roots, &mut self.root);
        } else {
            multiply(on.f, on.root, n, &mut self.root);
        }
        self.z.copy_from_slice(on.after);
        let finite = self
            .z
            .iter()
            .chain(&self.root)
            .all(|entry| entry.is_finite());
        finite.then_some(()).ok_or(EstimateError::Diverged {
            run: self.run,
            t: advance.t + h,
        })
    }

    /// Advances by the parts of a step. A long pass that keeps everything keeps the start of the whole step.
    pub(crate) fn advance_in_parts(
        &mut self,
        advance: Advance,
        of: u32,
        parts: u32,
    ) -> Result<(), EstimateError> {
        let kept = (self.keeps && of == 1 && self.is_long()).then(|| {
            let tape = self.tape.len();
            for start in [&self.held, &self.z, &self.root] {
                self.tape.extend_from_slice(start);
            }
            self.records.push(Record::Parts {
                advance,
                parts,
                tape,
            });
            (self.tape.len(), self.records.len())
        });
        let mut all = advance.parts(parts);
        all.try_for_each(|part| self.advance(part, of * parts))?;
        if let Some((tape, records)) = kept {
            self.tape.truncate(tape);
            self.records.truncate(records);
        }
        Ok(())
    }

    /// Whether the tapes of all runs would take too much memory with the parts of steps.
    fn is_long(&self) -> bool {
        let each = self.system.setup.most_memory / self.system.layout.runs.max(1);
        self.tape.len() > each / size_of::<f64>()
    }

    /// Closes the loops.
    fn close(&mut self, t: f64) -> Result<(), EstimateError> {
        let Some(closure) = &mut self.closure else {
            return Ok(());
        };
        let z = self.z.clone();
        let place = Place::new(self.system.layout, self.values, t, &z, &self.held);
        let run = self.run;
        closure
            .close(self.system.plant, place, &mut self.scratch, &mut self.z)
            .map_err(|source| EstimateError::Open { run, t, source })?;
        let tape = self.tape.len();
        self.tape.extend(&self.z);
        self.tape.extend(&self.root);
        closure.follow(&mut self.root);
        let held = self.held.clone();
        self.records.push(Record::Close { t, held, tape });
        Ok(())
    }

    /// Updates by the scalars that were sampled for a row: one delayed channel, or all others.
    fn measure(
        &mut self,
        recording: &Recording,
        row: usize,
        only: Option<usize>,
    ) -> Result<(), EstimateError> {
        let first = self.samples.len();
        let measured = recording.measured(row);
        let t = recording.times()[row];
        let channels = self.system.setup.sampled(measured, only);
        let (held, lags) =
            self.linearise_outputs(recording, row, self.sampling_time(t, only), &channels);
        let prior = self.record(channels.len() * self.sizes.sample_len());
        for (count, &channel) in channels.iter().enumerate() {
            let reading = Reading {
                row,
                channel,
                t,
                measured: measured[channel],
                tape: prior + count * self.sizes.sample_len(),
                prior,
            };
            self.update(reading)?;
        }
        let samples = first..self.samples.len();
        let row = only.is_none().then_some(row);
        self.records.push(Record::Measure {
            row,
            samples,
            held,
            lags,
        });
        Ok(())
    }

    /// When a delayed channel, or another, was sampled for a row at a time.
    pub(crate) fn sampling_time(&self, t: f64, delayed: Option<usize>) -> f64 {
        let delay = |channel| self.values[self.system.layout.sensor_delay(channel)];
        t - delayed.map_or(0.0, delay)
    }

    /// The same for the row of a sample.
    pub(crate) fn time_of(&self, sample: &Innovation) -> f64 {
        let channel = &self.system.setup.channels[sample.channel];
        let delayed = channel.longest_delay.map(|_| sample.channel);
        self.sampling_time(sample.t, delayed)
    }

    /// Evaluates the outputs and their slopes if any is sampled; then returns their inputs, and those that lag.
    fn linearise_outputs(
        &mut self,
        recording: &Recording,
        row: usize,
        t: f64,
        channels: &[usize],
    ) -> (Vec<f64>, Vec<[f64; 2]>) {
        let StateSpace {
            setup,
            plant,
            layout,
        } = self.system;
        let is_output = |&c: &usize| matches!(setup.reads(c), Measured::Output(_));
        if !channels.iter().any(is_output) {
            return (Vec::new(), Vec::new());
        }
        let read = OfOutputs::of(recording, row, &self.held, setup, layout, self.values);
        let place = Place::new(layout, self.values, t, &self.z, &read.held);
        let z = plant.read_state(place, &mut self.scratch, &read);
        let (outputs, slopes) = (&mut self.outputs, &mut self.output_slopes);
        plant.outputs(Place { z: &z, ..place }, &mut self.scratch, outputs, slopes);
        let first = setup.model.info().state_len();
        for slopes in slopes.chunks_exact_mut(self.sizes.n) {
            slopes[first..][..read.lags.len()].fill(0.0);
        }
        (read.held, read.lags)
    }

    /// Updates the state and the root of P by a scalar, after recording both and the output row. The quantity without scale
    /// and bias is that in the state before the first scalar of this time.
    fn update(&mut self, reading: Reading) -> Result<(), EstimateError> {
        let Reading {
            row,
            channel,
            t,
            measured,
            tape,
            prior,
        } = reading;
        let (n, layout, values) = (self.sizes.n, self.system.layout, self.values);
        let gain = values[layout.scale(channel)];
        let bias = values[layout.bias(channel)];
        let noise = values[layout.noise(channel)];
        let (earlier, rest) = self.tape.split_at_mut(tape);
        let SampleTape { c, a, z, root } = self.sizes.sample(rest);
        z.copy_from_slice(&self.z);
        root.copy_from_slice(&self.root);
        c.fill(0.0);
        let quantity = match self.system.setup.reads(channel) {
            Measured::State(state) => {
                c[state] = 1.0;
                if tape == prior {
                    z[state]
                } else {
                    earlier[prior + 2 * n + state]
                }
            }
            Measured::Output(output) => {
                c.copy_from_slice(&self.output_slopes[output * n..(output + 1) * n]);
                self.outputs[output]
            }
        };
        scale(gain, c);
        let residual = measured - gain * quantity - bias;
        let r = noise * noise;
        let mut white = residual;
        let mut variance = None;
        if tape > prior {
            let [_, _, first_z, first_root] = pieces(&mut earlier[prior..], [n, n, n, n * n]);
            white -= dot(c, z) - dot(c, first_z);
            transposed_multiply(first_root, c, n, &mut self.projection);
            variance = Some(dot(&self.projection, &self.projection) + r);
        }
        transposed_multiply(root, c, n, &mut self.projection);
        multiply(root, &self.projection, n, a);
        let s = dot(&self.projection, &self.projection) + r;
        if !(s > 0.0 && s.is_finite() && white.is_finite()) {
            return Err(EstimateError::Diverged { run: self.run, t });
        }
        add_scaled(white / s, a, &mut self.z);
        potter(&mut self.root, &self.projection, a, s, r);
        self.samples.push(Sample {
            innovation: Innovation {
                row,
                channel,
                t,
                residual,
                variance: variance.unwrap_or(s),
                white_residual: white,
                white_variance: s,
            },
            quantity,
            tape,
        });
        Ok(())
    }
}
