//! The report of a comparison: the hypotheses with their estimates and ties, and the residual of the best one.

use super::alternative::Rival;
use super::calibration::{SEARCHED, TIED, names, of_count, prior, tempered};
use super::compare::has_deviation;
use super::law::FittedLaw;
use super::report::LAW;
use super::screen::{Screened, imitated};
use super::yardstick::Yardsticks;
use super::{
    Bench, Changes, Comparison, Detectable, Fitted, Found, GapVerdict, Hypothesis, Left, Report,
    Result, Value, Where, Yardstick,
};
use crate::effects::{Acts, Candidate, EffectModel, Part};
use appell_estimate::{Along, Unknown};
use appell_recordings::DataSet;

/// Size in its standard deviations that is detected with near certainty.
const DETECTABLE: f64 = 5.0;
/// Number of hypotheses that are reported even if improbable.
const TOLD: usize = 10;
/// Limit of log odds, to avoid overflow.
const MOST_LOG_ODDS: f64 = 600.0;

impl Report {
    /// Adds a measured law: it is the change of the spec under `unknown`. A law that could not be fitted is listed
    /// under `failed`.
    pub(super) fn measured<'l>(
        &mut self,
        measured: Option<Result<FittedLaw<'l>>>,
    ) -> Result<Option<FittedLaw<'l>>> {
        let measured = match measured {
            Some(Ok(measured)) => measured,
            Some(Err(reason)) => {
                self.failed.push((vec![LAW.to_owned()], reason.to_string()));
                return Ok(None);
            }
            None => return Ok(None),
        };
        let unknown = self.which.iter_mut().find(|one| one.is_unknown());
        if let Some(unknown) = unknown {
            unknown.changes = Some(Changes::of(&measured.bench, &measured.fitted)?);
        }
        self.law = Some(measured.law.clone());
        Ok(Some(measured))
    }
}

/// The report without the results on held-out runs.
pub(super) fn assemble(
    bench: &Bench<'_>,
    screen: &[Screened],
    comparison: &Comparison,
    place: Where,
    rivals: &[Rival<'_>],
) -> Result<Report> {
    // A size without a yardstick is a size nevertheless.
    let yardsticks = Yardsticks::new(bench, comparison.best()).ok();
    let mut which = which(bench, comparison, yardsticks.as_ref())?;
    join(&mut which, rivals, bench, comparison)?;
    which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    beside_their_twins(&mut which);
    let tied = tied(&which);
    let top = &which[0];
    let verdict = GapVerdict::of(top, &tied);
    let keep = shortened(&which);
    let best = comparison.best();
    let leading = rivals
        .iter()
        .find(|rival| top.effects == [rival.name.clone()]);
    let leads = leading.is_some();
    let found = match leading {
        Some(rival) => vec![Found {
            effect: rival.name.clone(),
            about: format!("the model `{}`", rival.bench.set.mechanism.name),
            sites: Vec::new(),
        }],
        None => found(bench.effects, &best.members),
    };
    let failed = comparison.failed.iter();
    let failed = failed.map(|(members, reason)| (names(bench.effects, members), reason.clone()));
    let mut screened: Vec<&Screened> = screen.iter().collect();
    screened.sort_by_key(|one| one.candidate);
    let deviations = screened.into_iter();
    let deviations = deviations.filter_map(|one| Some((one.candidate, *one.deviations.first()?)));
    Ok(Report {
        verdict,
        is_by_simulation: bench.is_over_windows(),
        place: if verdict == GapVerdict::NoGap || leads {
            Where::default()
        } else {
            place
        },
        which: keep.unwrap_or(which),
        tied,
        detectable: detectable(bench.effects, &bench.set, deviations),
        failed: failed.collect(),
        disturbances: disturbances(bench, comparison.nominal(), best),
        left: left(bench, comparison),
        independent: comparison.independent,
        found,
        ..Report::of(&bench.set)
    })
}

/// The hypotheses without those of negligible probability; `None` if these have some together.
pub(super) fn shortened(which: &[Hypothesis]) -> Option<Vec<Hypothesis>> {
    let cut = which.len().min(TOLD);
    let rest: f64 = which[cut..].iter().map(|h| h.probability).sum();
    let told = which
        .iter()
        .enumerate()
        .filter(|(i, h)| *i < cut || h.effects.is_empty() || h.is_unknown());
    (rest < 1e-6).then(|| told.map(|(_, h)| h.clone()).collect())
}

/// The hypotheses of the library, and `unknown`.
fn which(
    bench: &Bench<'_>,
    comparison: &Comparison,
    yardsticks: Option<&Yardsticks<'_>>,
) -> Result<Vec<Hypothesis>> {
    // If the comparison fails, no hypothesis counts as equivalent.
    let twins = twins(bench, comparison).unwrap_or_default();
    let base = comparison.nominal().evidence.log();
    let known = 1.0 - comparison.unknown;
    let mut which: Vec<Hypothesis> = Vec::new();
    for (place, (fitted, probability)) in comparison.fits.iter().enumerate() {
        let effects = names(bench.effects, &fitted.members);
        // Variants of one effect are one hypothesis.
        if let Some(own) = which.iter_mut().find(|own| own.effects == effects) {
            own.probability += probability * known;
            continue;
        }
        let is_twin = twins.contains(&place);
        if is_twin {
            which[0].probability += probability * known;
            // The first is a mixture of this and an equivalent one.
            if effects.len() > which[0].effects.len() {
                continue;
            }
        }
        which.push(Hypothesis {
            same_as: is_twin.then(|| which[0].effects.clone()),
            effects,
            probability: if is_twin { 0.0 } else { probability * known },
            log_bayes_factor: Some(fitted.evidence.log() - base),
            parameters: (fitted.members.iter())
                .flat_map(|&member| values(bench.candidate(member), bench, fitted, yardsticks))
                .collect(),
            changes: Some(Changes::of(bench, fitted)?),
        });
    }
    let best = comparison.best();
    let unresolved = best.members.iter();
    let unresolved = unresolved.filter_map(|&late| of_unresolved_lag(bench, best, &which[0], late));
    let is_new = |own: &Hypothesis| which.iter().all(|other| other.effects != own.effects);
    let unresolved: Vec<Hypothesis> = unresolved.filter(is_new).collect();
    which.extend(unresolved);
    which.push(Hypothesis::unknown(comparison.unknown));
    Ok(which)
}

/// Indices of the fits that are equivalent to the best one but for their names, such as a bias of a motor and a constant
/// force along it: no experiment can distinguish them, so they share one probability. Their evidence is the same within
/// the accuracy of searches, and about the best one the sensitivities of their other members are linearly dependent.
fn twins(bench: &Bench<'_>, comparison: &Comparison) -> Result<Vec<usize>> {
    let best = comparison.best();
    let is_alike = |place: &usize| {
        let (own, _) = &comparison.fits[*place];
        own.members.len() == best.members.len()
            && (own.evidence.log() - best.evidence.log()).abs() < SEARCHED
    };
    let alike: Vec<usize> = (1..comparison.fits.len()).filter(is_alike).collect();
    if best.members.is_empty() || alike.is_empty() {
        return Ok(Vec::new());
    }
    let imitated = imitated(bench, best)?;
    // Short lags and delays are similar, but not equivalent.
    let is_late = |member: usize| {
        let acts = bench.candidate(member).acts;
        matches!(
            acts,
            Acts::Lag(_) | Acts::Delay(_) | Acts::Late(_) | Acts::Slow(_)
        )
    };
    let says_the_same = |place: &usize| {
        let mut members = comparison.fits[*place].0.members.iter();
        members.all(|&member| {
            best.members.contains(&member) || imitated.contains(&member) && !is_late(member)
        })
    };
    Ok(alike.into_iter().filter(says_the_same).collect())
}

/// The best hypothesis with a lag in the place of a delay that is too short to be distinguished from it.
fn of_unresolved_lag(
    bench: &Bench<'_>,
    best: &Fitted,
    first: &Hypothesis,
    late: usize,
) -> Option<Hypothesis> {
    let delay = bench.candidate(late);
    // A channel that lags and one that is late are variants of one effect.
    let Acts::Delay(input) = delay.acts else {
        return None;
    };
    let mut candidates = bench.effects.candidates.iter();
    let lag = candidates.position(|own| own.acts == Acts::Lag(input) && !own.is_of_group())?;
    let own = named(delay, "delay");
    let place = first.parameters.iter().position(|one| one.name == own)?;
    if !bench.is_too_short(lag, &[first.parameters[place].value]) {
        return None;
    }
    let mut members: Vec<usize> = best.members.clone();
    members.retain(|&member| member != late);
    members.push(lag);
    members.sort_unstable();
    let mut parameters = first.parameters.clone();
    parameters[place].name = named(bench.candidate(lag), "time_constant");
    Some(Hypothesis {
        effects: names(bench.effects, &members),
        same_as: Some(first.effects.clone()),
        probability: 0.0,
        log_bayes_factor: first.log_bayes_factor,
        parameters,
        changes: None,
    })
}

/// The effects of a hypothesis in words.
pub(super) fn found(model: &EffectModel, members: &[usize]) -> Vec<Found> {
    let members = members.iter().map(|&member| model.candidate(member));
    let mut found: Vec<Found> = members
        .map(|candidate| Found {
            effect: candidate.name(),
            about: candidate.about.clone(),
            sites: candidate.sites(),
        })
        .collect();
    found.dedup();
    found
}

/// Adds alternatives to the hypotheses of the library, each with the prior probability of one effect.
fn join(
    which: &mut Vec<Hypothesis>,
    rivals: &[Rival<'_>],
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<()> {
    let (best, probability) = &comparison.fits[0];
    // If `unknown` is certain, 1 − p underflows: the evidence of the residual law bounds it.
    let left = comparison.left.as_ref();
    let left = left.map_or(0.0, |left| left.beside_fitted.max(0.0)) * comparison.independent;
    let known = probability.ln() + (1.0 - comparison.unknown).ln().max(-left);
    let beside = best.evidence.log() + prior(bench.effects, &best.members);
    let base = comparison.nominal().evidence.log();
    for rival in rivals {
        let odds =
            tempered(comparison.independent * (rival.log + of_count(bench.effects, 1) - beside));
        which.push(Hypothesis {
            effects: vec![rival.name.clone()],
            same_as: None,
            probability: (odds + known).min(MOST_LOG_ODDS).exp(),
            log_bayes_factor: Some(rival.log - base),
            parameters: rival.values()?,
            changes: None,
        });
    }
    let sum: f64 = which.iter().map(|hypothesis| hypothesis.probability).sum();
    for hypothesis in which {
        hypothesis.probability /= sum;
    }
    Ok(())
}

/// Sorts equivalent hypotheses next to each other.
fn beside_their_twins(which: &mut Vec<Hypothesis>) {
    let (twins, mut others): (Vec<Hypothesis>, Vec<Hypothesis>) =
        (which.drain(..)).partition(|one| one.same_as.is_some());
    for twin in twins.into_iter().rev() {
        let first = others.iter();
        let mut first = first
            .enumerate()
            .filter(|(_, own)| twin.same_as.as_ref() == Some(&own.effects));
        let place = first.next().map_or(0, |(place, _)| place + 1);
        others.insert(place, twin);
    }
    *which = others;
}

/// The leading hypothesis with those that cannot be distinguished from it.
pub(super) fn tied(which: &[Hypothesis]) -> Vec<Vec<Vec<String>>> {
    let is_named = |other: &&Hypothesis| !other.is_unknown();
    let Some(first) = which.iter().find(is_named) else {
        return Vec::new();
    };
    if first.effects.is_empty() {
        return Vec::new();
    }
    let is_near = |other: &&Hypothesis| {
        is_named(other)
            && other.effects.len() == first.effects.len()
            && (other.same_as.as_ref() == Some(&first.effects)
                || (first.probability / other.probability).ln() < TIED)
    };
    let group: Vec<&Hypothesis> = which.iter().filter(is_near).collect();
    // Equivalent hypotheses share one probability: they lead together, not individually.
    let all: f64 = group.iter().map(|one| one.probability).sum();
    if group.len() > 1 && all >= which[0].probability {
        vec![group.into_iter().map(|one| one.effects.clone()).collect()]
    } else {
        Vec::new()
    }
}

/// The name of a size; of an effect at a group of sites, with the site.
fn named(candidate: &Candidate, short: &str) -> String {
    let name = candidate.name();
    match candidate.sites().as_slice() {
        [drive] if candidate.is_of_group() => format!("{name}.{drive}_{short}"),
        _ => format!("{name}.{short}"),
    }
}

/// Values of a candidate.
fn values(
    candidate: &Candidate,
    bench: &Bench<'_>,
    fitted: &Fitted,
    yardsticks: Option<&Yardsticks<'_>>,
) -> Vec<Value> {
    let info = bench.effects.info();
    let deviation = |place: usize| match fitted.fit.deviation(place) {
        Ok(deviation) if !fitted.fit.at_limit[place] && has_deviation(&fitted.fit, place) => {
            deviation
        }
        _ => f64::NAN,
    };
    let mut own = bench.own(candidate);
    own.retain(|(_, part)| *part != Part::Switch);
    let part_of = |index: usize| own.iter().find(|(own, _)| *own == index);
    let setup = bench.setup(&fitted.members);
    let of_signal = bench.of_signal(candidate.acts, &setup);
    let of_signal = of_signal.map(|free| free.unknown);
    let mut values = Vec::new();
    for (place, free) in fitted.fit.free.iter().enumerate() {
        let value = free.to_value(fitted.fit.coordinates[place]);
        let name = match free.unknown {
            Unknown::Parameter(index) => info.parameters[index].name.as_ref(),
            _ => "",
        };
        let (short, parameter, without, yardstick) = match (free.unknown, candidate.acts) {
            (Unknown::Parameter(index), Acts::Items) => match part_of(index) {
                Some((_, part)) if part.is_shape() => {
                    (candidate.short(name), Some(index), None, None)
                }
                Some(_) => {
                    let own = yardsticks.and_then(|own| own.of_size(fitted, candidate, index));
                    (candidate.short(name), Some(index), Some(0.0), own)
                }
                None => continue,
            },
            (Unknown::Parameter(index), Acts::Parameter(own)) if index == own => {
                let stated = bench.set.parameters[index].value;
                let own = Yardstick::of_parameter(value, stated);
                (
                    candidate.short_of_error(name),
                    Some(index),
                    Some(stated),
                    own,
                )
            }
            (unknown, acts) if of_signal == Some(unknown) => {
                let of_time = Yardstick::of_time(value, bench.step);
                match acts {
                    Acts::Bias(_) => ("bias", None, Some(0.0), None),
                    Acts::Scale(_) => ("scale", None, Some(1.0), None),
                    Acts::Lag(_) | Acts::Slow(_) => ("time_constant", None, Some(0.0), of_time),
                    _ => ("delay", None, Some(0.0), of_time),
                }
            }
            _ => continue,
        };
        let (scale, unit) = unit(&bench.set, bench.effects, candidate.acts, parameter);
        let told = Value {
            name: named(candidate, short),
            value: value / scale,
            std: deviation(place) * free.stretch(value) / scale,
            unit,
            without: None,
            is_determined: !free
                .prior
                .is_some_and(|[_, std]| deviation(place) > 0.5 * std),
            yardstick,
        };
        values.push(match without {
            Some(without) => told.of_size(without / scale),
            None => told,
        });
    }
    values
}

/// How many SI units the unit of a size has, and that unit: of a parameter, or of an effect on a signal.
fn unit(set: &DataSet, model: &EffectModel, acts: Acts, parameter: Option<usize>) -> (f64, String) {
    match (parameter, acts) {
        (Some(index), _) => {
            let quantity = &model.info().parameters[index];
            (quantity.scale, quantity.unit.to_string())
        }
        (None, Acts::Bias(channel)) => (1.0, channel_unit(set, model, channel)),
        (None, Acts::Lag(_) | Acts::Delay(_) | Acts::Late(_) | Acts::Slow(_)) => {
            (1.0, "s".to_owned())
        }
        _ => (1.0, "1".to_owned()),
    }
}

/// SI unit of a measured channel.
fn channel_unit(set: &DataSet, model: &EffectModel, channel: usize) -> String {
    let measured = set.measured(model.info());
    let Some((channel, _)) = measured.get(channel) else {
        return String::new();
    };
    let unit = &channel.unit;
    let si = appell_spec::units::Unit::si(unit.dimension).text;
    // An angle has no dimension, but a customary unit.
    match si.as_str() {
        "1" if unit.has_angle() => "rad".to_owned(),
        "1/s" if unit.has_angle() => "rad/s".to_owned(),
        _ => si,
    }
}

fn left(bench: &Bench<'_>, comparison: &Comparison) -> Option<Left> {
    let left = comparison.left.as_ref()?;
    let first = &left.first;
    let (place, what) = match first.along {
        Along::Disturbances => {
            let equation = bench.effects.info().states[first.place].name.to_string();
            (equation, "a force in the equation of")
        }
        Along::Channels => {
            let measured = bench.set.measured(bench.effects.info());
            let (channel, _) = measured.get(first.place)?;
            (channel.column.clone(), "an error of the channel")
        }
    };
    let variable = first.variable.clone();
    Some(Left {
        about: format!("{what} {place} that depends on {variable}"),
        place,
        variable,
        log_bayes_factor: left.log_bayes_factor,
        gain: first.gains.gain,
        explained: comparison.explained(),
    })
}

/// Process noise of the nominal model and of the best hypothesis along each pseudo-velocity; over windows there is none.
fn disturbances(bench: &Bench<'_>, nominal: &Fitted, best: &Fitted) -> Vec<(String, f64, f64)> {
    if bench.is_over_windows() {
        return Vec::new();
    }
    let info = bench.effects.info();
    let level = |fitted: &Fitted, index| {
        let place = fitted.layout.place(Unknown::Disturbance(index));
        place.map_or(f64::NAN, |place| fitted.fit.values[place])
    };
    (0..info.speeds)
        .map(|index| {
            let name = info.states[index].name.to_string();
            (name, level(nominal, index), level(best, index))
        })
        .collect()
}

/// The smallest detectable size of each effect, from the standard deviation of the first size of candidates.
pub(super) fn detectable(
    model: &EffectModel,
    set: &DataSet,
    deviations: impl Iterator<Item = (usize, f64)>,
) -> Vec<Detectable> {
    let mut told: Vec<Detectable> = Vec::new();
    for (candidate, deviation) in deviations {
        let candidate = model.candidate(candidate);
        let effect = candidate.name();
        if deviation <= 0.0 || told.iter().any(|own| own.effect == effect) {
            continue;
        }
        let parameter = model.first_parameter(candidate);
        let (scale, unit) = unit(set, model, candidate.acts, parameter);
        told.push(Detectable {
            effect,
            smallest: DETECTABLE * deviation / scale,
            unit,
        });
    }
    told
}

impl EffectModel {
    /// Index of the first parameter of an effect on the equations.
    pub(super) fn first_parameter(&self, candidate: &Candidate) -> Option<usize> {
        match candidate.acts {
            Acts::Items => self.own(candidate).first().map(|(index, _)| *index),
            Acts::Parameter(index) => Some(index),
            _ => None,
        }
    }
}
