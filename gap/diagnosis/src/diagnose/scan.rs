//! Initial delays and lags of all drives.
//!
//! A delay shifts the motion, which is far from linear in it where it is as long as the motion of a servo takes, and
//! other effects imitate its linear part. A few values are therefore tried with the model as stated.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use appell_estimate::{Estimation, Innovation};

use super::DiagnoseError;
use super::bench::Bench;
use super::evidence::Fitted;
use super::initial::{SizeEstimates, place};
use super::sets::Set;
use crate::effects::Acts;

/// Values that are tried, in s.
const TRIED: [f64; 7] = [0.002, 0.005, 0.012, 0.025, 0.045, 0.08, 0.13];
/// Factors on the best of them, tried in turn.
const FINER: [f64; 3] = [1.4, 1.2, 1.1];
/// Smallest factor on the noise levels of the model without them.
const QUIETEST: f64 = 0.1;

/// Effects on the signals of all drives that improve on the model as stated, each with the most likely common value.
pub(super) fn scanned(bench: &Bench<'_>, stated: &Fitted) -> Result<Vec<Set>, DiagnoseError> {
    let mut sets = Vec::new();
    for members in groups(bench) {
        let mut scan = Scan {
            bench,
            stated,
            members: &members,
            value: 0.0,
            likelihood: stated.fit.log_likelihood,
        };
        for tried in TRIED {
            if !scan.attempt(tried)? && scan.value > 0.0 {
                break;
            }
        }
        if scan.value == 0.0 {
            continue;
        }
        for factor in FINER {
            let centre = scan.value;
            if !scan.attempt(centre * factor)? {
                scan.attempt(centre / factor)?;
            }
        }
        sets.push(Set {
            sizes: sizes(&members, scan.value),
            log_posterior: scan.likelihood,
            members,
            levels: 1.0,
            starts: vec![Vec::new()],
        });
    }
    Ok(sets)
}

/// The search for a common value.
struct Scan<'s, 'a> {
    bench: &'s Bench<'a>,
    stated: &'s Fitted,
    members: &'s [usize],
    /// The best one, zero for none, and its log likelihood.
    value: f64,
    likelihood: f64,
}

impl Scan<'_, '_> {
    /// Tries a value; returns whether it is better. A lag shorter than a step is like a delay, but takes long.
    fn attempt(&mut self, value: f64) -> Result<bool, DiagnoseError> {
        let is_lag = |&member: &usize| matches!(self.bench.candidate(member).acts, Acts::Lag(_));
        if value < self.bench.step && self.members.iter().any(is_lag) {
            return Ok(false);
        }
        let likelihood = likelihood(self.bench, self.stated, self.members, value)?;
        let is_better = likelihood > self.likelihood;
        if is_better {
            (self.value, self.likelihood) = (value, likelihood);
        }
        Ok(is_better)
    }
}

/// The delays, and the lags, of all drives.
fn groups(bench: &Bench<'_>) -> Vec<Vec<usize>> {
    let of = |is_own: fn(Acts) -> bool| -> Vec<usize> {
        (0..bench.effects.candidates.len())
            .filter(|&member| {
                bench.candidate(member).is_of_drives() && is_own(bench.candidate(member).acts)
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

/// The weighted log likelihood with a common value.
fn likelihood(
    bench: &Bench<'_>,
    stated: &Fitted,
    members: &[usize],
    value: f64,
) -> Result<f64, DiagnoseError> {
    let setup = bench.setup(members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let mut values = bench.carried(stated, &estimation);
    for sizes in sizes(members, value) {
        place(bench, &estimation, &sizes, &mut values)?;
    }
    // With too little noise the filter may diverge.
    let likelihood = estimation.innovations(&values).map(|runs| profile(&runs));
    Ok(bench.weight * likelihood.unwrap_or(f64::NEG_INFINITY))
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
