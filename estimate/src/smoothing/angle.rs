//! Angles counted on through whole turns.

use std::f64::consts::{PI, TAU};

/// Adds whole turns so that no step between neighbours is longer than half a turn; returns how many
/// steps were.
///
/// Missing values, NaN, are passed over. A sensor that really turns by more than half a turn between
/// two samples cannot be told from one that starts anew.
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
