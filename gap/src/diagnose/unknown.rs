//! What nobody has named: a force in an equation or an error of a channel, as a law of a position, a
//! rate, an input, or a channel that was recorded beside them. A law is a sum of waves of the variable
//! whose sizes fall off as those of a law with a step do, or one wave alone. About the best hypothesis
//! they tell what it leaves and on what that depends. Forces may also remember: a mass that swings by itself,
//! friction that gives way before it slides.
//!
//! A law has to predict runs that it was not found in: what does not return with the state is a disturbance,
//! and there are levels for these. What walks in time has to walk alike in every run.

mod dependence;
mod hysteresis;
mod memory;
mod series;
mod swing;
mod trace;

use appell_estimate::{Along, Disturbance, Estimation, Shapes, in_parallel};
use appell_runtime::model::At;

use super::DiagnoseError;
use super::bench::Bench;
use super::calibration::TIED;
use super::evidence::Fitted;
use super::evidence::log_sum;
use super::nuisance::moving;
use super::screen::{Projected, quieten};
use crate::effects::Memory;

pub(super) use dependence::Dependence;
use memory::Memories;
pub(super) use series::{LawGain, Series, TermScores};

/// Part of its gain that a law has to repeat on runs that it was not found in.
const REPEATED: f64 = 0.5;
/// Disturbances follow what the model lacks. The laws that gained most are looked for again beside disturbances that
/// are quieter by this part each time, as long as the best one gains by it, no more often than this.
const LEVELS: usize = 7;
const QUIETER: f64 = 0.55;
const MOST: usize = 8;

/// What a law that nobody has named would gain beside a hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unnamed {
    /// What it adds to.
    pub(super) along: Along,
    /// Index of the pseudo-velocity whose equation has it, or of the channel.
    pub(super) place: usize,
    /// On what it depends, also in words.
    pub(super) on: On,
    pub(super) variable: String,
    /// Gain in log-likelihood.
    pub(super) gain: f64,
    /// Gain on runs that it was not found in.
    pub(super) cross_validated: f64,
    /// Logarithm of the Bayes factor for it.
    pub(super) log_bayes_factor: f64,
}

/// On what a law depends.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum On {
    /// On a variable; with the number of its wave, if that is one alone.
    Variable(Option<usize>),
    /// On what was before, with a first estimate of its numbers.
    Memory(Memory),
}

/// All of them together.
#[derive(Debug, Clone)]
pub(super) struct Leftover {
    /// The one that the recordings speak for most.
    pub(super) first: Unnamed,
    /// Logarithm of the Bayes factor for any of them, all alike beforehand.
    pub(super) log_bayes_factor: f64,
    /// The same beside the disturbances of the fit alone: disturbances may also be quieter beside other hypotheses.
    pub(super) beside_fitted: f64,
}

/// What a hypothesis leaves that a law without a name explains; nothing where no law generalises
/// other runs.
pub(super) fn leftover(
    bench: &Bench<'_>,
    fitted: &Fitted,
) -> Result<Option<Leftover>, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let mut families = [const { Family::new() }; 2];
    let (mut kinds, mut base) = (kinds(bench), None);
    let gains = of_variables(
        (bench, &estimation),
        fitted,
        &kinds,
        &mut base,
        &mut families,
    )?;
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    order.sort_by(|&a, &b| gains[b].total_cmp(&gains[a]));
    order.truncate(MOST);
    kinds = order.iter().map(|&place| kinds[place]).collect();
    let memory = with_memory((bench, &estimation), fitted)?;
    // The law that is told is one beside the disturbances of the fit.
    let [smooth, single] = families.clone();
    let told = joined([smooth, single, memory.clone()]);
    let mut best = order
        .first()
        .map_or(f64::NEG_INFINITY, |&place| gains[place]);
    let mut quiet = fitted.clone();
    for _ in 0..LEVELS {
        quieten(&estimation, &mut quiet.fit.values, QUIETER)?;
        // A filter that trusts the model more may lose a run.
        let Ok(gains) = of_variables(
            (bench, &estimation),
            &quiet,
            &kinds,
            &mut base,
            &mut families,
        ) else {
            break;
        };
        let gain = gains.into_iter().fold(f64::NEG_INFINITY, f64::max);
        if gain <= best {
            break;
        }
        best = gain;
    }
    let [smooth, single] = families;
    let all = joined([smooth, single, memory]);
    Ok(all.map(|all| {
        let beside_fitted = told.as_ref().map_or(0.0, |told| told.log_bayes_factor);
        let first = told.map(|told| told.first);
        Leftover {
            first: first.unwrap_or_else(|| all.first.clone()),
            beside_fitted,
            ..all
        }
    }))
}

/// What laws of variables may depend on, and what they may add to.
fn kinds<'b>(bench: &'b Bench<'_>) -> Vec<(Dependence<'b>, Along)> {
    let all = Dependence::all(bench).into_iter();
    all.flat_map(|one| {
        let forces = one.is_of_forces().then_some((one, Along::Disturbances));
        let channels = one.is_of_channels().then_some((one, Along::Channels));
        forces.into_iter().chain(channels)
    })
    .collect()
}

/// Adds the laws of variables beside the disturbances of a fit. They gain over what the recordings are worth with the
/// disturbances that were fitted, which is `base` from the first law on. Returns the greatest gain of each kind.
fn of_variables(
    (bench, estimation): (&Bench<'_>, &Estimation<'_>),
    fitted: &Fitted,
    kinds: &[(Dependence<'_>, Along)],
    base: &mut Option<f64>,
    [smooth, single]: &mut [Family; 2],
) -> Result<Vec<f64>, DiagnoseError> {
    let mut gains = Vec::with_capacity(kinds.len());
    for &(dependence, along) in kinds {
        let mut best = f64::NEG_INFINITY;
        let scores = wave_scores((bench, estimation), fitted, dependence, along)?;
        for (place, wave_scores) in scores {
            let base = *base.get_or_insert(wave_scores.log_likelihood);
            let offset = wave_scores.log_likelihood - base;
            let mut unnamed = |wave, law: LawGain| {
                let law = law.beside(offset);
                best = best.max(law.gain);
                let on = (On::Variable(wave), dependence.name(bench));
                unnamed(on, (along, place), law)
            };
            smooth.add(wave_scores.smooth().map(|law| unnamed(None, law)));
            for wave in 0..dependence.waves(along) {
                let law = wave_scores.single(wave);
                single.add(law.map(|law| unnamed(Some(wave), law)));
            }
        }
        gains.push(best);
    }
    Ok(gains)
}

/// The same of forces that depend on what was before: they have few numbers, as effects do, where a law of a
/// variable may be any function.
pub(super) fn remembered(
    bench: &Bench<'_>,
    fitted: &Fitted,
) -> Result<Option<Leftover>, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let memory = with_memory((bench, &estimation), fitted)?;
    Ok(joined([Family::new(), Family::new(), memory]))
}

/// Forces that depend on what was before.
fn with_memory(
    (bench, estimation): (&Bench<'_>, &Estimation<'_>),
    fitted: &Fitted,
) -> Result<Family, DiagnoseError> {
    let mut family = Family::new();
    for memories in Memories::all(bench) {
        let write = |run: usize, at: At<'_>, values: &mut [f64]| memories.at(run, at, values);
        let shapes = Shapes {
            along: Along::Disturbances,
            count: memories.count(),
            values: &write,
        };
        for (place, scores) in term_scores((bench, estimation), fitted, shapes)? {
            let laws: Vec<Option<LawGain>> = (0..memories.len())
                .map(|number| scores.of(&memories.terms(number)))
                .collect();
            let gain = |law: &Option<LawGain>| law.as_ref().map_or(0.0, |law| law.gain);
            let best = Memories::best(&laws.iter().map(gain).collect::<Vec<_>>());
            for (number, law) in laws.into_iter().enumerate() {
                let unnamed = |law| {
                    let term = scores.sizes(&memories.terms(number));
                    let term = term.map_or(0.0, |sizes| sizes[0]);
                    let on = On::Memory(memories.first(number, term));
                    unnamed(
                        (on, memories.name(number)),
                        (Along::Disturbances, place),
                        law,
                    )
                };
                family.add(law.filter(|_| best == Some(number)).map(unnamed));
            }
        }
    }
    Ok(family)
}

/// A law of a dependence at a place.
fn unnamed((on, variable): (On, String), (along, place): (Along, usize), law: LawGain) -> Unnamed {
    Unnamed {
        along,
        place,
        on,
        variable,
        gain: law.gain,
        cross_validated: law.cross_validated,
        log_bayes_factor: law.log_bayes_factor,
    }
}

/// What the waves of a dependence tell of the force in each equation, or of the error of each channel.
pub(super) fn wave_scores(
    (bench, estimation): (&Bench<'_>, &Estimation<'_>),
    fitted: &Fitted,
    dependence: Dependence<'_>,
    along: Along,
) -> Result<Vec<(usize, TermScores)>, DiagnoseError> {
    let model = estimation.setup().model;
    let write = |run: usize, at: At<'_>, values: &mut [f64]| {
        dependence.waves_at((bench, model), run, at, values);
    };
    let shapes = Shapes {
        along,
        count: 2 * dependence.waves(along),
        values: &write,
    };
    term_scores((bench, estimation), fitted, shapes)
}

/// The same of any terms.
pub(super) fn term_scores(
    (bench, estimation): (&Bench<'_>, &Estimation<'_>),
    fitted: &Fitted,
    shapes: Shapes<'_>,
) -> Result<Vec<(usize, TermScores)>, DiagnoseError> {
    let (free, setup) = (moving(&fitted.fit), estimation.setup());
    let (along, count) = (shapes.along, shapes.count);
    let tangent = estimation.tangent(&fitted.fit.values, &free, Some(shapes))?;
    let projected = Projected::new((&tangent, bench.weight), fitted, free.len(), 0..0);
    let places: Vec<Option<usize>> = match along {
        Along::Disturbances => (setup.disturbances.iter())
            .map(|one| match *one {
                Disturbance::Force(equation) => Some(equation),
                Disturbance::Rate(_) => None,
            })
            .collect(),
        Along::Channels => (0..setup.channels.len()).map(Some).collect(),
    };
    let places: Vec<_> = places.into_iter().enumerate().collect();
    let scores = in_parallel(places, |(block, place)| {
        let first = free.len() + block * count;
        let columns: Vec<usize> = (first..first + count).collect();
        Some((
            place?,
            TermScores::new(&projected, &projected.slopes(&columns)),
        ))
    });
    Ok(scores.into_iter().flatten().collect())
}

/// Laws of one kind.
#[derive(Clone)]
struct Family {
    tried: usize,
    found: Vec<Unnamed>,
}

impl Family {
    const fn new() -> Self {
        Self {
            tried: 0,
            found: Vec::new(),
        }
    }

    fn add(&mut self, unnamed: Option<Unnamed>) {
        self.tried += 1;
        let generalises = |one: &Unnamed| one.cross_validated > REPEATED * one.gain;
        self.found.extend(unnamed.filter(generalises));
    }
}

/// All kinds are as probable beforehand, and so are the laws of a kind.
fn joined<const KINDS: usize>(families: [Family; KINDS]) -> Option<Leftover> {
    let weighed = families.into_iter().flat_map(|family| {
        let weight = -((KINDS * family.tried.max(1)) as f64).ln();
        let found = family.found.into_iter();
        found.map(move |one| (one.log_bayes_factor + weight, one))
    });
    let all: Vec<(f64, Unnamed)> = weighed.collect();
    let log = log_sum(all.iter().map(|(log, _)| *log));
    let first = all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Leftover {
        first: first.1,
        log_bayes_factor: log,
        beside_fitted: log,
    })
}

/// Channels that the model does not know and on which the gap of a hypothesis depends, each with the
/// place where it shows most: one false one in twenty.
pub(super) fn hints(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Unnamed>, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let along = Along::Disturbances;
    let mut found = Vec::new();
    let mut tried = 0;
    for dependence in bench.unmodelled.iter().map(Dependence::unmodelled) {
        let mut family = Family::new();
        let scores = wave_scores((bench, &estimation), fitted, dependence, along)?;
        for (place, wave_scores) in scores {
            let law = wave_scores.smooth();
            let on = (On::Variable(None), dependence.name(bench));
            let unnamed = |law| unnamed(on, (along, place), law);
            family.add(law.map(unnamed));
        }
        tried += family.tried;
        let log = |one: &Unnamed| one.log_bayes_factor;
        let all = family.found.into_iter();
        found.extend(all.max_by(|a, b| log(a).total_cmp(&log(b))));
    }
    let least = TIED + (tried.max(1) as f64).ln();
    found.retain(|one| one.log_bayes_factor > least);
    found.sort_by(|a, b| b.log_bayes_factor.total_cmp(&a.log_bayes_factor));
    Ok(found)
}
