//! Laws with a hidden state: a mass coupled to a coordinate by a spring and a damper, reported as its apparent mass over the
//! frequency, and a force with hysteresis, over the travel since the last reversal.

use std::f64::consts::TAU;

use super::super::{Bench, Law};

/// Number of points at which a law is reported.
const PLACES: usize = 81;
/// Range of these frequencies relative to the natural frequency.
const RANGE: [f64; 2] = [0.25, 4.0];
/// Relative step of finite differences.
const STEP: f64 = 1e-4;
/// Range of the travel since the reversal, in presliding displacements.
const REACH: f64 = 5.0;

/// The course of the law of a mass behind a coordinate with a force of this unit: mass, natural frequency and damping ratio
/// are `values`. `deviation` is that of the force, from its derivatives by these.
pub(super) fn of_hidden_mass(
    force_unit: &str,
    coordinate: &str,
    values: &[f64],
    deviation: impl Fn(&[f64]) -> f64,
) -> Law {
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
        let slopes: Vec<f64> = (0..values.len()).map(slope).collect();
        let deviation = deviation(&slopes);
        [rate / TAU, apparent(values, rate), deviation]
    };
    Law {
        unit: match force_unit {
            "N" => "kg".to_owned(),
            "N m" => "kg m^2".to_owned(),
            other => format!("{other} s^2"),
        },
        variable: "frequency".to_owned(),
        variable_unit: "Hz".to_owned(),
        factor: Some(format!("acceleration of {coordinate}")),
        curve: (0..PLACES).map(point).collect(),
        ..Law::default()
    }
}

/// Magnitude of the difference between the apparent mass and a rigidly attached one, at an angular frequency; from mass,
/// natural frequency and damping ratio.
fn apparent(values: &[f64], rate: f64) -> f64 {
    let ratio = rate / values[1];
    let stiff = 1.0 - ratio * ratio;
    values[0] * ratio * ratio / stiff.hypot(2.0 * values[2] * ratio)
}

/// The force against a motion that reversed after a long travel in the other direction; its largest size and the presliding
/// displacement are `values`.
pub(super) fn of_hysteresis(
    main: &Bench<'_>,
    unit: String,
    coordinate: &str,
    values: &[f64],
    deviation: impl Fn(&[f64]) -> f64,
) -> Law {
    let (force, way) = (values[0], values[1]);
    let mut states = main.effects.info().states.iter();
    let state = states.find(|state| state.name == coordinate);
    let (variable_unit, scale) =
        state.map_or(("", 1.0), |state| (state.unit.as_ref(), state.scale));
    let point = |place: usize| {
        let x = REACH * way * place as f64 / (PLACES - 1) as f64;
        let left = (-x / way).exp();
        let slopes = [2.0 * left - 1.0, 2.0 * force * left * x / (way * way)];
        let force = force * (2.0 * left - 1.0);
        [x / scale, force, deviation(&slopes)]
    };
    Law {
        unit,
        variable: format!("{coordinate} since it turned"),
        variable_unit: variable_unit.to_owned(),
        curve: (0..PLACES).map(point).collect(),
        ..Law::default()
    }
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
