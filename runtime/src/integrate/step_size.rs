//! Step-size control.

// Only inlined functions are compiled for the vector instructions of the processor.
#![allow(clippy::inline_always)]

use crate::elementary::powf;
use crate::lanes::dispatch;

/// Constants of the proportional-integral control (Hairer and Wanner, *Solving Ordinary
/// Differential Equations II*, section IV.2; Hairer, Nørsett and Wanner, section II.4).
#[derive(Debug, Clone, Copy)]
pub struct Control {
    /// Exponent of the error without the integral part: 1 / (order of the error estimate).
    pub exponent: f64,
    /// β, the exponent of the previous error.
    pub integral_gain: f64,
    /// Fraction of β subtracted from the exponent.
    pub integral_correction: f64,
    /// Safety factor.
    pub safety: f64,
    /// Bounds on the ratio of successive steps.
    pub smallest_factor: f64,
    /// See `smallest_factor`.
    pub largest_factor: f64,
}

/// Factor on a step whose rates were not finite.
const FACTOR_NOT_FINITE: f64 = 0.25;

/// The controller with the error of the previous step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepSize {
    control: Control,
    previous_error: f64,
    after_rejection: bool,
}

impl StepSize {
    pub(super) fn new(control: Control) -> Self {
        Self {
            control,
            previous_error: 1e-4,
            after_rejection: false,
        }
    }

    /// Factor on the step after it was accepted with `error` ≤ 1, whose power is given by [`powers`].
    pub(super) fn accepted(&mut self, error: f64, power: f64) -> f64 {
        let c = &self.control;
        let correction = if c.integral_gain == 0.0 {
            1.0
        } else {
            power_of_all(&[self.previous_error], c.integral_gain)[0]
        };
        let factor = c.safety * correction / power;
        let largest = if self.after_rejection {
            1.0
        } else {
            c.largest_factor
        };
        self.previous_error = error.max(1e-4);
        self.after_rejection = false;
        factor.clamp(c.smallest_factor, largest)
    }

    /// Factor on the step after it was rejected with `error` > 1 or NaN.
    pub(super) fn rejected(&mut self, error: f64, power: f64) -> f64 {
        let c = &self.control;
        self.after_rejection = true;
        if !error.is_finite() {
            return FACTOR_NOT_FINITE;
        }
        (c.safety / power).clamp(c.smallest_factor, 1.0)
    }
}

/// Errors raised to the exponent of the controller.
pub(super) fn powers<const N: usize>(control: Control, errors: &[f64; N]) -> [f64; N] {
    let exponent = control.exponent - control.integral_gain * control.integral_correction;
    power_of_all(errors, exponent)
}

/// Powers of several numbers, bit for bit the same for any count and on every machine.
fn power_of_all<const N: usize>(numbers: &[f64; N], exponent: f64) -> [f64; N] {
    let mut powers = [0.0; N];
    dispatch(
        #[inline(always)]
        || {
            let (numbers, mut all) = (*numbers, [0.0; N]);
            for lane in 0..N {
                all[lane] = powf(numbers[lane], exponent);
            }
            powers = all;
        },
    );
    powers
}

/// The step after a rejected one, and an upper bound on it. If the rejected step started at a stop, the history
/// before it no longer applies and the next step is estimated anew.
pub(super) fn next_after_rejection(from_stop: bool, shorter: f64) -> (Option<f64>, f64) {
    if from_stop {
        (None, shorter)
    } else {
        (Some(shorter), f64::INFINITY)
    }
}

/// Root mean square of `values` over `scale`.
pub(super) fn norm(values: impl Iterator<Item = f64>, scale: &[f64]) -> f64 {
    let sum: f64 = values
        .zip(scale)
        .map(|(value, scale)| (value / scale).powi(2))
        .sum();
    (sum / scale.len().max(1) as f64).sqrt()
}

/// A first guess of the step from the sizes of x and ẋ (Hairer, Nørsett and Wanner, section II.4,
/// *Starting step size*, steps a and b).
pub(super) fn first_guess(x_norm: f64, rates_norm: f64) -> f64 {
    let too_small = 1e-5;
    if x_norm < too_small || rates_norm < too_small {
        1e-6
    } else {
        0.01 * x_norm / rates_norm
    }
}

/// The first step from the guess, the size of ẋ and an estimate of ẍ (steps d to f).
pub(super) fn first_step(guess: f64, rates_norm: f64, second_norm: f64, order: f64) -> f64 {
    let largest = rates_norm.max(second_norm);
    let step = if !second_norm.is_finite() {
        1e-3 * guess
    } else if largest <= 1e-15 {
        f64::max(1e-6, 1e-3 * guess)
    } else {
        (0.01 / largest).powf(1.0 / order)
    };
    step.min(100.0 * guess)
}
