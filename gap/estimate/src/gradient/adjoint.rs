//! The gradient of the log-likelihood: reverse accumulation through the recursions of the filter.
//!
//! The covariance recursion is differentiated: it is the same function as its square-root form, and
//! its adjoint needs no derivative of a triangularisation. Gradients with respect to covariances
//! are symmetric.

use crate::data::setup::{Disturbance, Measured};
use crate::kalman::filter::Pass;
use crate::kalman::tape::{Record, Sample, SampleTape, StepTape};
use crate::matrix::{
    add, add_scaled, dot, multiply, multiply_transposed, multiply_transposed_add, pieces, scale,
    symmetrise, transposed_multiply,
};
use crate::motion::closure::Closure;
use crate::motion::command;
use crate::motion::plant::{Scratch, StateSpace, Sums};
use crate::motion::timeline::Advance;
use crate::motion::transition::{self, ByEnds, Effects, Reverse, Span};

/// Gradients during the reverse sweep.
struct Backward<'p, 'a> {
    pass: &'p Pass<'a>,
    /// With respect to the state after the next record, the parameters, the time constants, and the declared inputs of a
    /// step or moment.
    sums: Sums,
    /// With respect to the covariance after the next record.
    p: Vec<f64>,
    scratch: Scratch,
    closure: Option<Closure>,
    reverse: Reverse,
    square: [Vec<f64>; 3],
    vector: [Vec<f64>; 2],
    mass: Vec<f64>,
    forces: Vec<f64>,
    mu: Vec<f64>,
    slopes: Vec<f64>,
}

/// Adds to `gradient` that of the log-likelihood.
pub(crate) fn adjoint(pass: &mut Pass<'_>, gradient: &mut [f64]) {
    let mut tape = std::mem::take(&mut pass.tape);
    let (n, s) = (pass.sizes.n, pass.system.plant.speeds);
    let zeros = |len| vec![0.0; len];
    let outputs = pass.system.setup.output_len();
    let shared = &*pass;
    let mut back = Backward {
        pass: shared,
        sums: Sums::zeros(pass.system.plant),
        p: zeros(n * n),
        scratch: pass.system.plant.scratch(),
        closure: pass.closure.clone(),
        reverse: Reverse::new(pass.system.plant),
        square: [zeros(n * n), zeros(n * n), zeros(n * n)],
        vector: [zeros(n), zeros(n)],
        mass: zeros(s * s),
        forces: zeros(s * pass.sizes.disturbances),
        mu: zeros(outputs),
        slopes: zeros(outputs * n),
    };
    shared.walk_back(&mut tape, |record, tape| match record {
        Record::Advance { advance, tape: at } => {
            let on = shared.sizes.step(&mut tape[*at..]);
            back.advance(*advance, &on, gradient);
        }
        Record::Measure {
            samples,
            held,
            lags,
            ..
        } => {
            let samples = &shared.samples[samples.clone()];
            back.measure(samples, (held, lags), tape, gradient);
        }
        Record::Close { t, held, tape: at } => {
            let [z, root] = pieces(&mut tape[*at..], [n, n * n]);
            back.open(*t, held, z, root);
        }
        Record::Parts { .. } => {}
    });
    back.start(gradient);
    pass.tape = tape;
}

impl Backward<'_, '_> {
    /// The initial state and its standard deviations, and the accumulated sums.
    fn start(&self, gradient: &mut [f64]) {
        let layout = &self.pass.system.layout;
        let (n, run) = (self.pass.sizes.n, self.pass.run);
        add(&self.sums.z, &mut gradient[layout.initial(run)..][..n]);
        let spread = layout.spread(run);
        for i in 0..n {
            gradient[spread + i] += 2.0 * self.pass.values[spread + i] * self.p[i * (n + 1)];
        }
        add(&self.sums.p, gradient);
        add(&self.sums.lags, &mut gradient[layout.lag(0)..]);
        let first = self.pass.system.setup.model.info().state_len();
        for (lag, [_, slope]) in self.pass.before.iter().enumerate() {
            gradient[layout.lag(lag)] += slope * self.sums.z[first + lag];
        }
    }

    /// Loops that were closed.
    fn open(&mut self, t: f64, held: &[f64], z: &mut [f64], root: &[f64]) {
        let Some(closure) = &mut self.closure else {
            return;
        };
        let closed = z.to_vec();
        let plant = self.pass.system.plant;
        let place = self.pass.place(t, &closed, held);
        // The forward pass succeeded here.
        let _ = closure.close(plant, place, &mut self.scratch, z);
        let (scratch, sums) = (&mut self.scratch, &mut self.sums);
        closure.adjoint(plant, place, scratch, root, &mut self.p, sums);
    }

    /// A step.
    fn advance(&mut self, advance: Advance, on: &StepTape<'_>, gradient: &mut [f64]) {
        let pass = self.pass;
        let span = Span::new(pass.system.layout, pass.values, advance, on.held);
        self.covariance(on);
        let (mut by_h, is_pushed) = self.levels(advance.h, on, gradient);
        let [product, by_f, covariance] = &mut self.square;
        multiply(product, covariance, pass.sizes.n, by_f);
        scale(2.0, by_f);
        self.mass.fill(0.0);
        if is_pushed {
            self.inertia(span, on);
        }
        let has_moving_ends = advance.moved_by.iter().any(Option::is_some);
        self.sums.u.fill(0.0);
        let by = self.motion(span, on, has_moving_ends);
        by_h += by.length;
        for moved in advance.moved_by.into_iter().flatten() {
            gradient[moved.delay] += moved.length * by_h + moved.start * by.start;
        }
        self.late_inputs(gradient);
    }

    /// What delays of the inputs do between rows.
    fn late_inputs(&self, gradient: &mut [f64]) {
        let StateSpace { setup, layout, .. } = self.pass.system;
        for (index, &input) in setup.delayed.iter().enumerate() {
            gradient[layout.input_delay(index)] += self.sums.u[input];
        }
    }

    /// Derivatives of ⟨Λ, F (P + N) Fᵀ + N⟩: `FᵀΛF` for P, `Λ + FᵀΛF` for N, `2 Λ F (P + N)` for F.
    ///
    /// Leaves Λ F, the derivative for N, and P in `square`.
    fn covariance(&mut self, on: &StepTape<'_>) {
        let n = self.pass.sizes.n;
        let [product, by_noise, covariance] = &mut self.square;
        multiply(&self.p, on.f, n, product);
        by_noise.copy_from_slice(&self.p);
        transposed_multiply(on.f, product, n, &mut self.p);
        // Measurements reduce only the symmetric part; rounding in the other would grow with F.
        symmetrise(&mut self.p, n);
        add(&self.p, by_noise);
        multiply_transposed(on.root, on.root, n, covariance);
    }

    /// The levels of the disturbances of a step of length `h`; adds N to P in `square`.
    ///
    /// Returns the derivative with respect to the length, and whether any force disturbs; `forces`
    /// then holds the derivatives with respect to the columns of M⁻¹.
    fn levels(&mut self, h: f64, on: &StepTape<'_>, gradient: &mut [f64]) -> (f64, bool) {
        let pass = self.pass;
        let StateSpace {
            setup,
            plant,
            layout,
        } = pass.system;
        let (n, d) = (pass.sizes.n, pass.sizes.disturbances);
        let [_, by_noise, covariance] = &mut self.square;
        let [column, pushed] = &mut self.vector;
        self.forces.fill(0.0);
        let (mut by_h, mut is_pushed) = (0.0, false);
        if !pass.is_disturbed {
            return (by_h, is_pushed);
        }
        for (j, disturbance) in setup.disturbances.iter().enumerate() {
            let place = layout.disturbance(j);
            let level = pass.values[place];
            for i in 0..n {
                column[i] = on.columns[i * d + j];
            }
            multiply(by_noise, column, n, pushed);
            let effect = dot(column, pushed);
            gradient[place] += level * h * effect;
            by_h += 0.5 * level * level * effect;
            let half = 0.5 * h * level * level;
            for (row, &entry) in covariance.chunks_exact_mut(n).zip(column.iter()) {
                add_scaled(half * entry, column, row);
            }
            if let Disturbance::Force(_) = disturbance {
                is_pushed = true;
                for i in 0..plant.speeds {
                    self.forces[i * d + j] = level * level * h * pushed[i];
                }
            }
        }
        (by_h, is_pushed)
    }

    /// The derivative with respect to the mass matrix: δ(M⁻¹) = −M⁻¹ δM M⁻¹.
    fn inertia(&mut self, span: Span<'_>, on: &StepTape<'_>) {
        let (n, d) = (self.pass.sizes.n, self.pass.sizes.disturbances);
        let plant = self.pass.system.plant;
        let place = span.place(0, &on.stages.z[..n]);
        plant.accelerations(place, &mut self.scratch, &mut self.forces);
        let columns = &on.columns[..plant.speeds * d];
        multiply_transposed_add(&self.forces, columns, d, &mut self.mass);
        scale(-1.0, &mut self.mass);
    }

    /// From the state after a step, F and the mass matrix to the state before it.
    fn motion(&mut self, span: Span<'_>, on: &StepTape<'_>, by_ends: bool) -> ByEnds {
        self.vector[0].copy_from_slice(&self.sums.z);
        self.sums.z.fill(0.0);
        let effects = Effects {
            after: &self.vector[0],
            f: &self.square[1],
            mass: &self.mass,
            by_ends,
        };
        transition::adjoint(
            self.pass.system.plant,
            span,
            &mut self.scratch,
            &on.stages,
            effects,
            &mut self.reverse,
            &mut self.sums,
        )
    }

    /// The scalars of one moment, last one first; then their slopes, which all belong to the state
    /// before the first.
    fn measure(
        &mut self,
        samples: &[Sample],
        (held, lags): (&[f64], &[[f64; 2]]),
        tape: &mut [f64],
        gradient: &mut [f64],
    ) {
        let Some(first) = samples.first() else {
            return;
        };
        let pass = self.pass;
        let n = pass.sizes.n;
        let prior = pass.sizes.sample(&mut tape[first.tape..]).z.to_vec();
        let mut by_prior = vec![0.0; n];
        self.mu.fill(0.0);
        self.slopes.fill(0.0);
        let mut outputs = false;
        for sample in samples.iter().rev() {
            let on = pass.sizes.sample(&mut tape[sample.tape..]);
            let by_quantity = self.scalar(sample, &on, &prior, &mut by_prior, gradient);
            // `vector[0]` now holds the gradient with respect to the slope.
            let channel = sample.innovation.channel;
            let place = pass.system.layout.scale(channel);
            let gain = pass.values[place];
            gradient[pass.system.layout.bias(channel)] += by_quantity;
            gradient[place] += by_quantity * sample.quantity;
            match pass.system.setup.reads(channel) {
                Measured::State(state) => {
                    by_prior[state] += gain * by_quantity;
                    gradient[place] += self.vector[0][state];
                }
                Measured::Output(output) => {
                    outputs = true;
                    self.mu[output] += gain * by_quantity;
                    let slopes = &mut self.slopes[output * n..(output + 1) * n];
                    add_scaled(gain, &self.vector[0], slopes);
                    gradient[place] += dot(&self.vector[0], on.c) / gain;
                }
            }
        }
        add(&by_prior, &mut self.sums.z);
        if outputs {
            self.sums.u.fill(0.0);
            let states = pass.system.setup.model.info().state_len();
            let lagged = states..states + lags.len();
            for slopes in self.slopes.chunks_exact_mut(n) {
                slopes[lagged.clone()].fill(0.0);
            }
            let motion = self.sums.z[lagged.clone()].to_vec();
            let mut read = prior;
            for (own, [value, _]) in read[states..].iter_mut().zip(lags) {
                *own = *value;
            }
            let t = pass.time_of(&first.innovation);
            let place = pass.place(t, &read, held);
            let weights = [self.mu.as_slice(), &self.slopes];
            let plant = pass.system.plant;
            plant.output_adjoint(place, &mut self.scratch, weights, &mut self.sums);
            // Inputs that lag are not those of the motion.
            for ((sum, own), (lag, [_, slope])) in
                (self.sums.z[lagged].iter_mut().zip(motion)).zip(lags.iter().enumerate())
            {
                gradient[pass.system.layout.lag(lag)] += (*sum - own) * slope;
                *sum = own;
            }
            let channel = first.innovation.channel;
            if pass.system.setup.channels[channel].longest_delay.is_some() {
                let delay = pass.system.layout.sensor_delay(channel);
                gradient[delay] -= command::by_time(held, &self.sums.u, t);
            }
            for (input, by) in self.sums.u.iter_mut().enumerate() {
                *by *= -command::slope(held, input, t);
            }
            self.late_inputs(gradient);
        }
    }

    /// One update: z⁺ = z + a e/s, P⁺ = P − a aᵀ/s with a = P c, s = cᵀa + r and e = y − h − cᵀ(z −
    /// prior). Returns the derivative with respect to h and leaves that for c in `vector[0]`; of c of a state only its
    /// own entry.
    fn scalar(
        &mut self,
        sample: &Sample,
        on: &SampleTape<'_>,
        prior: &[f64],
        by_prior: &mut [f64],
        gradient: &mut [f64],
    ) -> f64 {
        let pass = self.pass;
        let n = pass.sizes.n;
        let SampleTape { c, a, z, root } = on;
        let (e, s) = (
            sample.innovation.white_residual,
            sample.innovation.white_variance,
        );
        let [by_c, by_a] = &mut self.vector;
        // Contribution to the log-likelihood: −(ln 2πs + e²/s)/2.
        let along = dot(&self.sums.z, a);
        let by_e = (along - e) / s;
        multiply(&self.p, a, n, by_a);
        let shrunk = dot(a, by_a);
        let by_s = -0.5 * (1.0 - e * e / s) / s + (shrunk - along * e) / (s * s);
        scale(-2.0 / s, by_a);
        add_scaled(e / s, &self.sums.z, by_a);
        add_scaled(by_s, c, by_a);
        // s = cᵀ a + r.
        by_c.copy_from_slice(a);
        scale(by_s, by_c);
        let noise = pass.system.layout.noise(sample.innovation.channel);
        gradient[noise] += 2.0 * pass.values[noise] * by_s;
        // a = P c with P = root rootᵀ.
        match pass.system.setup.reads(sample.innovation.channel) {
            // c has this component only, so that only this component of the derivative is needed.
            Measured::State(state) => by_c[state] += dot(a, by_a) / c[state],
            Measured::Output(_) => {
                let [projection, product, _] = &mut self.square;
                let (projection, product) = (&mut projection[..n], &mut product[..n]);
                transposed_multiply(root, by_a, n, projection);
                multiply(root, projection, n, product);
                add(product, by_c);
            }
        }
        for (i, &slope) in c.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            for (j, &by_a) in by_a.iter().enumerate() {
                self.p[i * n + j] += 0.5 * slope * by_a;
                self.p[j * n + i] += 0.5 * slope * by_a;
            }
        }
        // e = y − h − cᵀ(z − prior).
        for i in 0..n {
            by_c[i] -= by_e * (z[i] - prior[i]);
        }
        add_scaled(-by_e, c, &mut self.sums.z);
        add_scaled(by_e, c, by_prior);
        -by_e
    }
}
