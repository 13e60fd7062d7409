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
/// Disturbances as parts of those that were fitted, which follow what the model lacks.
const LEVELS: [f64; 2] = [1.0, 0.6];

fn quiet(
    estimation: &Estimation<'_>,
    fitted: &Fitted,
    level: f64,
) -> Result<Fitted, DiagnoseError> {
    let mut quiet = fitted.clone();
    quieten(estimation, &mut quiet.fit.values, level)?;
    Ok(quiet)
}

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
}

/// What a hypothesis leaves that a law without a name explains; nothing where no law generalises
/// other runs.
pub(super) fn leftover(
    bench: &Bench<'_>,
    fitted: &Fitted,
) -> Result<Option<Leftover>, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let [mut smooth, mut single] = [const { Family::new() }; 2];
    for dependence in Dependence::all(bench) {
        for along in [Along::Disturbances, Along::Channels] {
            let is_possible = match along {
                Along::Disturbances => dependence.is_of_forces(),
                Along::Channels => dependence.is_of_channels(),
            };
            if !is_possible {
                continue;
            }
            let mut base = None;
            for &level in &LEVELS {
                let quiet = quiet(&estimation, fitted, level)?;
                let Ok(scores) = wave_scores((bench, &estimation), &quiet, dependence, along)
                else {
                    continue;
                };
                for (place, wave_scores) in scores {
                    let base = *base.get_or_insert(wave_scores.log_likelihood);
                    let offset = wave_scores.log_likelihood - base;
                    let unnamed = |wave, law: LawGain| {
                        let on = (On::Variable(wave), dependence.name(bench));
                        unnamed(on, (along, place), law.beside(offset))
                    };
                    smooth.add(wave_scores.smooth().map(|law| unnamed(None, law)));
                    for wave in 0..dependence.waves(along) {
                        let law = wave_scores.single(wave);
                        single.add(law.map(|law| unnamed(Some(wave), law)));
                    }
                }
            }
        }
    }
    let memory = with_memory((bench, &estimation), fitted)?;
    Ok(joined([smooth, single, memory]))
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
