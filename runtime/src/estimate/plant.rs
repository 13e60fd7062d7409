//! The model with the states that estimation adds to it: lagging inputs.
//!
//! `ż = (ẋ(t, x, u, p), (u_j − ν_j)/τ_j …)`, where the model sees `ν_j` in place of the lagging `u_j`.

use crate::model::{At, Gradient, Model, ModelInfo};
use crate::signal::{Signal, SignalError};

use super::matrix::{add, pieces};
use super::setup::Setup;

/// The equations of all states.
pub(super) struct Plant<'a> {
    pub(super) model: &'a dyn Model,
    lagging: &'a [usize],
    signals: Vec<Signal>,
    /// Number of all states.
    pub(super) n: usize,
    /// Number of inputs of the model.
    pub(super) m: usize,
    /// Number of pseudo-velocities.
    pub(super) speeds: usize,
}

/// Where the plant is evaluated.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// Time in s.
    pub(super) t: f64,
    /// All states.
    pub(super) z: &'a [f64],
    /// Declared inputs as they are held.
    pub(super) held: &'a [f64],
    /// Parameters of the model.
    pub(super) p: &'a [f64],
    /// Time constants of the lagging inputs in s.
    pub(super) lags: &'a [f64],
}

/// Numbers on the way, so that nothing is allocated per step.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    u: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    weights: Vec<f64>,
    gradient: Vec<f64>,
    mass: Vec<f64>,
    bias: Vec<f64>,
    forces: Vec<f64>,
}

/// Derivatives that are being summed up.
pub(super) struct Sums<'a> {
    /// By the states.
    pub(super) z: &'a mut [f64],
    /// By the parameters.
    pub(super) p: &'a mut [f64],
    /// By the time constants.
    pub(super) lags: &'a mut [f64],
}

impl<'a> Plant<'a> {
    pub(super) fn new(setup: &'a Setup<'a>) -> Result<Self, SignalError> {
        let info = setup.model.info();
        Ok(Self {
            model: setup.model,
            lagging: &setup.lagging,
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

    pub(super) fn info(&self) -> &ModelInfo {
        self.model.info()
    }

    /// Times in s at which a signal loses smoothness.
    pub(super) fn knots(&self) -> Vec<f64> {
        self.signals
            .iter()
            .flat_map(Signal::knots)
            .copied()
            .collect()
    }

    pub(super) fn scratch(&self) -> Scratch {
        let (n, m, s) = (self.n, self.m, self.speeds);
        let zeros = |len| vec![0.0; len];
        Scratch {
            u: zeros(m),
            a: zeros(n * n),
            b: zeros(n * m),
            weights: zeros(n + n * n + n * m + s * s),
            gradient: zeros(n + m + self.info().parameter_len()),
            mass: zeros(s * s),
            bias: zeros(s),
            forces: zeros(s),
        }
    }

    /// What the model sees as its inputs.
    fn inputs(&self, place: Place<'_>, u: &mut [f64]) {
        let states = self.info().state_len();
        u[..place.held.len()].copy_from_slice(place.held);
        for (&input, &lagged) in self.lagging.iter().zip(&place.z[states..]) {
            u[input] = lagged;
        }
        let derived = self.info().signal_inputs.iter();
        for (u, &(signal, order)) in u[place.held.len()..].iter_mut().zip(derived) {
            let signal = self.signals.get(signal);
            *u = signal.map_or(f64::NAN, |signal| signal.derivative(place.t, order));
        }
    }

    /// ż.
    pub(super) fn rates(&self, place: Place<'_>, scratch: &mut Scratch, rates: &mut [f64]) {
        let n = self.info().state_len();
        self.inputs(place, &mut scratch.u);
        self.model.rates(at(place, n, &scratch.u), &mut rates[..n]);
        for (lag, (&input, &tau)) in self.lagging.iter().zip(place.lags).enumerate() {
            rates[n + lag] = (place.held[input] - place.z[n + lag]) / tau;
        }
    }

    /// ż and ∂ż/∂z.
    pub(super) fn jacobian(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        rates: &mut [f64],
        slopes: &mut [f64],
    ) {
        let (all, n) = (self.n, self.info().state_len());
        let Scratch { u, a, b, .. } = scratch;
        self.inputs(place, u);
        let at = at(place, n, u);
        if all == n {
            self.model
                .jacobians(at, rates, slopes, &mut b[..n * self.m]);
            return;
        }
        let (a, b) = (&mut a[..n * n], &mut b[..n * self.m]);
        self.model.jacobians(at, &mut rates[..n], a, b);
        slopes.fill(0.0);
        for (row, (a, b)) in a.chunks_exact(n).zip(b.chunks_exact(self.m)).enumerate() {
            let to = &mut slopes[row * all..(row + 1) * all];
            to[..n].copy_from_slice(a);
            for (to, &input) in to[n..].iter_mut().zip(self.lagging) {
                *to = b[input];
            }
        }
        for (lag, (&input, &tau)) in self.lagging.iter().zip(place.lags).enumerate() {
            rates[n + lag] = (place.held[input] - place.z[n + lag]) / tau;
            slopes[(n + lag) * (all + 1)] = -1.0 / tau;
        }
    }

    /// Adds to `sums` the gradient of ⟨λ, ż⟩ + ⟨Λ, ∂ż/∂z⟩ + ⟨K, M⟩, where M is the mass matrix.
    pub(super) fn adjoint(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        [lambda, slopes, mass]: [&[f64]; 3],
        sums: &mut Sums<'_>,
    ) {
        let (all, n, s) = (self.n, self.info().state_len(), self.speeds);
        let Scratch {
            u,
            weights,
            gradient,
            ..
        } = scratch;
        self.inputs(place, u);
        let at = at(place, n, u);
        let [rates, a, b, m] = pieces(weights, [n, n * n, n * self.m, s * s]);
        rates.copy_from_slice(&lambda[..n]);
        for (row, slopes) in slopes.chunks_exact(all).take(n).enumerate() {
            a[row * n..(row + 1) * n].copy_from_slice(&slopes[..n]);
            for (&weight, &input) in slopes[n..].iter().zip(self.lagging) {
                b[row * self.m + input] = weight;
            }
        }
        m.copy_from_slice(mass);
        let used = n + n * n + n * self.m + s * s;
        let [x, by_u, p] = pieces(gradient, [n, self.m, at.p.len()]);
        let by = Gradient { x, u: by_u, p };
        self.model.adjoint(at, &weights[..used], by);
        let [x, by_u, p] = pieces(gradient, [n, self.m, at.p.len()]);
        add(x, &mut sums.z[..n]);
        add(p, sums.p);
        for (lag, (&input, &tau)) in self.lagging.iter().zip(place.lags).enumerate() {
            let (lambda, slope) = (lambda[n + lag], slopes[(n + lag) * (all + 1)]);
            sums.z[n + lag] += by_u[input] - lambda / tau;
            let gap = place.held[input] - place.z[n + lag];
            sums.lags[lag] += (slope - lambda * gap) / (tau * tau);
        }
    }

    /// M⁻¹ times each column of `columns`, s × c, in place; not finite where M is singular.
    pub(super) fn accelerations(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        columns: &mut [f64],
    ) {
        let n = self.info().state_len();
        let Scratch {
            u,
            mass,
            bias,
            forces,
            ..
        } = scratch;
        self.inputs(place, u);
        self.model.appell(at(place, n, u), mass, bias, forces);
        crate::dense::lu_solve_in_place(mass, columns, self.speeds);
    }

    /// y of all outputs.
    pub(super) fn output_values(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        outputs: &mut [f64],
    ) {
        self.inputs(place, &mut scratch.u);
        let at = at(place, self.info().state_len(), &scratch.u);
        self.model.outputs(at, outputs);
    }

    /// y, ∂y/∂z of all outputs.
    pub(super) fn outputs(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        outputs: &mut [f64],
        slopes: &mut [f64],
    ) {
        let (all, n, l) = (self.n, self.info().state_len(), outputs.len());
        self.inputs(place, &mut scratch.u);
        let (mut c, mut d) = (vec![0.0; l * n], vec![0.0; l * self.m]);
        self.model
            .output_jacobians(at(place, n, &scratch.u), outputs, &mut c, &mut d);
        for output in 0..l {
            let to = &mut slopes[output * all..(output + 1) * all];
            to[..n].copy_from_slice(&c[output * n..(output + 1) * n]);
            for (to, &input) in to[n..].iter_mut().zip(self.lagging) {
                *to = d[output * self.m + input];
            }
        }
    }

    /// Adds to `sums` the gradient of ⟨μ, y⟩ + ⟨Γ, ∂y/∂z⟩.
    pub(super) fn output_adjoint(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        [mu, slopes]: [&[f64]; 2],
        sums: &mut Sums<'_>,
    ) {
        let (all, n, l) = (self.n, self.info().state_len(), mu.len());
        let Scratch { u, gradient, .. } = scratch;
        self.inputs(place, u);
        let at = at(place, n, u);
        let mut weights = vec![0.0; l + l * n + l * self.m];
        let [outputs, c, d] = pieces(&mut weights, [l, l * n, l * self.m]);
        outputs.copy_from_slice(mu);
        for (output, slopes) in slopes.chunks_exact(all).enumerate() {
            c[output * n..(output + 1) * n].copy_from_slice(&slopes[..n]);
            for (&weight, &input) in slopes[n..].iter().zip(self.lagging) {
                d[output * self.m + input] = weight;
            }
        }
        let [x, by_u, p] = pieces(gradient, [n, self.m, at.p.len()]);
        let by = Gradient { x, u: by_u, p };
        self.model.output_adjoint(at, &weights, by);
        let [x, by_u, p] = pieces(gradient, [n, self.m, at.p.len()]);
        add(x, &mut sums.z[..n]);
        add(p, sums.p);
        for (lag, &input) in self.lagging.iter().enumerate() {
            sums.z[n + lag] += by_u[input];
        }
    }
}

/// The model's view: its own states, and inputs as it sees them.
fn at<'a>(place: Place<'a>, states: usize, u: &'a [f64]) -> At<'a> {
    At {
        t: place.t,
        x: &place.z[..states],
        u,
        p: place.p,
    }
}
