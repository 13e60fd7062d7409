//! Nonparametric laws outside the library: a force in an equation or an error of a channel, as a function of a
//! position, a rate, an input, or a recorded channel that is not in the model. A law is a sum of harmonics of the
//! variable whose prior amplitudes decrease like those of a law with a step, or a single harmonic. Fitted in addition to
//! the best hypothesis, they describe its residual and the variable on which it depends. Forces may also have a hidden
//! state: an oscillating mass, friction with presliding displacement.
//!
//! A law has to predict runs to which it was not fitted: a force that is no function of the state is process noise.
//! A drift has to be the same in every run.

mod dependence;
mod hidden;
mod memory;
mod series;

use appell_estimate::{Along, Disturbance, Estimation, Shapes, in_parallel};
use appell_runtime::model::At;

use super::calibration::TIED;
use super::evidence::log_sum;
use super::gram::{ByRun, moving, priors};
use super::starts::scale_process_noise;
use super::{Bench, Fitted, Hint, Result};
use crate::effects::Memory;

pub(super) use dependence::Dependence;
use memory::Memories;
pub(super) use series::{LawGain, Series, TermScores};

/// Smallest cross-validated gain of a law relative to its gain on all runs.
const REPEATED: f64 = 0.5;
/// Process noise absorbs missing effects. The laws with the largest gains are therefore evaluated again with process
/// noise reduced by this factor each time, while that increases the largest gain, at most so many times.
const LEVELS: usize = 7;
const QUIETER: f64 = 0.55;
const MOST: usize = 8;

/// A nonparametric law with its expected gain in addition to a hypothesis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unnamed {
    /// Whether it is a force or an error of a channel.
    pub(super) along: Along,
    /// Index of the pseudo-velocity in whose equation it acts, or of the channel.
    pub(super) place: usize,
    /// Its variable, also in words.
    pub(super) on: On,
    pub(super) variable: String,
    pub(super) gains: LawGain,
}

/// The variable of a law.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum On {
    /// A variable; with the number of a single harmonic.
    Variable(Option<usize>),
    /// A hidden state, with a first estimate of its coefficients.
    Memory(Memory),
}

/// The laws for the residual of a hypothesis.
#[derive(Debug, Clone)]
pub(super) struct Leftover {
    /// The most probable one.
    pub(super) first: Unnamed,
    /// Log Bayes factor for any of them, all with the same prior.
    pub(super) log_bayes_factor: f64,
    /// The same with the process noise of the fit alone: less process noise may also favour other hypotheses.
    pub(super) beside_fitted: f64,
}

/// The laws for the residual of a hypothesis; `None` if no law generalises to other runs.
pub(super) fn leftover(bench: &Bench<'_>, fitted: &Fitted) -> Result<Option<Leftover>> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let mut families = [const { Family::new() }; 2];
    let (mut kinds, mut base) = (kinds(bench), None);
    let gains = of_variables(bench, &estimation, fitted, &kinds, &mut base, &mut families)?;
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    order.sort_by(|&a, &b| gains[b].total_cmp(&gains[a]));
    order.truncate(MOST);
    kinds = order.iter().map(|&place| kinds[place]).collect();
    let memory = with_memory(bench, &estimation, fitted)?;
    // The reported law is that with the process noise of the fit.
    let [smooth, single] = families.clone();
    let told = joined([smooth, single, memory.clone()]);
    let mut best = order
        .first()
        .map_or(f64::NEG_INFINITY, |&place| gains[place]);
    let mut quiet = fitted.clone();
    // Over windows there is none.
    let levels = if bench.is_over_windows() { 0 } else { LEVELS };
    for _ in 0..levels {
        scale_process_noise(&estimation, &mut quiet.fit.values, QUIETER)?;
        // With less process noise the filter may diverge.
        let Ok(gains) = of_variables(bench, &estimation, &quiet, &kinds, &mut base, &mut families)
        else {
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

/// The variables of laws, each with the kind of their effect, forces or errors of channels.
fn kinds<'b>(bench: &'b Bench<'_>) -> Vec<(Dependence<'b>, Along)> {
    let all = Dependence::all(bench).into_iter();
    all.flat_map(|one| {
        let forces = one.is_of_forces().then_some((one, Along::Disturbances));
        let channels = one.is_of_channels().then_some((one, Along::Channels));
        forces.into_iter().chain(channels)
    })
    .collect()
}

/// Adds the laws of variables with the process noise of a fit. Gains are relative to the log likelihood of the first
/// call, with the fitted process noise, which is stored in `base`. Returns the greatest gain of each kind.
fn of_variables(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    fitted: &Fitted,
    kinds: &[(Dependence<'_>, Along)],
    base: &mut Option<f64>,
    [smooth, single]: &mut [Family; 2],
) -> Result<Vec<f64>> {
    let mut gains = vec![f64::NEG_INFINITY; kinds.len()];
    for batch in batches(estimation, kinds) {
        let along = kinds[batch[0]].1;
        let own: Vec<Dependence<'_>> = batch.iter().map(|&place| kinds[place].0).collect();
        let of_batch = wave_scores(bench, estimation, fitted, &own, along)?;
        for (number, scores) in batch.into_iter().zip(of_batch) {
            let dependence = kinds[number].0;
            for (place, wave_scores) in scores {
                let base = *base.get_or_insert(wave_scores.log_likelihood);
                let offset = wave_scores.log_likelihood - base;
                let best = &mut gains[number];
                let mut unnamed = |wave, law: LawGain| {
                    let law = law.beside(offset);
                    *best = best.max(law.gain);
                    let on = On::Variable(wave);
                    unnamed(on, dependence.name(bench), along, place, law)
                };
                smooth.add(wave_scores.smooth().map(|law| unnamed(None, law)));
                for wave in 0..dependence.waves(along) {
                    let law = wave_scores.single(wave);
                    single.add(law.map(|law| unnamed(Some(wave), law)));
                }
            }
        }
    }
    Ok(gains)
}

/// Kinds of laws that one pass of the filter evaluates together.
fn batches(estimation: &Estimation<'_>, kinds: &[(Dependence<'_>, Along)]) -> Vec<Vec<usize>> {
    /// Columns of a pass, for its memory.
    const COLUMNS: usize = 600;
    let setup = estimation.setup();
    let mut batches: Vec<Vec<usize>> = Vec::new();
    for along in [Along::Disturbances, Along::Channels] {
        let places = match along {
            Along::Disturbances => setup.disturbances.len(),
            Along::Channels => setup.channels.len(),
        };
        let mut room = 0;
        for (number, (dependence, _)) in
            kinds.iter().enumerate().filter(|(_, kind)| kind.1 == along)
        {
            let columns = 2 * dependence.waves(along) * places;
            match batches.last_mut() {
                Some(batch) if columns <= room => {
                    batch.push(number);
                    room -= columns;
                }
                _ => {
                    batches.push(vec![number]);
                    room = COLUMNS.saturating_sub(columns);
                }
            }
        }
    }
    batches
}

/// The same for forces with a hidden state only: like effects they have few parameters, whereas a law of a variable is
/// an arbitrary function.
pub(super) fn remembered(bench: &Bench<'_>, fitted: &Fitted) -> Result<Option<Leftover>> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let memory = with_memory(bench, &estimation, fitted)?;
    Ok(joined([Family::new(), Family::new(), memory]))
}

/// Forces with a hidden state.
fn with_memory(bench: &Bench<'_>, estimation: &Estimation<'_>, fitted: &Fitted) -> Result<Family> {
    let mut family = Family::new();
    for memories in Memories::all(bench) {
        let write = |run: usize, at: At<'_>, values: &mut [f64]| memories.at(run, at, values);
        let shapes = Shapes {
            along: Along::Disturbances,
            count: memories.count(),
            values: &write,
        };
        let of_memories = term_scores(bench, estimation, fitted, shapes, &[shapes.count])?;
        for (place, scores) in of_memories.into_iter().flatten() {
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
                    unnamed(on, memories.name(number), Along::Disturbances, place, law)
                };
                family.add(law.filter(|_| best == Some(number)).map(unnamed));
            }
        }
    }
    Ok(family)
}

/// A law of a variable in an equation or a channel.
fn unnamed(on: On, variable: String, along: Along, place: usize, gains: LawGain) -> Unnamed {
    Unnamed {
        along,
        place,
        on,
        variable,
        gains,
    }
}

/// The scores of the harmonics of each variable for the force in each equation, or for the error of each channel.
pub(super) fn wave_scores(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    fitted: &Fitted,
    dependences: &[Dependence<'_>],
    along: Along,
) -> Result<Vec<Vec<(usize, TermScores)>>> {
    let model = estimation.setup().model;
    let counts = dependences.iter().map(|own| 2 * own.waves(along));
    let counts: Vec<usize> = counts.collect();
    let write = |run: usize, at: At<'_>, mut values: &mut [f64]| {
        for (dependence, count) in dependences.iter().zip(&counts) {
            let (own, rest) = values.split_at_mut(*count);
            dependence.waves_at(bench, model, run, at, own);
            values = rest;
        }
    };
    let shapes = Shapes {
        along,
        count: counts.iter().sum(),
        values: &write,
    };
    term_scores(bench, estimation, fitted, shapes, &counts)
}

/// The same for groups of any terms, with the number of terms of each.
pub(super) fn term_scores(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    fitted: &Fitted,
    shapes: Shapes<'_>,
    groups: &[usize],
) -> Result<Vec<Vec<(usize, TermScores)>>> {
    let (free, setup) = (moving(&fitted.fit), estimation.setup());
    let (along, count) = (shapes.along, shapes.count);
    // The command of a controller is correlated with the error of the filter: impulses in proportion to its innovation
    // are nuisance directions of every law.
    let kicks = match along {
        Along::Disturbances => bench.input_innovations.kick_count(),
        Along::Channels => 0,
    };
    let with_kicks = |run: usize, at: At<'_>, to: &mut [f64]| {
        let (own, impulses) = to.split_at_mut(count);
        (shapes.values)(run, at, own);
        bench.input_innovations.kicks(run, at.t, impulses);
    };
    let block = count + kicks;
    let all = Shapes {
        along,
        count: block,
        values: &with_kicks,
    };
    let tangent = estimation.tangent(&fitted.fit.values, &free, Some(all))?;
    let added = free.len()..tangent.slopes.nrows();
    // Their variance is at most that of the error of the filter.
    let of_kicks = added.clone().zip(&tangent.added_squares);
    let of_kicks = of_kicks
        .filter(|(column, _)| (column - added.start) % block.max(1) >= count)
        .map(|(column, square)| (column, Some([0.0, square.sqrt()])));
    let nuisances: Vec<_> = (0..).zip(priors(&fitted.fit)).chain(of_kicks).collect();
    let Some(by_run) = ByRun::new(&tangent, bench.weight, &nuisances) else {
        return Ok(groups.iter().map(|_| Vec::new()).collect());
    };
    let places: Vec<(usize, usize)> = match along {
        Along::Disturbances => (setup.disturbances.iter().enumerate())
            .filter_map(|(number, one)| match *one {
                Disturbance::Force(equation) => Some((number, equation)),
                Disturbance::Rate(_) => None,
            })
            .collect(),
        Along::Channels => (0..setup.channels.len()).map(|own| (own, own)).collect(),
    };
    let mut before = 0;
    let of_groups = groups.iter().map(|&terms| {
        let first = before;
        before += terms;
        in_parallel(places.clone(), |(number, place)| {
            let first = free.len() + number * block + first;
            (place, TermScores::new(&by_run, first..first + terms))
        })
    });
    Ok(of_groups.collect())
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
        let generalises = |one: &Unnamed| one.gains.cross_validated > REPEATED * one.gains.gain;
        self.found.extend(unnamed.filter(generalises));
    }
}

/// All kinds have the same prior probability, and so have all laws of a kind.
fn joined<const KINDS: usize>(families: [Family; KINDS]) -> Option<Leftover> {
    let weighed = families.into_iter().flat_map(|family| {
        let weight = -((KINDS * family.tried.max(1)) as f64).ln();
        let found = family.found.into_iter();
        found.map(move |one| (one.gains.log_bayes_factor + weight, one))
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

/// Channels outside the model on which the gap of a hypothesis depends, each with the equation of the strongest
/// dependence: those with odds of at least twenty, corrected for the number tried.
pub(super) fn hints(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Hint>> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let along = Along::Disturbances;
    let log = |one: &Unnamed| one.gains.log_bayes_factor;
    let mut found = Vec::new();
    let mut tried = 0;
    for dependence in bench.unmodelled.iter().map(Dependence::unmodelled) {
        let mut family = Family::new();
        let scores = wave_scores(bench, &estimation, fitted, &[dependence], along)?;
        for (place, wave_scores) in scores.into_iter().flatten() {
            let law = wave_scores.smooth();
            let variable = dependence.name(bench);
            let unnamed = |law| unnamed(On::Variable(None), variable, along, place, law);
            family.add(law.map(unnamed));
        }
        tried += family.tried;
        let all = family.found.into_iter();
        found.extend(all.max_by(|a, b| log(a).total_cmp(&log(b))));
    }
    let least = TIED + (tried.max(1) as f64).ln();
    found.retain(|one| log(one) > least);
    found.sort_by(|a, b| log(b).total_cmp(&log(a)));
    let hints = found.into_iter().map(|one| Hint {
        equation: bench.effects.info().states[one.place].name.to_string(),
        variable: one.variable,
        gain: one.gains.gain,
        log_bayes_factor: one.gains.log_bayes_factor,
    });
    Ok(hints.collect())
}
