//! Unwrapped angles.

use std::f64::consts::{PI, TAU};

/// Adds whole turns so that no step between neighbours exceeds half a turn; returns the number of
/// corrected steps.
///
/// Missing values (NaN) are skipped. True steps of more than half a turn cannot be distinguished
/// from wrapping.
pub fn unwrap(angles: &mut [f64]) -> usize {
    let mut steps = 0;
    let mut turns = 0.0;
    let mut last = f64::NAN;
    for angle in angles.iter_mut().filter(|angle| angle.is_finite()) {
        let step = *angle - last;
        if step.abs() > PI {
            turns -= (step / TAU).round();
            steps += 1;
        }
        last = *angle;
        *angle += turns * TAU;
    }
    steps
}
