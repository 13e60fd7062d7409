//! A mass coupled to a coordinate by a spring and a damper, reported as its apparent mass over the frequency.

use std::f64::consts::TAU;

use super::{Course, Point};

/// Number of frequencies at which the apparent mass is reported.
const PLACES: usize = 81;
/// Range of these frequencies relative to the natural frequency.
const RANGE: [f64; 2] = [0.25, 4.0];
/// Relative step of finite differences.
const STEP: f64 = 1e-4;

/// The law of a mass behind a coordinate with a force of this unit: mass, natural frequency and damping ratio are `values`.
pub(super) fn course(force_unit: &str, coordinate: &str, values: &[f64]) -> Course {
    let point = |place: usize| {
        let part = place as f64 / (PLACES - 1) as f64;
        let rate = values[1] * RANGE[0] * (RANGE[1] / RANGE[0]).powf(part);
        let slope = |number: usize| {
            let step = STEP * values[number].abs().max(f64::MIN_POSITIVE);
            let [low, high] = [-step, step].map(|step| {
                let mut values = values.to_vec();
                values[number] += step;
                apparent(&values, rate)
            });
            (high - low) / (2.0 * step)
        };
        Point {
            variable: rate / TAU,
            force: apparent(values, rate),
            slopes: (0..values.len()).map(slope).collect(),
        }
    };
    Course {
        unit: match force_unit {
            "N" => "kg".to_owned(),
            "N m" => "kg m^2".to_owned(),
            other => format!("{other} s^2"),
        },
        variable: "frequency".to_owned(),
        variable_unit: "Hz".to_owned(),
        factor: Some(format!("acceleration of {coordinate}")),
        points: (0..PLACES).map(point).collect(),
    }
}

/// Magnitude of the difference between the apparent mass and a rigidly attached one, at an angular frequency; from mass,
/// natural frequency and damping ratio.
fn apparent(values: &[f64], rate: f64) -> f64 {
    let ratio = rate / values[1];
    let stiff = 1.0 - ratio * ratio;
    values[0] * ratio * ratio / stiff.hypot(2.0 * values[2] * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_that_swings_is_fixed_when_slow_and_gone_when_fast() {
        let values = [2.0, 6.0, 0.05];
        assert!(apparent(&values, 0.06) < 1e-3);
        assert!((apparent(&values, 6.0) - 20.0).abs() < 1e-9);
        // At high frequency the hidden mass, which the spec includes, does not move.
        assert!((apparent(&values, 600.0) - 2.0).abs() < 1e-3);
    }
}
