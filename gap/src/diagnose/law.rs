//! The force that nobody has named, measured: a law of what it depends on, with its band.
//!
//! The waves of the variable that tell most of it become terms of a load in the spec, beside the effects that
//! are known, and their sizes are fitted as all others are: within a prior that lets a law be as rough as
//! one with a step. So the law predicts runs, and a spec can have it.

mod deviation;
mod hidden_mass;
mod waves;

use appell_estimate::{Along, Estimation};

use super::DiagnoseError;
use super::bench::Bench;
use super::calibration::{IMMATERIAL, TIED};
use super::compare::Comparison;
use super::evidence::Fitted;
use super::held_out::HeldOut;
use super::report::Law;
use super::scales;
use super::unknown::{Dependence, Leftover, On, Series, Unnamed, leftover, wave_scores};
use crate::effects::{Candidate, EffectModel, HiddenMass};
use appell_recordings::DataSet;

/// The equations with the law.
pub(super) struct Lawful<'c> {
    effects: EffectModel,
    /// What it stands beside.
    base: &'c Fitted,
    unnamed: Unnamed,
    kind: Kind,
    /// Where the search for its numbers begins.
    start: Vec<f64>,
}

/// What the law is.
enum Kind {
    /// Waves of a variable.
    Waves(Series),
    /// A mass behind this coordinate.
    HiddenMass(String),
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
    let first = left.first;
    let brings = |member: &usize| bench.candidate(*member).brings.is_some();
    if first.along != Along::Disturbances || base.members.iter().any(brings) {
        return Ok(None);
    }
    let found = match &first.on {
        On::Variable(wave) => of_variable(bench, base, &first, *wave)?,
        On::HiddenMass(hidden) => of_mass(bench, hidden),
    };
    let Some((candidate, kind, start)) = found else {
        return Ok(None);
    };
    let members = base.members.iter().map(|&member| bench.candidate(member));
    let candidates: Vec<Candidate> = members.cloned().chain([candidate]).collect();
    Ok(Some(Lawful {
        effects: bench.effects.again(candidates)?,
        base,
        unnamed: first,
        kind,
        start,
    }))
}

/// A load, what it is, and where the search for its numbers begins.
type Found = Option<(Candidate, Kind, Vec<f64>)>;

/// A force that depends on something the model knows.
fn of_variable(
    bench: &Bench<'_>,
    base: &Fitted,
    law: &Unnamed,
    wave: Option<usize>,
) -> Result<Found, DiagnoseError> {
    let Some(dependence) = dependence(bench, law) else {
        return Ok(None);
    };
    let setup = bench.setup(&base.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let scores = wave_scores((bench, &estimation), base, dependence, law.along)?;
    let mut scores = scores.into_iter().filter(|(place, _)| *place == law.place);
    let series = scores.next().and_then(|(_, scores)| scores.series(wave));
    Ok(series.and_then(|series| {
        let candidate = waves::candidate(bench, dependence, (law, wave), &series)?;
        let sizes = series.terms.iter().flat_map(|(_, sizes, _)| *sizes);
        let start = sizes.collect();
        Some((candidate, Kind::Waves(series), start))
    }))
}

/// On what a law depends, found in the same recordings, whole or in windows.
fn dependence<'b>(bench: &'b Bench<'_>, law: &Unnamed) -> Option<Dependence<'b>> {
    let mut all = Dependence::all(bench).into_iter();
    all.find(|one| one.name(bench) == law.variable)
}

/// A mass behind a coordinate.
fn of_mass(bench: &Bench<'_>, hidden: &HiddenMass) -> Found {
    let scales = scales::of(&bench.set);
    let candidate = Candidate::hidden_mass(&bench.effects.mechanism, &scales, hidden)?;
    let start = candidate.expected();
    Some((candidate, Kind::HiddenMass(hidden.behind.clone()), start))
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
        let law = self.effects.candidates.iter().find(|one| one.kind == "law");
        let places: Vec<usize> = law.map_or_else(Vec::new, |law| {
            bench.own(law).iter().map(|(place, _)| *place).collect()
        });
        for (&place, &size) in places.iter().zip(&self.start) {
            start[place] = size;
        }
        let fitted = bench.fit(&members, &estimation, &start)?;
        drop(estimation);
        let told = (&fitted, places.as_slice());
        let law = match (&self.kind, dependence(main, &self.unnamed)) {
            (Kind::HiddenMass(behind), _) => hidden_mass::told(main, &self.unnamed, behind, told),
            (Kind::Waves(series), Some(dependence)) => {
                waves::told((main, self.base), &self.unnamed, dependence, series, told)?
            }
            (Kind::Waves(_), None) => return Err(DiagnoseError::NothingToFit),
        };
        Ok(FittedLaw {
            runs: HeldOut::of(test, &bench)?,
            bench,
            fitted,
            base: self.base,
            law,
        })
    }
}
