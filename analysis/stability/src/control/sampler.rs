//! Sampled feedback in a simulation: inputs that depend on past measurements.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};

use super::sampled::Sampling;
use appell_runtime::inputs::InputSource;

/// The inputs that a controller commanded in one simulation from t = 0 on. The integrator stops at
/// each switching time and evaluates the inputs there before it continues: that evaluation is the
/// measurement.
#[derive(Debug, Clone)]
pub struct Sampler {
    sampling: Sampling,
    until: f64,
    commands: RefCell<Vec<Vec<f64>>>,
}

impl Sampler {
    /// Before the first measurement; the simulation ends at `until` in s.
    pub fn new(sampling: Sampling, until: f64) -> Self {
        Self {
            sampling,
            until,
            commands: RefCell::default(),
        }
    }

    /// The input that acts at `t`; none before the first measurement acts. `measure` returns the
    /// command for the present state from the pending commands, oldest first.
    pub fn acting(&self, t: f64, measure: impl Fn(&[Vec<f64>]) -> Vec<f64>) -> Option<Vec<f64>> {
        let Sampler { sampling, .. } = *self;
        let mut commands = self.commands.borrow_mut();
        while commands.len() < times_until(sampling.period(), 0.0, t) {
            let pending = commands.len().saturating_sub(sampling.pending());
            let command = measure(&commands[pending..]);
            commands.push(command);
        }
        let acting = times_until(sampling.period(), sampling.delay(), t).checked_sub(1)?;
        commands.get(acting).cloned()
    }

    /// Times in s at which the controller measures and acts.
    pub fn switching_times(&self) -> Vec<f64> {
        let [period, delay] = [self.sampling.period(), self.sampling.delay()];
        (0..times_until(period, 0.0, self.until))
            .flat_map(|k| [k as f64 * period, k as f64 * period + delay])
            .collect()
    }
}

/// Sampled feedback of states. `desired` writes `y_des` at a time in s.
#[derive(Debug, Clone)]
pub struct SampledFeedback<D> {
    /// The inputs, by their index in the model; the others stay zero.
    pub inputs: Vec<usize>,
    /// The states y, by their index in the model.
    pub states: Vec<usize>,
    /// K, a row for each input, a column for each state and then for each pending input.
    pub gain: DMatrix<f64>,
    /// u₀, a number for each input; it acts from the start.
    pub offset: Vec<f64>,
    /// `y_des(t)`.
    pub desired: D,
    /// Its timing.
    pub sampler: Sampler,
}

impl<D: Fn(f64, &mut [f64])> InputSource for SampledFeedback<D> {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        let acting = self.sampler.acting(t, |pending| {
            let n = self.states.len();
            let mut y = DVector::zeros(self.gain.ncols());
            (self.desired)(t, &mut y.as_mut_slice()[..n]);
            for (y, &state) in y.iter_mut().zip(&self.states) {
                *y = x[state] - *y;
            }
            // Before the first measurements nothing is pending.
            let pending = pending.concat();
            let first = y.len() - pending.len();
            y.rows_mut(first, pending.len()).copy_from_slice(&pending);
            (-(&self.gain * y)).as_slice().to_vec()
        });
        u.fill(0.0);
        for (row, &input) in self.inputs.iter().enumerate() {
            u[input] = self.offset[row] + acting.as_ref().map_or(0.0, |acting| acting[row]);
        }
    }

    fn switching_times(&self) -> Vec<f64> {
        self.sampler.switching_times()
    }
}

/// How many of the times `first`, `first + period`, … are not after `t`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a count; values out of range saturate"
)]
fn times_until(period: f64, first: f64, t: f64) -> usize {
    let mut count = ((t - first) / period).floor().max(0.0) as usize;
    // The quotient is rounded; the times are exactly those at which the integrator stops.
    while count as f64 * period + first <= t {
        count += 1;
    }
    while count > 0 && (count - 1) as f64 * period + first > t {
        count -= 1;
    }
    count
}
