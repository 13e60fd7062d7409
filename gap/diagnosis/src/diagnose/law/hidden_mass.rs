//! A mass coupled to a coordinate by a spring and a damper, reported as its apparent mass over the frequency.

use std::f64::consts::TAU;

use super::super::bench::Bench;
use super::super::evidence::Fitted;
use super::super::localise::force_unit;
use super::super::report::Law;
use super::super::unknown::Unnamed;
use super::deviation::Deviation;

/// Number of frequencies at which the apparent mass is reported.
const PLACES: usize = 81;
/// Range of these frequencies relative to the natural frequency.
const RANGE: [f64; 2] = [0.25, 4.0];
/// Relative step of finite differences.
const STEP: f64 = 1e-4;

/// The law with its band.
pub(super) fn law(
    main: &Bench<'_>,
    law: &Unnamed,
    coordinate: &str,
    fitted: &Fitted,
    places: &[usize],
) -> Law {
    let values: Vec<f64> = (places.iter())
        .map(|&place| fitted.fit.values[place])
        .collect();
    let deviation = Deviation::of(fitted, places);
    let point = |place: usize| {
        let part = place as f64 / (PLACES - 1) as f64;
        let rate = values[1] * RANGE[0] * (RANGE[1] / RANGE[0]).powf(part);
        let slope = |number: usize| {
            let step = STEP * values[number].abs().max(f64::MIN_POSITIVE);
            let [low, high] = [-step, step].map(|step| {
                let mut values = values.clone();
                values[number] += step;
                apparent(&values, rate)
            });
            (high - low) / (2.0 * step)
        };
        let slopes: Vec<f64> = (0..values.len()).map(slope).collect();
        [
            rate / TAU,
            apparent(&values, rate),
            deviation.along(&slopes),
        ]
    };
    Law {
        equation: main.effects.info().states[law.place].name.to_string(),
        unit: match force_unit(&main.effects.mechanism, law.place).as_str() {
            "N" => "kg".to_owned(),
            "N m" => "kg m^2".to_owned(),
            other => format!("{other} s^2"),
        },
        depends_on: law.variable.clone(),
        variable: "frequency".to_owned(),
        variable_unit: "Hz".to_owned(),
        factor: Some(format!("acceleration of {coordinate}")),
        curve: (0..PLACES).map(point).collect(),
        log_bayes_factor: law.log_bayes_factor,
        forms: Vec::new(),
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
