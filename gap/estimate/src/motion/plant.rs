//! The model with the states that estimation adds to it: lagging inputs, lagging channels, drifting
//! parameters.
//!
//! `ż = (ẋ(t, x, u, p), (u_j − ν_j)/τ_j …, (q_k − f_k)/τ_k …, 0 …)`. The model is evaluated with `ν_j`
//! instead of the lagging input `u_j`, and with the last states instead of the drifting parameters; `q_k` is
//! the quantity measured by a lagging channel, `f_k` its reading.

use appell_runtime::model::{At, Gradient, Model, ModelInfo};
use appell_runtime::signal::{Signal, SignalError};

use super::command::{self, OfOutputs};
use super::sensors::Filter;
use crate::data::layout::Layout;
use crate::data::setup::Setup;
use crate::matrix::{add_scaled, dot, pieces};

/// Relative step of a central difference of an exact gradient with respect to a drifting parameter.
const DIFFERENCE: f64 = 1e-5;

/// The equations of all states.
pub(crate) struct Plant<'a> {
    pub(crate) model: &'a dyn Model,
    lagging: &'a [usize],
    /// Those of the lagging channels.
    pub(super) filters: Vec<Filter>,
    drifting: &'a [usize],
    /// Parameters of the run, each with its difference from the value of all runs.
    differences: &'a [(usize, f64)],
    signals: Vec<Signal>,
    /// Number of all states.
    pub(crate) n: usize,
    /// Number of inputs of the model.
    pub(crate) m: usize,
    /// Number of pseudo-velocities.
    pub(crate) speeds: usize,
}

/// Point at which the plant is evaluated.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    /// Time in s.
    pub(crate) t: f64,
    /// All states.
    pub(crate) z: &'a [f64],
    /// Declared inputs as commands.
    pub(crate) held: &'a [f64],
    /// Parameters of the model.
    pub(crate) p: &'a [f64],
    /// Time constants of the lagging inputs and channels in s.
    pub(crate) lags: &'a [f64],
}

impl<'a> Place<'a> {
    /// With the parameters and time constants of a list of values, at a time, state and commands.
    pub(crate) fn new(
        layout: Layout,
        values: &'a [f64],
        t: f64,
        z: &'a [f64],
        held: &'a [f64],
    ) -> Self {
        let lags = layout.lag(0);
        Self {
            t,
            z,
            held,
            p: &values[..layout.parameters],
            lags: &values[lags..lags + layout.lags],
        }
    }

    /// The value of a declared input.
    pub(crate) fn input(&self, input: usize) -> f64 {
        command::value(self.held, input, self.t)
    }
}

/// The state-space model of a filter: measurements and disturbances, equations of motion, and the
/// order of the values on which they depend.
#[derive(Clone, Copy)]
pub(crate) struct StateSpace<'a> {
    pub(crate) setup: &'a Setup<'a>,
    pub(crate) plant: &'a Plant<'a>,
    pub(crate) layout: Layout,
}

/// Work arrays.
#[derive(Debug, Clone)]
pub(crate) struct Scratch {
    seen: Seen,
    a: Vec<f64>,
    b: Vec<f64>,
    /// Derivatives with respect to the parameters.
    by_p: Vec<f64>,
    weights: Vec<f64>,
    gradient: Vec<f64>,
    mass: Vec<f64>,
    bias: Vec<f64>,
    forces: Vec<f64>,
    /// Outputs and their slopes, if a filter follows any.
    pub(super) outputs: Vec<f64>,
    pub(super) output_slopes: Vec<f64>,
}

/// Inputs and parameters as the model sees them.
#[derive(Debug, Clone)]
struct Seen {
    u: Vec<f64>,
    p: Vec<f64>,
}

/// Accumulated derivatives.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    /// With respect to the states.
    pub(crate) z: Vec<f64>,
    /// With respect to the parameters.
    pub(crate) p: Vec<f64>,
    /// With respect to the time constants.
    pub(crate) lags: Vec<f64>,
    /// With respect to the declared inputs.
    pub(crate) u: Vec<f64>,
}

impl Sums {
    /// Zeros.
    pub(crate) fn zeros(plant: &Plant<'_>) -> Self {
        let info = plant.info();
        Self {
            z: vec![0.0; plant.n],
            p: vec![0.0; info.parameter_len()],
            lags: vec![0.0; plant.lagging.len() + plant.filters.len()],
            u: vec![0.0; info.declared_inputs],
        }
    }
}

impl<'a> Plant<'a> {
    pub(crate) fn new(
        setup: &'a Setup<'a>,
        differences: &'a [(usize, f64)],
    ) -> Result<Self, SignalError> {
        let info = setup.model.info();
        Ok(Self {
            model: setup.model,
            lagging: &setup.lagging,
            filters: Filter::all(setup),
            drifting: &setup.drifting,
            differences,
            signals: info
                .signals
                .iter()
                .map(Signal::new)
                .collect::<Result<_, _>>()?,
            n: setup.state_len(),
            m: info.input_len(),
            speeds: info.speeds,
        })
    }

    /// The lag of an input, where it lags.
    pub(crate) fn lag_of(&self, input: usize) -> Option<usize> {
        self.lagging.iter().position(|&lagging| lagging == input)
    }

    pub(crate) fn info(&self) -> &ModelInfo {
        self.model.info()
    }

    /// Times in s at which a signal loses smoothness.
    pub(crate) fn knots(&self) -> Vec<f64> {
        self.signals
            .iter()
            .flat_map(Signal::knots)
            .copied()
            .collect()
    }

    pub(crate) fn scratch(&self) -> Scratch {
        let (n, m, s) = (self.n, self.m, self.speeds);
        let zeros = |len: usize| vec![0.0; len];
        let k = self.info().parameter_len();
        let outputs = self.filtered_outputs();
        Scratch {
            seen: Seen {
                u: zeros(m),
                p: zeros(k),
            },
            by_p: zeros(self.info().state_len() * k),
            a: zeros(n * n),
            b: zeros(n * m),
            weights: Vec::new(),
            gradient: zeros(n + m + k),
            mass: zeros(s * s),
            bias: zeros(s),
            forces: zeros(s),
            outputs: zeros(outputs),
            output_slopes: zeros(outputs * n),
        }
    }

    /// The arguments of the model.
    fn view<'s>(&self, place: Place<'s>, seen: &'s mut Seen) -> At<'s> {
        let Seen { u, p } = seen;
        let states = self.info().state_len();
        let declared = self.info().declared_inputs;
        for (input, u) in u[..declared].iter_mut().enumerate() {
            *u = place.input(input);
        }
        p.copy_from_slice(place.p);
        for (&input, &lagged) in self.lagging.iter().zip(&place.z[states..]) {
            u[input] = lagged;
        }
        for (state, parameter) in self.drifts() {
            p[parameter] = place.z[state];
        }
        for &(parameter, difference) in self.differences {
            p[parameter] += difference;
        }
        let derived = self.info().signal_inputs.iter();
        for (u, &(signal, order)) in u[declared..].iter_mut().zip(derived) {
            let signal = self.signals.get(signal);
            *u = signal.map_or(f64::NAN, |signal| signal.derivative(place.t, order));
        }
        at(place, states, u, p)
    }

    /// Adds a gradient with respect to the arguments of the model, times a factor: lagging inputs
    /// and drifting parameters are states.
    fn pass_on(&self, gradient: &mut [f64], factor: f64, sums: &mut Sums) {
        let (n, k) = (self.info().state_len(), self.info().parameter_len());
        let [x, u, p] = pieces(gradient, [n, self.m, k]);
        add_scaled(factor, x, &mut sums.z[..n]);
        for (lagged, &input) in sums.z[n..].iter_mut().zip(self.lagging) {
            *lagged += factor * std::mem::take(&mut u[input]);
        }
        for (sum, own) in sums.u.iter_mut().zip(u) {
            *sum += factor * *own;
        }
        self.pass_on_parameters(factor, p, sums);
    }

    /// Adds a gradient with respect to the parameters of the model, times a factor.
    pub(crate) fn pass_on_parameters(&self, factor: f64, p: &mut [f64], sums: &mut Sums) {
        for (state, parameter) in self.drifts() {
            sums.z[state] += factor * std::mem::take(&mut p[parameter]);
        }
        add_scaled(factor, p, &mut sums.p);
    }

    /// The rates that lags and drifting parameters add, given the outputs that filters follow.
    fn added_rates(&self, place: Place<'_>, outputs: &[f64], rates: &mut [f64]) {
        let n = self.info().state_len();
        rates[n..].fill(0.0);
        for (lag, (&input, &tau)) in self.lagging.iter().zip(place.lags).enumerate() {
            rates[n + lag] = (place.input(input) - place.z[n + lag]) / tau;
        }
        for filter in &self.filters {
            rates[filter.state] = filter.gap(place, outputs) / place.lags[filter.lag];
        }
    }

    /// The difference between the input of a lag and its state, at a point with these rates.
    pub(crate) fn gap(&self, place: Place<'_>, rates: &[f64], lag: usize) -> f64 {
        let state = self.info().state_len() + lag;
        match self.lagging.get(lag) {
            Some(&input) => place.input(input) - place.z[state],
            // From its rate, as evaluating the measured quantity again is expensive.
            None => rates[state] * place.lags[lag],
        }
    }

    /// States that are drifting parameters, with these.
    fn drifts(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let first = self.info().state_len() + self.lagging.len() + self.filters.len();
        (first..).zip(self.drifting.iter().copied())
    }

    /// Sets the arguments of the model at a point.
    pub(crate) fn at(&self, place: Place<'_>, scratch: &mut Scratch, tell: impl FnOnce(At<'_>)) {
        tell(self.view(place, &mut scratch.seen));
    }

    /// ∂ẋ/∂p of the model's own states.
    pub(crate) fn parameter_jacobian(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        slopes: &mut [f64],
    ) {
        self.at(place, scratch, |at| {
            self.model.parameter_jacobian(at, slopes);
        });
    }

    /// ż.
    pub(crate) fn rates(&self, place: Place<'_>, scratch: &mut Scratch, rates: &mut [f64]) {
        let n = self.info().state_len();
        let at = self.view(place, &mut scratch.seen);
        self.model.rates(at, &mut rates[..n]);
        if !scratch.outputs.is_empty() {
            self.model.outputs(at, &mut scratch.outputs);
        }
        self.added_rates(place, &scratch.outputs, rates);
    }

    /// ż and ∂ż/∂z.
    pub(crate) fn jacobian(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        rates: &mut [f64],
        slopes: &mut [f64],
    ) {
        let (all, n, m) = (self.n, self.info().state_len(), self.m);
        let Scratch {
            seen, a, b, by_p, ..
        } = scratch;
        let at = self.view(place, seen);
        if all == n {
            self.model.jacobians(at, rates, slopes, &mut b[..n * m]);
            return;
        }
        let (a, b) = (&mut a[..n * n], &mut b[..n * m]);
        self.model.jacobians(at, &mut rates[..n], a, b);
        if !self.drifting.is_empty() {
            self.model.parameter_jacobian(at, by_p);
        }
        slopes.fill(0.0);
        for row in 0..n {
            let to = &mut slopes[row * all..(row + 1) * all];
            to[..n].copy_from_slice(&a[row * n..(row + 1) * n]);
            for (to, &input) in to[n..].iter_mut().zip(self.lagging) {
                *to = b[row * m + input];
            }
            for (state, parameter) in self.drifts() {
                to[state] = by_p[row * at.p.len() + parameter];
            }
        }
        for (lag, &tau) in place.lags.iter().enumerate() {
            slopes[(n + lag) * (all + 1)] = -1.0 / tau;
        }
        self.filter_slopes(place, scratch, slopes);
        self.added_rates(place, &scratch.outputs, rates);
    }

    /// Adds to `sums` the gradient of ⟨λ, ż⟩ + ⟨Λ, ∂ż/∂z⟩ + ⟨K, M⟩, where M is the mass matrix.
    pub(crate) fn adjoint(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        [lambda, slopes, mass]: [&[f64]; 3],
        sums: &mut Sums,
    ) {
        let (all, n) = (self.n, self.info().state_len());
        let own = [&lambda[..n], &slopes[..n * all], mass];
        self.pull(place, scratch, own, sums, |at, weights, by| {
            self.model.adjoint(at, weights, by);
        });
        for (lag, (&input, &tau)) in self.lagging.iter().zip(place.lags).enumerate() {
            let (lambda, slope) = (lambda[n + lag], slopes[(n + lag) * (all + 1)]);
            sums.z[n + lag] -= lambda / tau;
            sums.u[input] += lambda / tau;
            let gap = place.input(input) - place.z[n + lag];
            sums.lags[lag] += (slope - lambda * gap) / (tau * tau);
        }
        self.filter_adjoint(place, scratch, [lambda, slopes], sums);
    }

    /// Adds to `sums` the gradient of ⟨μ, y⟩ + ⟨Γ, ∂y/∂z⟩ + ⟨K, M⟩ for quantities y of the model: its rates or its
    /// outputs, of which `adjoint` evaluates the adjoint.
    fn pull(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        [mu, slopes, mass]: [&[f64]; 3],
        sums: &mut Sums,
        adjoint: impl Fn(At<'_>, &[f64], Gradient<'_>),
    ) {
        let (all, n, rows) = (self.n, self.info().state_len(), mu.len());
        let Scratch {
            seen,
            weights,
            gradient,
            ..
        } = scratch;
        self.view(place, seen);
        let Seen { u, p } = seen;
        let lengths = [rows, rows * n, rows * self.m, mass.len()];
        weights.clear();
        weights.resize(lengths.iter().sum(), 0.0);
        let [values, a, b, m] = pieces(weights, lengths);
        values.copy_from_slice(mu);
        for (row, slopes) in slopes.chunks_exact(all).enumerate() {
            a[row * n..(row + 1) * n].copy_from_slice(&slopes[..n]);
            for (&weight, &input) in slopes[n..].iter().zip(self.lagging) {
                b[row * self.m + input] = weight;
            }
        }
        m.copy_from_slice(mass);
        let adjoint = |p: &[f64], weights: &[f64], gradient: &mut [f64]| {
            adjoint(at(place, n, u, p), weights, self.cut(gradient));
        };
        adjoint(p, weights, gradient);
        self.pass_on(gradient, 1.0, sums);
        // ⟨Γ, ∂y/∂p⟩ is the derivative of ⟨Γ, y⟩ with respect to a drifting parameter; the same
        // holds for the gradients.
        for (state, parameter) in self.drifts() {
            weights.fill(0.0);
            for (weight, slopes) in weights.iter_mut().zip(slopes.chunks_exact(all)) {
                *weight = slopes[state];
            }
            self.differentiated(p, parameter, gradient, sums, |p, gradient| {
                adjoint(p, weights, gradient);
            });
        }
    }

    /// Adds to `sums` the derivative of a gradient with respect to a parameter, by a central
    /// difference.
    fn differentiated(
        &self,
        p: &mut [f64],
        parameter: usize,
        gradient: &mut [f64],
        sums: &mut Sums,
        evaluate: impl Fn(&[f64], &mut [f64]),
    ) {
        let value = p[parameter];
        let h = DIFFERENCE * value.abs().max(DIFFERENCE);
        for sign in [1.0, -1.0] {
            p[parameter] = value + sign * h;
            evaluate(p, gradient);
            self.pass_on(gradient, sign / (2.0 * h), sums);
        }
        p[parameter] = value;
    }

    /// A gradient with respect to the arguments of the model, in its parts.
    fn cut<'g>(&self, gradient: &'g mut [f64]) -> Gradient<'g> {
        let (n, k) = (self.info().state_len(), self.info().parameter_len());
        let [x, u, p] = pieces(gradient, [n, self.m, k]);
        Gradient { x, u, p }
    }

    /// M⁻¹ times each column of `columns`, s × c, in place; not finite where M is singular.
    pub(crate) fn accelerations(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        columns: &mut [f64],
    ) {
        let Scratch {
            seen,
            mass,
            bias,
            forces,
            ..
        } = scratch;
        let at = self.view(place, seen);
        self.model.appell(at, mass, bias, forces);
        appell_runtime::dense::lu_solve_in_place(mass, columns, self.speeds);
    }

    /// The state to which outputs react: the mean over their time if they are means, as rates have kinks where inputs
    /// change, and x̄ = x + ẍ h²/24 where they do not.
    pub(crate) fn read_state(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        reading: &OfOutputs,
    ) -> Vec<f64> {
        let mut z = place.z.to_vec();
        let (n, m) = (self.info().state_len(), self.m);
        for (lag, [value, _]) in z[n..].iter_mut().zip(&reading.lags) {
            *lag = *value;
        }
        let Some((duration, kinks)) = reading.averaging() else {
            return z;
        };
        let Scratch { seen, a, b, .. } = scratch;
        let at = self.view(Place { z: &z, ..place }, seen);
        let (a, b) = (&mut a[..n * n], &mut b[..n * m]);
        let mut rates = vec![0.0; n];
        self.model.jacobians(at, &mut rates, a, b);
        let square = duration * duration / 24.0;
        for (state, z) in z[..n].iter_mut().enumerate() {
            let by_states = &a[state * n..(state + 1) * n];
            // A fast decay, such as that of dry friction at rest, is over before the end.
            let decay = 1.0 + by_states[state].abs() * duration / 6.0;
            *z += dot(&b[state * m..][..kinks.len()], kinks);
            *z += square * dot(by_states, &rates) / decay;
        }
        z
    }

    /// y of all outputs.
    pub(crate) fn output_values(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        outputs: &mut [f64],
    ) {
        self.at(place, scratch, |at| self.model.outputs(at, outputs));
    }

    /// y, ∂y/∂z of all outputs.
    pub(crate) fn outputs(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        outputs: &mut [f64],
        slopes: &mut [f64],
    ) {
        let (all, n, l) = (self.n, self.info().state_len(), outputs.len());
        let Scratch { seen, gradient, .. } = scratch;
        let at = self.view(place, seen);
        let (mut c, mut d) = (vec![0.0; l * n], vec![0.0; l * self.m]);
        self.model.output_jacobians(at, outputs, &mut c, &mut d);
        let mut weights = vec![0.0; l + l * n + l * self.m];
        for output in 0..l {
            let to = &mut slopes[output * all..(output + 1) * all];
            to[..n].copy_from_slice(&c[output * n..(output + 1) * n]);
            for (to, &input) in to[n..].iter_mut().zip(self.lagging) {
                *to = d[output * self.m + input];
            }
            if !self.drifting.is_empty() {
                weights.fill(0.0);
                weights[output] = 1.0;
                let by = self.cut(gradient);
                self.model.output_adjoint(at, &weights, by);
                let by = self.cut(gradient);
                for (state, parameter) in self.drifts() {
                    to[state] = by.p[parameter];
                }
            }
        }
    }

    /// Adds to `sums` the gradient of ⟨μ, y⟩ + ⟨Γ, ∂y/∂z⟩.
    pub(crate) fn output_adjoint(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        [mu, slopes]: [&[f64]; 2],
        sums: &mut Sums,
    ) {
        self.pull(
            place,
            scratch,
            [mu, slopes, &[]],
            sums,
            |at, weights, by| {
                self.model.output_adjoint(at, weights, by);
            },
        );
    }

    /// The gradient of an output, times a weight.
    pub(crate) fn output_gradient(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        output: usize,
        weight: f64,
    ) -> Sums {
        let count = self.info().output_len();
        let (mut weights, no_slopes) = (vec![0.0; count], vec![0.0; count * self.n]);
        weights[output] = weight;
        let mut sums = Sums::zeros(self);
        self.output_adjoint(place, scratch, [&weights, &no_slopes], &mut sums);
        sums
    }
}

/// The model's view: its own states, inputs and parameters as it sees them.
fn at<'a>(place: Place<'a>, states: usize, u: &'a [f64], p: &'a [f64]) -> At<'a> {
    At {
        t: place.t,
        x: &place.z[..states],
        u,
        p,
    }
}
