//! The force that nobody has named, measured: a law of what it depends on, with its band.
//!
//! The waves of the variable that tell most of it become terms of a load in the spec, beside the effects that
//! are known, and their sizes are fitted as all others are: within a prior that lets a law be as rough as
//! one with a step. So the law predicts runs, and a spec can have it.

use std::fmt::Write as _;

use appell_estimate::{Along, Estimation, Unknown};

use super::DiagnoseError;
use super::bench::Bench;
use super::calibration::{IMMATERIAL, TIED};
use super::compare::Comparison;
use super::evidence::Fitted;
use super::forms::forms;
use super::held_out::HeldOut;
use super::localise::force_unit;
use super::report::Law;
use super::unknown::{Dependence, Leftover, Series, Unnamed, leftover, wave_scores};
use crate::effects::{Candidate, EffectModel};
use appell_recordings::DataSet;

/// Places at which the law is told, at least and for each half of its shortest wave.
const PLACES: [usize; 2] = [81, 10];
/// Standard deviation of the length of a wave, in the distance of those that are tried.
const APART: f64 = 0.5;

/// The equations with the law.
pub(super) struct Lawful<'c> {
    effects: EffectModel,
    /// What it stands beside.
    base: &'c Fitted,
    unnamed: Unnamed,
    series: Series,
}

/// The law after its fit.
pub(super) struct FittedLaw<'l> {
    pub(super) bench: Bench<'l>,
    pub(super) fitted: Fitted,
    /// What it stands beside.
    pub(super) base: &'l Fitted,
    /// The runs that were held out, as its equations take them.
    pub(super) runs: HeldOut,
    pub(super) law: Law,
}

/// The equations with what is left, where it is a force that depends on something the model knows.
pub(super) fn lawful<'c>(
    bench: &Bench<'_>,
    comparison: &'c Comparison,
) -> Result<Option<Lawful<'c>>, DiagnoseError> {
    let Some((base, left)) = base(bench, comparison)? else {
        return Ok(None);
    };
    let (first, dependences) = (left.first, Dependence::all(bench));
    let brings = |member: &usize| bench.candidate(*member).brings.is_some();
    if first.along != Along::Disturbances || base.members.iter().any(brings) {
        return Ok(None);
    }
    let Some(dependence) = dependences.get(first.dependence).copied() else {
        return Ok(None);
    };
    let setup = bench.setup(&base.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let scores = wave_scores((bench, &estimation), base, dependence, first.along)?;
    let scores = scores.into_iter().find(|(place, _)| *place == first.place);
    let series = scores.and_then(|(_, scores)| scores.series(first.wave));
    let Some(series) = series else {
        return Ok(None);
    };
    let Some(candidate) = candidate(bench, dependence, &first, &series) else {
        return Ok(None);
    };
    let members = base.members.iter().map(|&member| bench.candidate(member));
    let candidates: Vec<Candidate> = members.cloned().chain([candidate]).collect();
    Ok(Some(Lawful {
        effects: bench.effects.again(candidates)?,
        base,
        unnamed: first,
        series,
    }))
}

/// Beside which hypothesis the recordings speak most for a law, where there is one that matters.
fn base<'c>(
    bench: &Bench<'_>,
    comparison: &'c Comparison,
) -> Result<Option<(&'c Fitted, Leftover)>, DiagnoseError> {
    let of_best = comparison.left.clone().filter(|left| {
        let log = comparison.independent * left.log_bayes_factor;
        let matters = log > TIED && comparison.rest_share(bench) > IMMATERIAL;
        matters || log > 0.0 && comparison.leads_unknown()
    });
    let (best, nominal) = (comparison.best(), comparison.nominal());
    let Some(of_best) = of_best else {
        return Ok(None);
    };
    if best.members.is_empty() || comparison.unknown < 0.5 {
        return Ok(Some((best, of_best)));
    }
    // What explains nothing need not stand beside the law.
    let Some(of_nominal) = leftover(bench, nominal)? else {
        return Ok(Some((best, of_best)));
    };
    let evidence = |fitted: &Fitted, left: &Leftover| fitted.evidence.log() + left.log_bayes_factor;
    Ok(Some(
        if evidence(nominal, &of_nominal) > evidence(best, &of_best) {
            (nominal, of_nominal)
        } else {
            (best, of_best)
        },
    ))
}

/// The law as a load with a term for each wave. The length of a wave that is one alone is fitted too.
fn candidate(
    bench: &Bench<'_>,
    dependence: Dependence<'_>,
    law: &Unnamed,
    series: &Series,
) -> Option<Candidate> {
    let written = dependence.written(bench)?;
    let mut unit = force_unit(bench, law.place).replace(' ', "*");
    if let Some(of_factor) = &written.factor_unit {
        unit = format!("{unit}/({of_factor})");
    }
    let (mut force, mut numbers) = (String::new(), Vec::new());
    for (wave, _, deviation) in &series.terms {
        let rate = match law.wave {
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
    if let Some(wave) = law.wave {
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

impl Lawful<'_> {
    /// Fits the sizes beside all that is free under the hypothesis.
    pub(super) fn fitted(
        &self,
        main: &Bench<'_>,
        test: &DataSet,
    ) -> Result<FittedLaw<'_>, DiagnoseError> {
        let bench = main.beside(&self.effects)?;
        let members: Vec<usize> = (0..self.effects.candidates.len()).collect();
        let setup = bench.setup(&members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut start = main.carried_by_name(self.base, &estimation);
        let sizes = self.series.terms.iter().flat_map(|(_, sizes, _)| sizes);
        let law = self.effects.candidates.iter().find(|one| one.kind == "law");
        let places: Vec<usize> = law.map_or_else(Vec::new, |law| {
            bench.own(law).iter().map(|(place, _)| *place).collect()
        });
        for (&place, &size) in places.iter().zip(sizes) {
            start[place] = size;
        }
        let fitted = bench.fit(&members, &estimation, &start)?;
        drop(estimation);
        let law = self.told(main, &fitted, &places)?;
        Ok(FittedLaw {
            runs: HeldOut::of(test, &bench)?,
            bench,
            fitted,
            base: self.base,
            law,
        })
    }

    /// The law with its band.
    fn told(
        &self,
        main: &Bench<'_>,
        fitted: &Fitted,
        places: &[usize],
    ) -> Result<Law, DiagnoseError> {
        let dependence = Dependence::all(main)[self.unnamed.dependence];
        let (variable_unit, scale) = dependence.unit(main);
        let written = dependence.written(main);
        let (low, high) = dependence.range;
        let free: Vec<Option<usize>> = (places.iter())
            .map(|&place| {
                let mut free = fitted.fit.free.iter();
                free.position(|free| free.unknown == Unknown::Parameter(place))
            })
            .collect();
        let covariance = fitted.fit.covariance();
        let values: Vec<f64> = places
            .iter()
            .map(|&place| fitted.fit.values[place])
            .collect();
        let shortest = self.series.terms.iter().map(|(wave, ..)| wave + 1).max();
        let places_told = PLACES[0].max(PLACES[1] * shortest.unwrap_or(1));
        // After the sizes of the waves.
        let rate = values.get(2 * self.series.terms.len()).copied();
        let point = |place: usize| {
            let x = low + (high - low) * place as f64 / (places_told - 1) as f64;
            let waves = self.series.terms.iter().flat_map(|(wave, ..)| {
                let rate = rate.unwrap_or_else(|| dependence.rate(*wave));
                let (sin, cos) = (rate * x).sin_cos();
                [sin, cos]
            });
            let mut waves: Vec<f64> = waves.collect();
            let force: f64 = values
                .iter()
                .zip(&waves)
                .map(|(size, wave)| size * wave)
                .sum();
            if rate.is_some() {
                // The slope by the rate of one wave.
                waves.push(x * (values[0] * waves[1] - values[1] * waves[0]));
            }
            let mut variance = 0.0;
            for (i, a) in free.iter().zip(&waves) {
                for (j, b) in free.iter().zip(&waves) {
                    if let (Some(i), Some(j), Ok(covariance)) = (i, j, &covariance) {
                        variance += a * b * covariance[(*i, *j)];
                    }
                }
            }
            [x / scale, force, variance.max(0.0).sqrt()]
        };
        let factor_unit = written.as_ref().and_then(|own| own.factor_unit.clone());
        let force = force_unit(main, self.unnamed.place);
        Ok(Law {
            equation: main.effects.info().states[self.unnamed.place]
                .name
                .to_string(),
            unit: factor_unit.map_or(force.clone(), |factor| format!("{force}/({factor})")),
            depends_on: self.unnamed.variable.clone(),
            variable: dependence.letters(main).0,
            variable_unit,
            factor: written.and_then(|own| own.factor),
            curve: (0..places_told).map(point).collect(),
            log_bayes_factor: self.unnamed.log_bayes_factor,
            forms: forms(main, self.base, dependence, &self.unnamed)?,
        })
    }
}
