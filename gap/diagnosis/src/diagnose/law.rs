//! Measurement of a force outside the library: a law of its variable, with its band.
//!
//! The harmonics that increase the log likelihood most become terms of a load in the spec, in addition to the identified
//! effects; their amplitudes are fitted like other parameters, with a prior that admits discontinuous laws. The law can
//! therefore predict runs and be written into a spec.

mod course;

use appell_estimate::{Along, Estimation, Unknown};

use super::calibration::{IMMATERIAL, TIED};
use super::forms::forms;
use super::localise::force_unit;
use super::prediction::noise;
use super::scales;
use super::unknown::{
    Dependence, Leftover, On, Series, Unnamed, leftover, remembered, wave_scores,
};
use super::{Bench, Comparison, DiagnoseError, Fitted, HeldOut, Law, Result};
use crate::effects::{Candidate, EffectModel, Memory};
use crate::held_out::AHEAD;
use appell_recordings::{DataSet, Part};

/// The equations with the law.
pub(super) struct Lawful {
    effects: EffectModel,
    /// The hypothesis to which it is added.
    base: Fitted,
    left: Leftover,
    kind: Kind,
    /// Initial values of its coefficients.
    start: Vec<f64>,
}

/// The kind of a law.
enum Kind {
    /// Harmonics of a variable.
    Waves(Series),
    /// A force with a hidden state.
    Memory(Memory),
}

/// The law after its fit.
pub(super) struct FittedLaw<'l> {
    pub(super) bench: Bench<'l>,
    pub(super) fitted: Fitted,
    /// The hypothesis to which it is added.
    pub(super) base: &'l Fitted,
    /// The held-out runs, bound to its equations.
    pub(super) runs: HeldOut,
    pub(super) law: Law,
    /// Its first estimate.
    left: &'l Leftover,
    /// Log evidence: that of the first estimate, plus the further gain by the fit.
    log_evidence: f64,
}

/// The equations with a law for the residual force, if it depends on quantities of the model: in addition to the best
/// hypothesis, and to the nominal model if that hypothesis may be wrong.
pub(super) fn lawful(bench: &Bench<'_>, comparison: &Comparison) -> Result<Vec<Lawful>> {
    let (best, nominal) = (comparison.best(), comparison.nominal());
    let of_best = comparison.left.clone().filter(|left| {
        let log = comparison.independent * left.log_bayes_factor;
        let matters = log > TIED && comparison.rest_share(bench) > IMMATERIAL;
        matters || log > 0.0 && comparison.leads_unknown()
    });
    let alone = match best.members.len() {
        0 => None,
        _ if of_best.is_some() && comparison.unknown >= 0.5 => leftover(bench, nominal)?,
        1 => None,
        _ => remembered(bench, nominal)?.filter(|left| left.log_bayes_factor > TIED),
    };
    let mut all = Vec::new();
    for (base, left) in [(best, of_best), (nominal, alone)] {
        if let Some(left) = left {
            all.extend(beside(bench, base, left)?);
        }
    }
    Ok(all)
}

/// Fits each law together with the hypothesis to which it is added: the one with the largest evidence, or the error if
/// none could be fitted. `runs` are the training runs.
pub(super) fn measured<'l>(
    laws: &'l [Lawful],
    comparison: &mut Comparison,
    bench: &Bench<'_>,
    runs: &DataSet,
    test: &DataSet,
) -> Option<Result<FittedLaw<'l>>> {
    let evidence = |law: &Result<FittedLaw<'_>>| {
        let found = law.as_ref();
        found.map_or(f64::NEG_INFINITY, |law| law.log_evidence)
    };
    let laws = laws.iter().map(|law| law.fitted(bench, test));
    let mut laws: Vec<Result<FittedLaw<'l>>> = laws.collect();
    laws.sort_by(|a, b| evidence(b).total_cmp(&evidence(a)));
    let holds = |law: &Result<FittedLaw<'_>>, comparison: &mut Comparison| match law {
        Ok(law) if law.base.members.len() < comparison.best().members.len() => {
            law.predicts(comparison.best(), bench, runs)
                .unwrap_or(false)
                && comparison.weigh_alone(bench, law.log_evidence, law.left)
        }
        _ => true,
    };
    let place = laws.iter().position(|law| holds(law, comparison))?;
    Some(laws.swap_remove(place))
}

impl FittedLaw<'_> {
    /// Whether it predicts runs better than a hypothesis: a filter may fit a hidden state to a motion that it does not
    /// cause.
    fn predicts(&self, other: &Fitted, bench: &Bench<'_>, runs: &DataSet) -> Result<bool> {
        let runs = runs.all(Part::Test);
        let noise = noise(bench, other)?;
        let errors = |bench: &Bench<'_>, fitted: &Fitted| {
            let errors = HeldOut::of(&runs, bench)?.errors(bench, fitted, &noise, AHEAD)?;
            Ok::<f64, DiagnoseError>(errors.mean())
        };
        Ok(errors(&self.bench, &self.fitted)? < errors(bench, other)?)
    }
}

/// The equations of a hypothesis with a law for its residual.
fn beside(bench: &Bench<'_>, base: &Fitted, left: Leftover) -> Result<Option<Lawful>> {
    let first = &left.first;
    let brings = |member: &usize| bench.candidate(*member).brings.is_some();
    if first.along != Along::Disturbances || base.members.iter().any(brings) {
        return Ok(None);
    }
    let found = match &first.on {
        On::Variable(wave) => of_variable(bench, base, first, *wave)?,
        On::Memory(memory) => of_memory(bench, memory),
    };
    let Some((candidate, kind, start)) = found else {
        return Ok(None);
    };
    let members = base.members.iter().map(|&member| bench.candidate(member));
    let candidates: Vec<Candidate> = members.cloned().chain([candidate]).collect();
    Ok(Some(Lawful {
        effects: bench.effects.again(candidates)?,
        base: base.clone(),
        left,
        kind,
        start,
    }))
}

/// A load, its kind, and the initial values of its coefficients.
type Found = Option<(Candidate, Kind, Vec<f64>)>;

/// A force that depends on quantities of the model.
fn of_variable(
    bench: &Bench<'_>,
    base: &Fitted,
    law: &Unnamed,
    wave: Option<usize>,
) -> Result<Found> {
    let Some(dependence) = dependence(bench, law) else {
        return Ok(None);
    };
    let setup = bench.setup(&base.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let scores = wave_scores(bench, &estimation, base, &[dependence], law.along)?;
    let mut scores = scores.into_iter().flatten();
    let own = scores.find(|(place, _)| *place == law.place);
    let series = own.and_then(|(_, scores)| scores.series(wave));
    Ok(series.and_then(|series| {
        let candidate = course::candidate(bench, dependence, law, wave, &series)?;
        let sizes = series.terms.iter().flat_map(|(_, sizes, _)| *sizes);
        let start = sizes.collect();
        Some((candidate, Kind::Waves(series), start))
    }))
}

/// The variable of a law, of the same recordings, whole or in windows.
fn dependence<'b>(bench: &'b Bench<'_>, law: &Unnamed) -> Option<Dependence<'b>> {
    let mut all = Dependence::all(bench).into_iter();
    all.find(|one| one.name(bench) == law.variable)
}

/// A force with a hidden state.
fn of_memory(bench: &Bench<'_>, memory: &Memory) -> Found {
    let scales = scales::of(&bench.set);
    let candidate = Candidate::remembering(&bench.effects.mechanism, &scales, memory)?;
    let start = candidate.expected();
    Some((candidate, Kind::Memory(memory.clone()), start))
}

impl Lawful {
    /// Fits the coefficients together with all free parameters of the hypothesis.
    fn fitted(&self, main: &Bench<'_>, test: &DataSet) -> Result<FittedLaw<'_>> {
        let bench = main.beside(&self.effects)?;
        let members: Vec<usize> = (0..self.effects.candidates.len()).collect();
        let setup = bench.setup(&members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut start = main.carried_by_name(&self.base, &estimation);
        let law = self.effects.candidates.iter().find(|one| one.is_measured());
        let places: Vec<usize> = law.map_or_else(Vec::new, |law| {
            bench.own(law).iter().map(|(place, _)| *place).collect()
        });
        for (&place, &size) in places.iter().zip(&self.start) {
            start[place] = size;
        }
        bench.hide(&members, &estimation, &mut start)?;
        let fitted = bench.fit(bench.finely(), &members, &estimation, &start)?;
        drop(estimation);
        let first = &self.left.first;
        let values: Vec<f64> = (places.iter())
            .map(|&place| fitted.fit.values[place])
            .collect();
        let force = force_unit(&main.effects.mechanism, first.place);
        let covariance = fitted.fit.covariance().ok();
        let free = |place: &usize| {
            let mut free = fitted.fit.free.iter();
            free.position(|free| free.unknown == Unknown::Parameter(*place))
        };
        let free: Vec<Option<usize>> = places.iter().map(free).collect();
        let deviation = |slopes: &[f64]| {
            let mut variance = 0.0;
            for (i, a) in free.iter().zip(slopes) {
                for (j, b) in free.iter().zip(slopes) {
                    if let (Some(i), Some(j), Some(covariance)) = (i, j, &covariance) {
                        variance += a * b * covariance[(*i, *j)];
                    }
                }
            }
            variance.max(0.0).sqrt()
        };
        let law = match &self.kind {
            Kind::Memory(Memory::HiddenMass { behind, .. }) => {
                course::of_hidden_mass(&force, behind, &values, deviation)
            }
            Kind::Memory(Memory::Hysteresis { along, .. }) => {
                course::of_hysteresis(main, force, along, &values, deviation)
            }
            Kind::Waves(series) => {
                let dependence = dependence(main, first);
                let dependence = dependence.ok_or(DiagnoseError::NothingToFit)?;
                Law {
                    forms: forms(main, &self.base, dependence, first)?,
                    ..course::of_waves(main, force, dependence, series, &values, deviation)
                }
            }
        };
        let law = Law {
            equation: main.effects.info().states[first.place].name.to_string(),
            depends_on: first.variable.clone(),
            log_bayes_factor: first.gains.log_bayes_factor,
            ..law
        };
        let gain = fitted.fit.log_posterior - self.base.fit.log_posterior;
        let first = self.left.log_bayes_factor - self.left.first.gains.gain;
        Ok(FittedLaw {
            left: &self.left,
            log_evidence: self.base.evidence.log() + first + gain,
            runs: HeldOut::of(test, &bench)?,
            bench,
            fitted,
            base: &self.base,
            law,
        })
    }
}
