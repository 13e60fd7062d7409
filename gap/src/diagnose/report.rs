//! The gap report: what was found, in the words of the contract.

use super::DiagnoseError;
use super::against::Change;
use super::alternative::Rival;
use super::bench::Bench;
use super::budget::{LAW, Part as Share};
use super::calibration::tempered;
use super::changes::Changes;
use super::compare::{Comparison, TIED, effects, prior};
use super::experiment::Experiment;
use super::force_history::ForceHistory;
use super::force_law::ForceLaw;
use super::hypothesis::Fitted;
use super::law::{FittedLaw, Law};
use super::screen::Screen;
use super::traces::{Ahead, Trace};
use super::unknown;
use crate::effects::{Acts, Part};
use appell_estimate::{Along, Unknown};

/// Name of the hypothesis that nothing in the library explains the gap.
const UNKNOWN: &str = "unknown";
/// Sizes in their standard deviations that are found with near certainty.
const DETECTABLE: f64 = 5.0;
/// Fewer hypotheses than this are never cut from the report.
const TOLD: usize = 10;
/// Odds beyond this are certainty, and no number any more.
const MOST_LOG_ODDS: f64 = 600.0;

/// The result in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapVerdict {
    /// Nothing beyond noise and disturbance.
    NoGap,
    /// One hypothesis wins.
    Explained,
    /// A gap whose explanations cannot be told apart.
    Ambiguous,
    /// A gap that nothing in the library explains.
    Unexplained,
}

/// Part of a gap that stays, beyond which it is not explained.
const MOST: f64 = 0.5;

impl GapVerdict {
    /// After predictions of the runs that were held out: what does not better them explains nothing, nor does what
    /// leaves most of the gap where simulations rank the hypotheses.
    pub(super) fn after(
        self,
        which: &[Hypothesis],
        far: Option<&HowFar>,
        is_by_simulation: bool,
    ) -> Self {
        let Some(far) = far else { return self };
        let names_effects = matches!(self, Self::Explained | Self::Ambiguous)
            && which.iter().any(|one| !one.parameters.is_empty());
        let stays = far.budget.iter().find(|part| part.is_rest());
        let most_stays = stays.is_some_and(|part| part.closed > MOST);
        if names_effects && (far.is_worse || is_by_simulation && most_stays) {
            Self::Unexplained
        } else {
            self
        }
    }

    /// Its word for programs.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoGap => "no_gap",
            Self::Explained => "explained",
            Self::Ambiguous => "ambiguous",
            Self::Unexplained => "unexplained",
        }
    }
}

/// A value that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// Effect and parameter.
    pub name: String,
    /// Most likely value.
    pub value: f64,
    /// Standard deviation; NaN where nothing is known of it, as at a limit.
    pub std: f64,
    /// Unit.
    pub unit: String,
}

/// A hypothesis with its probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// Names of its effects; none for the nominal model, `unknown` for none of the library.
    pub effects: Vec<String>,
    /// Probability.
    pub probability: f64,
    /// Logarithm of the Bayes factor against the nominal model.
    pub log_bayes_factor: Option<f64>,
    /// Values that its effects have.
    pub parameters: Vec<Value>,
    /// What it changes in the spec; for `unknown` the law that was measured, if there is one.
    pub changes: Option<Changes>,
}

impl Hypothesis {
    /// Whether it is that nothing in the library explains the gap.
    pub fn is_unknown(&self) -> bool {
        self.effects == [UNKNOWN]
    }
}

/// An equation and its part in the gap.
#[derive(Debug, Clone, PartialEq)]
pub struct ShareOf {
    /// Pseudo-velocity.
    pub name: String,
    /// Part of the whitened energy of the gap.
    pub share: f64,
    /// Probability of such a gap by chance.
    pub p_value: f64,
    /// Root of the mean square of the missing force.
    pub rms: f64,
    /// Its unit.
    pub unit: String,
}

/// A window of time in which the gap shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// File of the run.
    pub run: String,
    /// Begin in s.
    pub from: f64,
    /// End in s.
    pub to: f64,
    /// Pseudo-velocity.
    pub equation: String,
    /// Size in standard deviations.
    pub z: f64,
}

/// A region of the state space in which the gap shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Variable.
    pub variable: String,
    /// Where it is.
    pub description: String,
    /// Size in standard deviations.
    pub z: f64,
}

/// Where the gap lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Where {
    /// Force, parameter, actuator, constraint, sensor or none.
    pub domain: &'static str,
    /// Equations, the greatest share first.
    pub equations: Vec<ShareOf>,
    /// Windows of time.
    pub windows: Vec<Window>,
    /// Regions.
    pub region: Vec<Region>,
}

impl Where {
    /// No gap.
    pub(super) fn nowhere() -> Self {
        Self {
            domain: "none",
            equations: Vec::new(),
            windows: Vec::new(),
            region: Vec::new(),
        }
    }
}

/// Errors of predictions on runs that were held out, in units of the noise.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the words of the contract")]
pub struct HowFar {
    pub horizon_s: f64,
    pub nominal: f64,
    pub refitted: f64,
    pub with_effect: f64,
    pub noise_floor: f64,
    pub closed: f64,
    pub closed_ci95: [f64; 2],
    pub closed_vs_refitted: f64,
    /// How the gap divides.
    pub budget: Vec<Share>,
    /// Error of the nominal model on recordings before, in proportion to what it expects there and here.
    pub before: Option<f64>,
    /// Part of the mean square error of the nominal model that the leading hypothesis takes away, and of the
    /// re-fitted one, between quantiles of 2.5 and 97.5 %.
    pub bettered_ci95: [[f64; 2]; 2],
    /// Whether the leading hypothesis predicts worse than the re-fitted model, beyond chance.
    pub is_worse: bool,
    pub runs: Vec<String>,
}

/// The smallest size of an effect that these recordings would show.
#[derive(Debug, Clone, PartialEq)]
pub struct Detectable {
    /// Effect.
    pub effect: String,
    /// Size.
    pub smallest: f64,
    /// Its unit.
    pub unit: String,
}

/// What the best hypothesis leaves: a force or an error that nobody has named.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// Pseudo-velocity of the equation that has the force, or channel that has the error.
    pub place: String,
    /// What it depends on.
    pub variable: String,
    /// Both in words.
    pub about: String,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
    /// What it gains in log-likelihood.
    pub gain: f64,
    /// What the best hypothesis gains over the nominal model.
    pub explained: f64,
}

impl Left {
    /// Whether the recordings speak for it with odds of twenty and more.
    pub fn is_there(&self) -> bool {
        self.log_bayes_factor > TIED
    }
}

/// A channel that the model does not know and on which the gap of the nominal model depends.
#[derive(Debug, Clone, PartialEq)]
pub struct Hint {
    /// The channel, or its rate.
    pub variable: String,
    /// Pseudo-velocity of the equation whose missing force depends on it most.
    pub equation: String,
    /// What such a force would gain in log-likelihood.
    pub gain: f64,
    /// Logarithm of the Bayes factor for it.
    pub log_bayes_factor: f64,
}

/// A member of a hypothesis in a sentence.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Name.
    pub effect: String,
    /// Sentence.
    pub about: String,
}

/// The whole report.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Name of the mechanism.
    pub mechanism: String,
    /// The result in one word.
    pub verdict: GapVerdict,
    /// Whether simulations over windows rank the hypotheses: one-step predictions did not agree with them.
    pub is_by_simulation: bool,
    /// Rows of the runs to fit: those that were fitted, and all.
    pub rows: [usize; 2],
    /// Where the gap lies.
    pub place: Where,
    /// Hypotheses, the most probable first.
    pub which: Vec<Hypothesis>,
    /// Hypotheses that cannot be told apart, each a list of effects.
    pub tied: Vec<Vec<Vec<String>>>,
    /// How far the gap closes; nothing where no run was held out.
    pub how_far: Option<HowFar>,
    /// What these recordings would show.
    pub detectable: Vec<Detectable>,
    /// Hypotheses whose fit failed or ended before an optimum, with the reason.
    pub failed: Vec<(Vec<String>, String)>,
    /// Disturbances before and after: name, level under the nominal model and under the best one.
    pub disturbances: Vec<(String, f64, f64)>,
    /// What the best hypothesis leaves; nothing where no law holds on runs that it was not found in.
    pub left: Option<Left>,
    /// Part of the samples that tell something of their own; less than one where the innovations of
    /// the best hypothesis follow each other.
    pub independent: f64,
    /// What was measured of that; nothing where it is no force that depends on what the model knows.
    pub law: Option<Law>,
    /// What changed; nothing where there are no recordings before.
    pub change: Option<Change>,
    /// Channels that the model does not know and that the gap depends on, the surest first.
    pub hints: Vec<Hint>,
    /// Effects of the best hypothesis in words.
    pub found: Vec<Found>,
    /// Errors over horizons; empty where no run was held out.
    pub horizons: Vec<Ahead>,
    /// What people look at, where they asked for it.
    pub pictures: Option<Pictures>,
    /// What would tell the first two tied hypotheses apart.
    pub experiment: Option<Experiment>,
}

impl Report {
    /// Takes a measured law: what nothing in the library explains has it to write into the spec. A law whose fit
    /// failed is a row.
    pub(super) fn measured<'l>(
        &mut self,
        measured: Option<Result<FittedLaw<'l>, DiagnoseError>>,
    ) -> Result<Option<FittedLaw<'l>>, DiagnoseError> {
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

/// What people look at.
#[derive(Debug, Clone, PartialEq)]
pub struct Pictures {
    /// The missing force of each equation.
    pub force_history: ForceHistory,
    /// Channels of the first run that was held out.
    pub traces: Vec<Trace>,
    /// The missing force; nothing without a gap in the equations.
    pub force_law: Option<ForceLaw>,
}

pub(super) fn assemble(
    bench: &Bench<'_>,
    screen: &Screen,
    comparison: &Comparison,
    place: Where,
    rivals: &[Rival<'_>],
) -> Result<Report, DiagnoseError> {
    let names = |members: &[usize]| -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for name in members.iter().map(|&m| bench.candidate(m).name()) {
            // Components of a vector are one effect.
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    };
    let base = comparison.nominal().evidence.log();
    let known = 1.0 - comparison.unknown;
    let mut which: Vec<Hypothesis> = Vec::new();
    for (fitted, probability) in &comparison.fits {
        let effects = names(&fitted.members);
        // Variants of one effect are one hypothesis.
        if let Some(own) = which.iter_mut().find(|own| own.effects == effects) {
            own.probability += probability * known;
            continue;
        }
        which.push(Hypothesis {
            effects,
            probability: probability * known,
            log_bayes_factor: Some(fitted.evidence.log() - base),
            parameters: values(bench, fitted),
            changes: Some(Changes::of(bench, fitted)?),
        });
    }
    which.push(Hypothesis {
        effects: vec![UNKNOWN.to_owned()],
        probability: comparison.unknown,
        log_bayes_factor: None,
        parameters: Vec::new(),
        changes: None,
    });
    join(&mut which, rivals, bench, comparison)?;
    which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let tied = tied(&which);
    let top = &which[0];
    let verdict = match top.effects.first().map(String::as_str) {
        None => GapVerdict::NoGap,
        Some(UNKNOWN) if tied.is_empty() => GapVerdict::Unexplained,
        Some(_) if tied.is_empty() => GapVerdict::Explained,
        Some(_) => GapVerdict::Ambiguous,
    };
    let cut = which.len().min(TOLD);
    let rest: f64 = which[cut..].iter().map(|h| h.probability).sum();
    let keep: Vec<Hypothesis> = which
        .iter()
        .enumerate()
        .filter(|(i, h)| *i < cut || h.effects.is_empty() || h.is_unknown())
        .map(|(_, h)| h.clone())
        .collect();
    let best = comparison.best();
    let leading = rivals
        .iter()
        .find(|rival| top.effects == [rival.name.clone()]);
    let leads = leading.is_some();
    let found = match leading {
        Some(rival) => vec![Found {
            effect: rival.name.clone(),
            about: format!("the model `{}`", rival.bench.set.mechanism.name),
        }],
        None => found(bench, best),
    };
    Ok(Report {
        mechanism: bench.set.mechanism.name.clone(),
        verdict,
        is_by_simulation: bench.is_over_windows(),
        rows: [0; 2],
        place: if verdict == GapVerdict::NoGap || leads {
            Where::nowhere()
        } else {
            place
        },
        which: if rest < 1e-6 { keep } else { which },
        tied,
        how_far: None,
        detectable: detectable(bench, screen),
        failed: comparison
            .failed
            .iter()
            .map(|(members, reason)| (names(members), reason.clone()))
            .collect(),
        disturbances: disturbances(bench, comparison.nominal(), best),
        left: left(bench, comparison),
        law: None,
        change: None,
        independent: comparison.independent,
        hints: Vec::new(),
        found,
        horizons: Vec::new(),
        pictures: None,
        experiment: None,
    })
}

/// The effects of a hypothesis in words.
fn found(bench: &Bench<'_>, fitted: &Fitted) -> Vec<Found> {
    let members = fitted.members.iter().map(|&member| bench.candidate(member));
    let mut found: Vec<Found> = members
        .map(|candidate| Found {
            effect: candidate.name(),
            about: candidate.about.clone(),
        })
        .collect();
    found.dedup();
    found
}

/// Alternatives beside the hypotheses of the library, each as probable beforehand as one effect.
fn join(
    which: &mut Vec<Hypothesis>,
    rivals: &[Rival<'_>],
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<(), DiagnoseError> {
    let (best, probability) = &comparison.fits[0];
    // Beside certainty nothing is left of 1 − p: what is left of the library speaks for itself.
    let left = comparison.left.as_ref();
    let left = left.map_or(0.0, |left| left.log_bayes_factor.max(0.0)) * comparison.independent;
    let known = probability.ln() + (1.0 - comparison.unknown).ln().max(-left);
    let beside = best.evidence.log() + prior(bench, effects(bench, &best.members));
    let base = comparison.nominal().evidence.log();
    for rival in rivals {
        let odds = tempered(comparison.independent * (rival.log + prior(bench, 1) - beside));
        which.push(Hypothesis {
            effects: vec![rival.name.clone()],
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

/// The leading hypothesis with those that cannot be told from it.
fn tied(which: &[Hypothesis]) -> Vec<Vec<Vec<String>>> {
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
            && (first.probability / other.probability).ln() < TIED
    };
    let group: Vec<&Hypothesis> = which.iter().filter(is_near).collect();
    // Names of one thing share its probability: none of them leads, but all of them together.
    let all: f64 = group.iter().map(|one| one.probability).sum();
    if group.len() > 1 && all >= which[0].probability {
        vec![group.into_iter().map(|one| one.effects.clone()).collect()]
    } else {
        Vec::new()
    }
}

/// Values of the members of a hypothesis.
fn values(bench: &Bench<'_>, fitted: &Fitted) -> Vec<Value> {
    let info = bench.effects.info();
    let deviation = |place: usize| match fitted.fit.deviation(place) {
        Ok(deviation) if !fitted.fit.at_limit[place] => deviation,
        _ => f64::NAN,
    };
    let mut values = Vec::new();
    for &member in &fitted.members {
        let candidate = bench.candidate(member);
        let name = |parameter: &str| format!("{}.{parameter}", candidate.name());
        let own: Vec<usize> = bench
            .own(candidate)
            .into_iter()
            .filter(|(_, part)| *part != Part::Switch)
            .map(|(index, _)| index)
            .collect();
        for (place, free) in fitted.fit.free.iter().enumerate() {
            let value = free.to_value(fitted.fit.coordinates[place]);
            let told = match (free.unknown, candidate.acts) {
                (Unknown::Parameter(index), Acts::Items) if own.contains(&index) => {
                    let quantity = &info.parameters[index];
                    let short = candidate.short(&quantity.name);
                    Some((name(short), quantity.unit.to_string()))
                }
                (Unknown::Parameter(index), Acts::Parameter(_))
                    if info.parameters[index].name == candidate.site.as_str() =>
                {
                    let quantity = &info.parameters[index];
                    Some((name("value"), quantity.unit.to_string()))
                }
                (Unknown::Bias(own), Acts::Bias(channel)) if own == channel => {
                    Some((name("bias"), channel_unit(bench, channel)))
                }
                (Unknown::Scale(own), Acts::Scale(channel)) if own == channel => {
                    Some((name("scale"), "1".to_owned()))
                }
                (Unknown::SensorDelay(own), Acts::Late(channel)) if own == channel => {
                    Some((name("delay"), "s".to_owned()))
                }
                (Unknown::Lag(_), Acts::Lag(_)) => Some((name("time_constant"), "s".to_owned())),
                (Unknown::InputDelay(_), Acts::Delay(_)) => Some((name("delay"), "s".to_owned())),
                _ => None,
            };
            if let Some((name, unit)) = told {
                let scale = match free.unknown {
                    Unknown::Parameter(index) => info.parameters[index].scale,
                    _ => 1.0,
                };
                let stretch = match free.coordinate {
                    appell_estimate::Coordinate::Plain => 1.0,
                    appell_estimate::Coordinate::Logarithm => value,
                };
                values.push(Value {
                    name,
                    value: value / scale,
                    std: deviation(place) * stretch / scale,
                    unit,
                });
            }
        }
    }
    values
}

/// SI unit of a measured channel.
fn channel_unit(bench: &Bench<'_>, channel: usize) -> String {
    let measured = bench.set.measured(bench.effects.info());
    let Some((channel, _)) = measured.get(channel) else {
        return String::new();
    };
    let unit = &channel.unit;
    let si = appell_spec::units::Unit::si(unit.dimension).text;
    // An angle has no dimension, but people know it by its name.
    match si.as_str() {
        "1" if unit.has_angle() => "rad".to_owned(),
        "1/s" if unit.has_angle() => "rad/s".to_owned(),
        _ => si,
    }
}

/// What the gap of the nominal model depends on beside the quantities of the model.
pub(super) fn hints(
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<Vec<Hint>, DiagnoseError> {
    let info = bench.effects.info();
    let hints = unknown::hints(bench, comparison.nominal())?.into_iter();
    Ok(hints
        .map(|one| Hint {
            equation: info.states[one.place].name.to_string(),
            variable: one.variable,
            gain: one.gain,
            log_bayes_factor: one.log_bayes_factor,
        })
        .collect())
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
        gain: first.gain,
        explained: comparison.explained(),
    })
}

fn disturbances(bench: &Bench<'_>, nominal: &Fitted, best: &Fitted) -> Vec<(String, f64, f64)> {
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

/// What each effect would need to be seen.
fn detectable(bench: &Bench<'_>, screen: &Screen) -> Vec<Detectable> {
    let info = bench.effects.info();
    let mut told: Vec<Detectable> = Vec::new();
    let mut list: Vec<_> = screen.list.iter().collect();
    list.sort_by_key(|one| one.candidate);
    for one in list {
        let candidate = bench.candidate(one.candidate);
        let name = candidate.name();
        let Some(&deviation) = one.deviations.first() else {
            continue;
        };
        if deviation <= 0.0 || told.iter().any(|own| own.effect == name) {
            continue;
        }
        let parameter = match candidate.acts {
            Acts::Items => bench.own(candidate).first().map(|(index, _)| *index),
            Acts::Parameter(_) => info.parameter_index(&candidate.site),
            _ => None,
        };
        let (scale, unit) = match (candidate.acts, parameter) {
            (_, Some(index)) => {
                let quantity = &info.parameters[index];
                (quantity.scale, quantity.unit.to_string())
            }
            (Acts::Bias(channel), _) => (1.0, channel_unit(bench, channel)),
            (Acts::Lag(_) | Acts::Delay(_) | Acts::Late(_), _) => (1.0, "s".to_owned()),
            _ => (1.0, "1".to_owned()),
        };
        told.push(Detectable {
            effect: name,
            smallest: DETECTABLE * deviation / scale,
            unit,
        });
    }
    told
}
