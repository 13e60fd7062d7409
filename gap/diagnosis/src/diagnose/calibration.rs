//! From evidence to calibrated probabilities, with prior probabilities of hypotheses.
//!
//! Evidence is overconfident: laws are never exact, disturbances never white, and a library never
//! complete. Four constants correct for this; they are maximum-likelihood estimates from cases whose cause
//! was known (`tests/blind/calibrate.py`), half of them diagnosed with a
//! library that lacks their cause. A tenth of all gaps are assumed to have a cause outside the library.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use crate::effects::{Candidate, EffectModel};

/// Prior probability that the cause of a gap is outside the library.
const UNLISTED: f64 = 0.1;
/// Differences of the logarithm of the evidence are divided by this.
const TEMPERATURE: f64 = 1.0;
/// Probability that an effect outside the library is indistinguishable from a listed one.
const MIMICKED: f64 = 0.4;
/// Odds that the law of an effect is not exact.
const INEXACT: f64 = 0.5;
/// Standard deviation of the residual of such a law, as an amplitude relative to the gap.
const LEFT: f64 = 0.1;
/// Two hypotheses whose log evidence differs by less are tied: odds of twenty.
pub(super) const TIED: f64 = 3.0;
/// Accuracy of the log evidence of a search.
pub(super) const SEARCHED: f64 = 0.3;
/// Share of the gap of the re-fitted model below which an effect is immaterial.
pub(super) const IMMATERIAL: f64 = 0.02;
/// Odds of a cause outside the library for a significant gap that no effect closes.
pub(super) const MUCH: f64 = 20.0;
/// Limit of log Bayes factors, to avoid overflow.
const MOST: f64 = 300.0;

/// Prior probability that there is no gap.
pub(super) const NO_GAP: f64 = 0.5;
/// Largest number of components of a vector whose subsets are evaluated.
const MOST_COMPONENTS: usize = 6;
/// Prior probability that an effect is accompanied by another.
const NOT_ALONE: f64 = 0.2;

/// The remainder of the best hypothesis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    /// Log Bayes factor of a further law; minus infinity without one.
    pub(super) log_bayes_factor: f64,
    /// Its share of the gap.
    pub(super) share: f64,
}

/// Logarithm of the weight of a hypothesis, from a difference of log evidence.
pub(super) fn tempered(log: f64) -> f64 {
    log / TEMPERATURE
}

/// Odds of a remainder with this share of the gap under an inexact law, against a uniform share: the
/// amplitude of the remainder, the root of its share, is half-normal.
pub(super) fn inexact(share: f64) -> f64 {
    let size = share.clamp(0.0, 1.0).sqrt() / LEFT;
    INEXACT * 2.0 / (TAU.sqrt() * LEFT) * (-0.5 * size * size).exp()
}

/// Odds of a cause outside the library for a gap that an effect explains up to a remainder.
pub(super) fn unlisted_beside_an_effect(rest: Rest) -> f64 {
    let bayes_factor = rest.log_bayes_factor.min(MOST).exp();
    let unlisted = MIMICKED + (1.0 - MIMICKED) * bayes_factor;
    let listed = 1.0 + inexact(rest.share) * bayes_factor;
    UNLISTED / (1.0 - UNLISTED) * unlisted / listed
}

/// Odds of a cause outside the library for a gap of which the best hypothesis leaves this part.
pub(super) fn unlisted(left: f64) -> f64 {
    let left = left.clamp(0.0, 1.0);
    UNLISTED * left / (1.0 - left).max(f64::MIN_POSITIVE)
}

/// Odds of a law outside the library against effects, from the log Bayes factor between them.
pub(super) fn unlisted_alone(log_bayes_factor: f64) -> f64 {
    UNLISTED / (1.0 - UNLISTED) * log_bayes_factor.min(MOST).exp()
}

/// Odds of a gap with a cause outside the library if no effect is found.
pub(super) fn unlisted_beside_nothing(log_bayes_factor: f64) -> f64 {
    UNLISTED * log_bayes_factor.min(MOST).exp()
}

/// Names of effects; components of a vector are one effect.
pub(super) fn names(model: &EffectModel, members: &[usize]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in members.iter().map(|&m| model.candidate(m).name()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Logarithm of the prior probability of a hypothesis.
pub(super) fn prior(model: &EffectModel, members: &[usize]) -> f64 {
    let names = names(model, members);
    let of_names = names.iter().map(|name| of_components(model, name));
    let counts = names.iter().map(|name| counts(model, name));
    of_count(model, counts.sum()) + of_names.sum::<f64>()
}

/// Number of effects as which one counts.
pub(super) fn counts(model: &EffectModel, name: &str) -> usize {
    let mut candidates = model.candidates.iter();
    let own = candidates.find(|own| own.name() == name);
    own.map_or(1, |own| own.counts)
}

/// The same for any hypothesis with a number of effects.
pub(super) fn of_count(model: &EffectModel, effects: usize) -> f64 {
    let candidates = model.candidates.iter();
    let names: BTreeSet<String> = candidates.map(Candidate::name).collect();
    let each = (names.len().max(1) as f64).ln();
    match effects {
        0 => NO_GAP.ln(),
        count => (1.0 - NO_GAP).ln() + (count - 1) as f64 * NOT_ALONE.ln() - count as f64 * each,
    }
}

/// The prior probability of a vector is shared by its subsets of components; an effect at a group of sites has none.
pub(super) fn of_components(model: &EffectModel, name: &str) -> f64 {
    let components = model.candidates.iter();
    let is_own = |own: &&Candidate| own.is_component && own.name() == name;
    let components = components.filter(|own| is_own(own) && !own.is_of_group());
    let choices = (1_u64 << components.count().min(32)) - 1;
    -(choices.max(1) as f64).ln()
}

/// Subsets of the components of a vector, up to a size.
pub(super) fn subsets(components: usize, largest: usize) -> Vec<Vec<usize>> {
    let some = 1..1_u32 << components.min(MOST_COMPONENTS);
    some.filter(|some| some.count_ones() as usize <= largest)
        .map(|some| {
            (0..components)
                .filter(|place| some >> place & 1 == 1)
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beside_an_effect(log_bayes_factor: f64, share: f64) -> f64 {
        unlisted_beside_an_effect(Rest {
            log_bayes_factor,
            share,
        })
    }

    #[test]
    fn what_leaves_much_is_not_the_cause() {
        // Without a rest it is nearly as probable as the library is complete.
        let odds = beside_an_effect(f64::NEG_INFINITY, 0.0);
        assert!(odds > 0.01 && odds < 0.1, "{odds}");
        let odds = |share| beside_an_effect(200.0, share);
        assert!(odds(0.5) > 1e3, "{}", odds(0.5));
        assert!(odds(0.001) < 0.2, "a nearly exact law: {}", odds(0.001));
        assert!(odds(0.1) < odds(0.2) && odds(0.2) < odds(0.4));
    }

    #[test]
    fn a_rest_beside_no_effect_is_a_gap() {
        assert!(unlisted_beside_nothing(-3.0) < 0.01);
        assert!(unlisted_beside_nothing(10.0) > 1e3);
    }
}
