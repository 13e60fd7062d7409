//! The begin of a search for a robot, about the model as stated: initial delays and lags of all drives, and initial
//! limits of loads and inputs.
//!
//! A delay shifts the motion, which is far from linear in it where it is as long as the motion of a servo takes, and
//! other effects imitate its linear part. A limit has no linear part at all. A few values are therefore tried with the
//! model as stated.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use appell_estimate::{Estimation, Innovation};

use super::calibration::{TIED, names};
use super::scales::exerted;
use super::search::{IMITATED, LEADING, Search};
use super::sets::{Set, Sets};
use super::starts::{SizeEstimates, place};
use super::{Bench, Fitted, Result};
use crate::effects::{Acts, Part};

/// Number of single effects that are fitted about the model as stated.
const STRONG: usize = 4;
/// Values that are tried, in s.
const TRIED: [f64; 7] = [0.002, 0.005, 0.012, 0.025, 0.045, 0.08, 0.13];
/// Limits that are tried, relative to the stated value of the first variant.
const LIMITS: [f64; 13] = [
    2.8, 2.1, 1.6, 1.2, 0.9, 0.66, 0.5, 0.37, 0.28, 0.2, 0.14, 0.1, 0.07,
];
/// Loss in log likelihood that tells that a limit is too low.
const WORSE: f64 = 10.0;
/// Factors on the best of them, tried in turn.
const FINER: [f64; 3] = [1.4, 1.2, 1.1];
/// Smallest factor on the noise levels of the model without them.
const QUIETEST: f64 = 0.1;

impl Search<'_, '_> {
    /// Fits sets about the model as stated: refitted parameters may imitate a large effect, far from its optimum.
    pub(super) fn start_from_stated(&mut self) -> Result<()> {
        let stated = self.bench.stated()?;
        let [nominal, from] = [&self.fits[0], &stated].map(|fitted| fitted.fit.log_likelihood);
        self.stated = Some(from);
        let scanned = scanned(self.bench, &stated)?;
        let all = scanned.iter().map(|set| set.log_posterior);
        let most = all.fold(nominal, f64::max);
        for set in scanned {
            // What explains less than the tolerances or another effect needs no start of its own.
            if set.log_posterior - from > IMITATED * (most - from) {
                self.take_from(&stated, &set);
            }
        }
        let without = self.log_posterior(&stated);
        let sets = Sets::about(self.bench, &stated, without)?;
        for set in self.strong_singles(&sets, without) {
            self.take_from(&stated, set);
        }
        for effects in [None, Some(1), Some(2)] {
            for set in self.worth_a_fit(&sets, LEADING, effects) {
                self.take_from(&stated, set);
            }
        }
        Ok(())
    }

    /// The single effects that promise at least a part of what the best of them promises: to first order another effect
    /// at the same place may imitate a large one.
    fn strong_singles<'s>(&self, sets: &'s [Set], without: f64) -> Vec<&'s Set> {
        let mut told = BTreeSet::new();
        // Biases and scales of channels are linear.
        let is_of_channel = |&own: &usize| self.bench.candidate(own).acts.channel().is_some();
        let singles = sets.iter().filter(|set| {
            if set.members.iter().any(is_of_channel) {
                return false;
            }
            let names = names(self.bench.effects, &set.members);
            names.len() == 1 && told.insert(names)
        });
        let singles: Vec<&Set> = singles.take(STRONG).collect();
        let most = singles
            .first()
            .map_or(0.0, |set| set.log_posterior - without);
        let is_strong = |set: &&Set| set.log_posterior - without > IMITATED * most.max(TIED);
        singles.into_iter().filter(is_strong).collect()
    }
}

/// Effects that improve on the model as stated: on the signals of all drives, each with the most likely common value,
/// and limits.
fn scanned(bench: &Bench<'_>, stated: &Fitted) -> Result<Vec<Set>> {
    let mut sets = Vec::new();
    for members in groups(bench) {
        let mut scan = Scan::of(bench, stated, &members, None);
        for tried in TRIED {
            if !scan.betters(tried)? && scan.value > 0.0 {
                break;
            }
        }
        sets.extend(scan.finer(&FINER)?);
    }
    for (limit, shape) in limits(bench) {
        let members = [limit];
        let mut scan = Scan::of(bench, stated, &members, Some(shape));
        let first = bench.effects.info().parameters[shape].value;
        // A force that is measured shows its limit.
        if let Some(force) = exerted(&bench.set, &bench.candidate(limit).site) {
            scan.attempt(force)?;
        }
        for factor in LIMITS {
            // Below a limit that the drive exceeds, all others are worse.
            let likelihood = scan.attempt(factor * first)?;
            if likelihood < stated.fit.log_likelihood - WORSE {
                break;
            }
        }
        sets.extend(scan.finer(&FINER[1..])?);
    }
    Ok(sets)
}

/// The search for a common value.
struct Scan<'s, 'a> {
    bench: &'s Bench<'a>,
    stated: &'s Fitted,
    members: &'s [usize],
    /// The parameter that is tried; the size of the members if there is none.
    shape: Option<usize>,
    /// The best value, zero for none, and its log likelihood.
    value: f64,
    likelihood: f64,
}

impl<'s, 'a> Scan<'s, 'a> {
    fn of(
        bench: &'s Bench<'a>,
        stated: &'s Fitted,
        members: &'s [usize],
        shape: Option<usize>,
    ) -> Self {
        Self {
            bench,
            stated,
            members,
            shape,
            value: 0.0,
            likelihood: stated.fit.log_likelihood,
        }
    }

    /// Tries a value; returns whether it is the best one.
    fn betters(&mut self, value: f64) -> Result<bool> {
        self.attempt(value)?;
        Ok(self.value.total_cmp(&value).is_eq())
    }

    /// Tries a value; returns its log likelihood. A lag shorter than a step is like a delay, but takes long.
    fn attempt(&mut self, value: f64) -> Result<f64> {
        let is_lag = |&member: &usize| matches!(self.bench.candidate(member).acts, Acts::Lag(_));
        if value < self.bench.step && self.members.iter().any(is_lag) {
            return Ok(f64::NEG_INFINITY);
        }
        let likelihood = self.likelihood(value)?;
        if likelihood > self.likelihood {
            (self.value, self.likelihood) = (value, likelihood);
        }
        Ok(likelihood)
    }

    /// Tries values about the best one; the effect with the best of them, if it improves on the model as stated.
    fn finer(mut self, factors: &[f64]) -> Result<Option<Set>> {
        if self.value == 0.0 {
            return Ok(None);
        }
        for factor in factors {
            let centre = self.value;
            if !self.betters(centre * factor)? {
                self.attempt(centre / factor)?;
            }
        }
        Ok(Some(Set {
            sizes: sizes(self.members, self.value),
            log_posterior: self.likelihood,
            members: self.members.to_vec(),
            levels: 1.0,
            starts: vec![self.shaped(self.value)],
        }))
    }

    /// The weighted log likelihood with a common value.
    fn likelihood(&self, value: f64) -> Result<f64> {
        let bench = self.bench;
        let setup = bench.setup(self.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut values = bench.carried(self.stated, &estimation);
        for sizes in sizes(self.members, value) {
            place(bench, &estimation, &sizes, 1.0, &mut values)?;
        }
        for (place, value) in self.shaped(value) {
            values[place] = value;
        }
        // With too little noise the filter may diverge.
        let likelihood = estimation.innovations(&values).map(|runs| profile(&runs));
        Ok(bench.weight * likelihood.unwrap_or(f64::NEG_INFINITY))
    }

    /// The parameter that is tried, with a value.
    fn shaped(&self, value: f64) -> Vec<(usize, f64)> {
        self.shape.iter().map(|&shape| (shape, value)).collect()
    }
}

/// The first variant of each limit, with the parameter that is its value.
fn limits(bench: &Bench<'_>) -> Vec<(usize, usize)> {
    let mut seen = BTreeSet::new();
    let all = bench.effects.candidates.iter().enumerate();
    let limits = all.filter_map(|(number, candidate)| {
        let own = bench.own(candidate);
        let is_switched = own.iter().any(|(_, part)| *part == Part::Switch);
        let shape = own.into_iter().find(|(_, part)| part.is_shape());
        let (shape, _) = shape.filter(|_| is_switched && seen.insert(candidate.name()))?;
        Some((number, shape))
    });
    limits.collect()
}

/// The delays, and the lags, of all drives.
fn groups(bench: &Bench<'_>) -> Vec<Vec<usize>> {
    let is_delay: fn(Acts) -> bool = |acts| matches!(acts, Acts::Delay(_));
    let is_lag: fn(Acts) -> bool = |acts| matches!(acts, Acts::Lag(_));
    let groups = [is_delay, is_lag].map(|is_own| {
        let all = bench.effects.candidates.iter().enumerate();
        let own = all.filter(|(_, own)| own.is_of_group() && is_own(own.acts));
        own.map(|(member, _)| member).collect::<Vec<usize>>()
    });
    groups.into_iter().filter(|own| !own.is_empty()).collect()
}

fn sizes(members: &[usize], value: f64) -> Vec<SizeEstimates> {
    let size = |&candidate: &usize| SizeEstimates {
        candidate,
        values: vec![value],
        deviations: vec![value],
    };
    members.iter().map(size).collect()
}

/// The log likelihood with the most likely noise of each channel, at the gains of the given one.
fn profile(runs: &[Vec<Innovation>]) -> f64 {
    let mut channels: BTreeMap<usize, (f64, f64, f64)> = BTreeMap::new();
    for innovation in runs.iter().flatten() {
        let (count, squares, logs) = channels.entry(innovation.channel).or_default();
        *count += 1.0;
        *squares += innovation.whitened().powi(2);
        *logs += (TAU * innovation.white_variance).ln();
    }
    let of_channel = |&(count, squares, logs): &(f64, f64, f64)| {
        let variance = (squares / count).max(QUIETEST * QUIETEST);
        logs + count * variance.ln() + squares / variance
    };
    -0.5 * channels.values().map(of_channel).sum::<f64>()
}
