//! A law of a variable: a load with a term for each harmonic.

use std::fmt::Write as _;

use super::super::localise::force_unit;
use super::super::unknown::{Dependence, Series, Unnamed};
use super::super::{Bench, Law};
use crate::effects::Candidate;

/// Number of points at which the law is reported: at least, and for each half of its shortest period.
const PLACES: [usize; 2] = [81, 10];
/// Prior standard deviation of the frequency of a single harmonic, relative to the spacing of the grid.
const APART: f64 = 0.5;

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

/// The course of the law, whose coefficients are `values`. `deviation` is that of the force, from its derivatives by these.
pub(super) fn course(
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
