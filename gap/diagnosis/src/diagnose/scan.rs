//! Initial delays and lags of all drives, and initial limits of loads and inputs.
//!
//! A delay shifts the motion, which is far from linear in it where it is as long as the motion of a servo takes, and
//! other effects imitate its linear part. A limit has no linear part at all. A few values are therefore tried with the
//! model as stated.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use appell_estimate::{Estimation, Innovation, Unknown};

use super::DiagnoseError;
use super::bench::Bench;
use super::evidence::Fitted;
use super::initial::{SizeEstimates, place};
use super::scales::exerted;
use super::sets::Set;
use crate::effects::{Acts, Part};

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

/// Effects that improve on the model as stated: on the signals of all drives, each with the most likely common value,
/// and limits.
pub(super) fn scanned(bench: &Bench<'_>, stated: &Fitted) -> Result<Vec<Set>, DiagnoseError> {
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
    fn betters(&mut self, value: f64) -> Result<bool, DiagnoseError> {
        self.attempt(value)?;
        Ok(self.value.total_cmp(&value).is_eq())
    }

    /// Tries a value; returns its log likelihood. A lag shorter than a step is like a delay, but takes long.
    fn attempt(&mut self, value: f64) -> Result<f64, DiagnoseError> {
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
    fn finer(mut self, factors: &[f64]) -> Result<Option<Set>, DiagnoseError> {
        if self.value == 0.0 {
            return Ok(None);
        }
        for factor in factors {
            let centre = self.value;
            if !self.betters(centre * factor)? {
                self.attempt(centre / factor)?;
            }
        }
        let setup = self.bench.setup(self.members);
        let estimation = Estimation::new(&setup, &self.bench.recordings)?;
        Ok(Some(Set {
            sizes: sizes(self.members, self.value),
            log_posterior: self.likelihood,
            members: self.members.to_vec(),
            levels: 1.0,
            starts: vec![self.shaped(&estimation, self.value)?],
        }))
    }

    /// The weighted log likelihood with a common value.
    fn likelihood(&self, value: f64) -> Result<f64, DiagnoseError> {
        let bench = self.bench;
        let setup = bench.setup(self.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut values = bench.carried(self.stated, &estimation);
        for sizes in sizes(self.members, value) {
            place(bench, &estimation, &sizes, &mut values)?;
        }
        for (place, value) in self.shaped(&estimation, value)? {
            values[place] = value;
        }
        // With too little noise the filter may diverge.
        let likelihood = estimation.innovations(&values).map(|runs| profile(&runs));
        Ok(bench.weight * likelihood.unwrap_or(f64::NEG_INFINITY))
    }

    /// The place of the parameter that is tried, with a value.
    fn shaped(
        &self,
        estimation: &Estimation<'_>,
        value: f64,
    ) -> Result<Vec<(usize, f64)>, DiagnoseError> {
        let shape = self.shape.map(|shape| {
            let place = estimation.layout().place(Unknown::Parameter(shape))?;
            Ok((place, value))
        });
        shape.into_iter().collect()
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
    let of = |is_own: fn(Acts) -> bool| -> Vec<usize> {
        (0..bench.effects.candidates.len())
            .filter(|&member| {
                bench.candidate(member).is_of_group() && is_own(bench.candidate(member).acts)
            })
            .collect()
    };
    let groups = [
        of(|acts| matches!(acts, Acts::Delay(_))),
        of(|acts| matches!(acts, Acts::Lag(_))),
    ];
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
