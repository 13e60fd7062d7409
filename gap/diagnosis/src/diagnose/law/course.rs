//! Loads of laws of a variable, with a term for each harmonic, and the courses of laws: over their variable, the apparent
//! mass of a mass coupled to a coordinate by a spring and a damper over the frequency, and hysteresis over the travel
//! since the last reversal.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::super::localise::force_unit;
use super::super::unknown::{Dependence, Series, Unnamed};
use super::super::{Bench, Law};
use crate::effects::Candidate;

/// Number of points at which the law is reported: at least, and for each half of its shortest period.
const PLACES: [usize; 2] = [81, 10];
/// Prior standard deviation of the frequency of a single harmonic, relative to the spacing of the grid.
const APART: f64 = 0.5;
/// Number of points at which a law is reported.
const POINTS: usize = 81;
/// Range of these frequencies relative to the natural frequency.
const RANGE: [f64; 2] = [0.25, 4.0];
/// Relative step of finite differences.
const STEP: f64 = 1e-4;
/// Range of the travel since the reversal, in presliding displacements.
const REACH: f64 = 5.0;

/// The load. The frequency of a single harmonic is fitted too.
pub(super) fn candidate(
    bench: &Bench<'_>,
    dependence: Dependence<'_>,
    law: &Unnamed,
    alone: Option<usize>,
    series: &Series,
) -> Option<Candidate> {
    let written = dependence.written(bench)?;
    let mut unit = force_unit(&bench.effects.mechanism, law.place).replace(' ', "*");
    if let Some(of_factor) = &written.factor_unit {
        unit = format!("{unit}/({of_factor})");
    }
    let (mut force, mut numbers) = (String::new(), Vec::new());
    for (wave, _, deviation) in &series.terms {
        let rate = match alone {
            Some(_) => "{law}_rate".to_owned(),
            None => format!("{:.9e}", dependence.rate(*wave)),
        };
        for function in ["sin", "cos"] {
            let plus = if force.is_empty() { "" } else { " + " };
            let number = numbers.len() + 1;
            numbers.push((number.to_string(), unit.clone(), [0.0, *deviation]));
            // Writing to a string cannot fail.
            let _ = write!(
                force,
                "{plus}{{law}}_{number}*{function}({rate}*{})",
                written.variable
            );
        }
    }
    if let Some(wave) = alone {
        let known = [dependence.rate(wave), APART * dependence.rate(0)];
        numbers.push(("rate".to_owned(), "1".to_owned(), known));
    }
    if let Some(factor) = &written.factor {
        force = format!("({force})*{factor}");
    }
    let info = bench.effects.info();
    let speed = info.states[law.place].name.as_ref();
    let mechanism = &bench.effects.mechanism;
    Some(Candidate::measured(mechanism, speed, &force, &numbers))
}

/// The course of the law, whose coefficients are `values`. `deviation` is that of the force, from its derivatives by
/// these.
pub(super) fn of_waves(
    main: &Bench<'_>,
    force_unit: String,
    dependence: Dependence<'_>,
    series: &Series,
    values: &[f64],
    deviation: impl Fn(&[f64]) -> f64,
) -> Law {
    let (variable, variable_unit, scale) = dependence.letters(main);
    let written = dependence.written(main);
    let (low, high) = dependence.range;
    let shortest = series.terms.iter().map(|(wave, ..)| wave + 1).max();
    let points = PLACES[0].max(PLACES[1] * shortest.unwrap_or(1));
    // After the amplitudes.
    let rate = values.get(2 * series.terms.len()).copied();
    let point = |place: usize| {
        let x = low + (high - low) * place as f64 / (points - 1) as f64;
        let waves = series.terms.iter().flat_map(|(wave, ..)| {
            let rate = rate.unwrap_or_else(|| dependence.rate(*wave));
            let (sin, cos) = (rate * x).sin_cos();
            [sin, cos]
        });
        let mut slopes: Vec<f64> = waves.collect();
        let force = values.iter().zip(&slopes).map(|(size, wave)| size * wave);
        let force: f64 = force.sum();
        if rate.is_some() {
            // The derivative by the frequency of a single harmonic.
            slopes.push(x * (values[0] * slopes[1] - values[1] * slopes[0]));
        }
        [x / scale, force, deviation(&slopes)]
    };
    let factor_unit = written.as_ref().and_then(|own| own.factor_unit.as_ref());
    Law {
        unit: match factor_unit {
            Some(factor) => format!("{force_unit}/({factor})"),
            None => force_unit,
        },
        variable,
        variable_unit,
        curve: (0..points).map(point).collect(),
        factor: written.and_then(|own| own.factor),
        ..Law::default()
    }
}

/// The course of the law of a mass behind a coordinate with a force of this unit: mass, natural frequency and damping
/// ratio are `values`. `deviation` is that of the force, from its derivatives by these.
pub(super) fn of_hidden_mass(
    force_unit: &str,
    coordinate: &str,
    values: &[f64],
    deviation: impl Fn(&[f64]) -> f64,
) -> Law {
    let point = |place: usize| {
        let part = place as f64 / (POINTS - 1) as f64;
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
        curve: (0..POINTS).map(point).collect(),
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

/// The force against a motion that reversed after a long travel in the other direction; its largest size and the
/// presliding displacement are `values`.
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
        let x = REACH * way * place as f64 / (POINTS - 1) as f64;
        let left = (-x / way).exp();
        let slopes = [2.0 * left - 1.0, 2.0 * force * left * x / (way * way)];
        let force = force * (2.0 * left - 1.0);
        [x / scale, force, deviation(&slopes)]
    };
    Law {
        unit,
        variable: format!("{coordinate} since it turned"),
        variable_unit: variable_unit.to_owned(),
        curve: (0..POINTS).map(point).collect(),
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
