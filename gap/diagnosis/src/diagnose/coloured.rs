//! Process noise with memory.
//!
//! A gust lasts for many rows, and a controller answers it: with white process noise its command seems to act too
//! weakly, too late, or on another coordinate (L. Ljung, *System Identification*, 2nd edition, 1999, section 13.4, on
//! the bias of closed loops with a wrong noise model). The most probable hypotheses are therefore fitted once more with
//! a random-walk force along every pseudo-velocity.

use appell_estimate::{Disturbance, Estimation, Fit, Free, Setup, Unknown};

use super::evidence::Evidence;
use super::feedback::for_kicks;
use super::localise::force_unit;
use super::starts::likeliest;
use super::{Bench, Comparison, Fitted, Result};
use crate::effects::Candidate;

/// Number of hypotheses that are fitted again, in addition to the nominal model.
const COMPARED: usize = 2;
/// Initial rates of the forces that are tried, relative to the forces of the mechanism over one second.
const RATES: [f64; 3] = [0.01, 0.1, 1.0];
/// A fit is given up where it stays below the log posterior without these forces by more than this.
const SLACK: f64 = 2.0;
/// The largest rate relative to these forces; the range of a level ends there.
const LARGEST: f64 = 1e3;

/// The comparison with the better of both kinds of process noise for each of these hypotheses.
pub(super) fn weighed(bench: &Bench<'_>, mut comparison: Comparison) -> Result<Comparison> {
    let mut compared: Vec<usize> = (0..comparison.fits.len().min(COMPARED)).collect();
    if !compared.contains(&comparison.nominal) {
        compared.push(comparison.nominal);
    }
    // The model of an additional coordinate has no other forces: then the others would gain alone.
    let brings = |&place: &usize| {
        let mut members = comparison.fits[place].0.members.iter();
        members.any(|&member| bench.candidate(member).brings.is_some())
    };
    if compared.iter().any(brings) {
        return Ok(comparison);
    }
    let mut gains = Vec::new();
    for &place in &compared {
        // Where the filter of one of them diverges, this noise compares nothing.
        let Ok(gain) = gain(bench, &comparison.fits[place].0) else {
            return Ok(comparison);
        };
        gains.push(gain.max(0.0));
    }
    if gains.iter().all(|gain| *gain <= 0.0) {
        return Ok(comparison);
    }
    for (place, gain) in compared.into_iter().zip(gains) {
        let fitted = &mut comparison.fits[place].0;
        fitted.coloured = gain;
        fitted.evidence.log_likelihood += gain;
    }
    comparison.again(bench)
}

/// The gain in log evidence of a hypothesis by coloured process noise.
fn gain(bench: &Bench<'_>, base: &Fitted) -> Result<f64> {
    let mechanism = &bench.effects.mechanism;
    let walking = bench.effects.info().states[..bench.effects.info().speeds]
        .iter()
        .enumerate()
        .map(|(place, speed)| {
            let unit = force_unit(mechanism, place).replace(' ', "*");
            let size = [("1".to_owned(), unit, [0.0, 1.0])];
            Candidate::measured(mechanism, &speed.name, "{law}_1", &size)
        });
    let members = base.members.iter().map(|&member| bench.candidate(member));
    let effects = bench
        .effects
        .again(members.cloned().chain(walking).collect())?;
    let other = bench.beside(&effects)?;
    let all: Vec<usize> = (0..effects.candidates.len()).collect();
    let mut setup = other.setup(&all);
    let walks = walk(&mut setup, &other);
    let estimation = Estimation::new(&setup, &other.recordings)?;
    let start = begun(bench, base, &estimation, &walks)?;
    let mut own = all;
    own.retain(|&one| !effects.candidates[one].is_measured());
    let mut free = other.free(&own, &setup);
    free.extend(walks.iter().map(|walk| walk.free));
    // Without the gain by impulses of inputs, which differs little.
    let floor = base.fit.log_posterior - SLACK;
    let fit = other.weighed(&estimation, &start, &free, Fit::quick, other.above(floor))?;
    let by_inputs = for_kicks(&other.input_innovations, other.weight, &estimation, &fit)?;
    Ok(Evidence::of(&other, &own, &fit, by_inputs).log() - base.evidence.log())
}

/// The rate of a force that walks, and the index of its state.
struct Walk {
    free: Free,
    state: usize,
}

/// Lets the measured forces of a model walk at random, with rates in the ranges of the white process noise.
fn walk(setup: &mut Setup<'_>, bench: &Bench<'_>) -> Vec<Walk> {
    let info = setup.model.info();
    let lags = setup.channels.iter().filter(|channel| channel.lags).count();
    let first = info.state_len() + setup.lagging.len() + lags;
    let candidates = bench.effects.candidates.iter();
    let forces = candidates.filter(|one| one.is_measured());
    let places = forces.flat_map(|one| bench.own(one));
    let range = |equation: usize| {
        let mut levels = bench.problem.levels.iter();
        let level = levels.find(|level| level.unknown == Unknown::Disturbance(equation));
        level.map_or([0.0, f64::INFINITY], |level| level.range)
    };
    let mut walks = Vec::new();
    for (index, (place, _)) in places.enumerate() {
        let [low, high] = range(index);
        let level = Unknown::Disturbance(setup.disturbances.len());
        setup.drifting.push(place);
        setup.disturbances.push(Disturbance::Rate(first + index));
        walks.push(Walk {
            free: Free::of(level).within(low, high),
            state: first + index,
        });
    }
    walks
}

/// The values of a hypothesis, with the most likely of some rates of the forces.
fn begun(
    bench: &Bench<'_>,
    base: &Fitted,
    estimation: &Estimation<'_>,
    walks: &[Walk],
) -> Result<Vec<f64>> {
    let layout = estimation.layout();
    let start = bench.carried_by_name(base, estimation);
    let with_rate = |rate: f64| -> Result<Vec<f64>> {
        let mut values = start.clone();
        for &Walk { free, state } in walks {
            let level = rate * free.range[1] / LARGEST;
            values[layout.place(free.unknown)?] = level;
            for run in 0..estimation.recordings().len() {
                values[layout.place(Unknown::Initial { run, state })?] = 0.0;
                // The standard deviation of its change in one second.
                values[layout.place(Unknown::Spread { run, state })?] = level;
            }
        }
        Ok(values)
    };
    let all = RATES.into_iter().map(with_rate);
    let all = all.collect::<Result<Vec<_>, _>>()?;
    Ok(likeliest(estimation, all).unwrap_or(start))
}
