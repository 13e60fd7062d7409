//! Lagging channels: the filters `ḟ = (q − f)/τ` of the quantities q that they measure.

use std::mem::take;

use super::plant::{Place, Plant, Scratch, Sums};
use crate::data::setup::{Measured, Setup};
use crate::matrix::{add_scaled, dot};

/// The filter of a lagging channel.
pub(super) struct Filter {
    /// Index of its time constant.
    pub(super) lag: usize,
    /// Its state f.
    pub(super) state: usize,
    /// The measured quantity.
    follows: Measured,
}

impl Filter {
    /// Those of a setup.
    pub(super) fn all(setup: &Setup<'_>) -> Vec<Self> {
        let states = setup.model.info().state_len();
        let channels = setup.lagging_channels();
        let of = |(lag, channel): (usize, usize)| Self {
            lag,
            state: states + lag,
            follows: setup.channels[channel].measures,
        };
        (setup.lagging.len()..).zip(channels).map(of).collect()
    }

    /// q − f, given the outputs.
    pub(super) fn gap(&self, place: Place<'_>, outputs: &[f64]) -> f64 {
        let quantity = match self.follows {
            Measured::State(state) => place.z[state],
            Measured::Output(output) => outputs[output],
        };
        quantity - place.z[self.state]
    }

    fn output(&self) -> Option<usize> {
        match self.follows {
            Measured::State(_) => None,
            Measured::Output(output) => Some(output),
        }
    }
}

impl Plant<'_> {
    /// Number of outputs to evaluate for the filters: all, or none if no filter follows any.
    pub(super) fn filtered_outputs(&self) -> usize {
        let follows_output = self.filters.iter().any(|filter| filter.output().is_some());
        usize::from(follows_output) * self.info().output_len()
    }

    /// Evaluates the outputs that filters follow, with their slopes.
    fn linearise_filtered(&self, place: Place<'_>, scratch: &mut Scratch) {
        if scratch.outputs.is_empty() {
            return;
        }
        let (mut outputs, mut slopes) =
            (take(&mut scratch.outputs), take(&mut scratch.output_slopes));
        self.outputs(place, scratch, &mut outputs, &mut slopes);
        (scratch.outputs, scratch.output_slopes) = (outputs, slopes);
    }

    /// Adds ∂q/∂z / τ to the rows of the filters; leaves the outputs in `scratch`.
    pub(super) fn filter_slopes(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        slopes: &mut [f64],
    ) {
        self.linearise_filtered(place, scratch);
        let n = self.n;
        for filter in &self.filters {
            let row = &mut slopes[filter.state * n..(filter.state + 1) * n];
            let rate = 1.0 / place.lags[filter.lag];
            match filter.follows {
                Measured::State(state) => row[state] += rate,
                Measured::Output(output) => {
                    let by_output = &scratch.output_slopes[output * n..(output + 1) * n];
                    add_scaled(rate, by_output, row);
                }
            }
        }
    }

    /// Adds to `sums` the gradient of ⟨λ, ż⟩ + ⟨Λ, ∂ż/∂z⟩ over the filters.
    pub(super) fn filter_adjoint(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        [lambda, slopes]: [&[f64]; 2],
        sums: &mut Sums,
    ) {
        self.linearise_filtered(place, scratch);
        let (n, l) = (self.n, scratch.outputs.len());
        let (mut mu, mut by_slopes) = (vec![0.0; l], vec![0.0; l * n]);
        for filter in &self.filters {
            let (state, tau) = (filter.state, place.lags[filter.lag]);
            let (lambda, row) = (lambda[state], &slopes[state * n..(state + 1) * n]);
            let along = match filter.follows {
                Measured::State(followed) => {
                    sums.z[followed] += lambda / tau;
                    row[followed]
                }
                Measured::Output(output) => {
                    let part = output * n..(output + 1) * n;
                    mu[output] += lambda / tau;
                    add_scaled(1.0 / tau, row, &mut by_slopes[part.clone()]);
                    dot(row, &scratch.output_slopes[part])
                }
            };
            sums.z[state] -= lambda / tau;
            let gap = filter.gap(place, &scratch.outputs);
            sums.lags[filter.lag] += (row[state] - along - lambda * gap) / (tau * tau);
        }
        if l > 0 {
            self.output_adjoint(place, scratch, [&mu, &by_slopes], sums);
        }
    }

    /// Direct derivatives of the rates of filters with respect to the parameters, each with its state;
    /// a state does not depend on them.
    pub(crate) fn filters_by_parameters(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
    ) -> Vec<(usize, Vec<f64>)> {
        let mut rows = Vec::new();
        for filter in &self.filters {
            if let Some(output) = filter.output() {
                let rate = 1.0 / place.lags[filter.lag];
                let gradient = self.output_gradient(place, scratch, output, rate);
                rows.push((filter.state, gradient.p));
            }
        }
        rows
    }

    /// Direct derivatives of the rates of filters with respect to an input of the model, each with
    /// its state.
    pub(crate) fn filters_by_input(
        &self,
        place: Place<'_>,
        scratch: &mut Scratch,
        input: usize,
    ) -> Vec<(usize, f64)> {
        let (n, m, l) = (self.info().state_len(), self.m, self.filtered_outputs());
        let (mut outputs, mut by_states) = (vec![0.0; l], vec![0.0; l * n]);
        let mut by_inputs = vec![0.0; l * m];
        if l > 0 {
            self.at(place, scratch, |at| {
                let slopes = (&mut by_states, &mut by_inputs);
                self.model
                    .output_jacobians(at, &mut outputs, slopes.0, slopes.1);
            });
        }
        let slope = |filter: &Filter| {
            let by_input = by_inputs[filter.output()? * m + input];
            Some((filter.state, by_input / place.lags[filter.lag]))
        };
        self.filters.iter().filter_map(slope).collect()
    }
}
