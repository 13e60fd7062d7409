//! From evidence to probabilities that hold.
//!
//! Evidence is overconfident: laws are never exact, disturbances never white, and a library never
//! complete. Four numbers say by how much; they were found by maximum likelihood on cases whose cause
//! is known (`tests/blind/calibrate.py`, which also holds the data), half of them diagnosed with a
//! library that lacks their cause. A tenth of all gaps are taken to come from nothing in the library.

use std::f64::consts::TAU;

/// Probability beforehand that a gap comes from nothing in the library.
const UNLISTED: f64 = 0.1;
/// Differences of the logarithm of the evidence are divided by this.
const TEMPERATURE: f64 = 1.0;
/// Probability that an effect which the library lacks looks just like one that it has.
const MIMICKED: f64 = 0.4;
/// Odds that the law of an effect is not exact.
const INEXACT: f64 = 0.5;
/// Size of what such a law leaves beside what it explains: standard deviation.
const LEFT: f64 = 0.1;
/// Two hypotheses whose log evidence differs by less are tied: odds of twenty.
pub(super) const TIED: f64 = 3.0;
/// Searches find evidence to within this.
pub(super) const SEARCHED: f64 = 0.3;
/// Part of what re-fitted parameters leave of the gap below which nothing names its cause.
pub(super) const IMMATERIAL: f64 = 0.02;
/// Larger logarithms are certainty.
const MOST: f64 = 300.0;

/// What the best hypothesis leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rest {
    /// Logarithm of the Bayes factor for a further law; minus infinity where there is none.
    pub(super) log_bayes_factor: f64,
    /// Part of the gap that it is.
    pub(super) share: f64,
}

/// Logarithm of the weight of a hypothesis, for differences in the logarithm of the evidence.
pub(super) fn tempered(log: f64) -> f64 {
    log / TEMPERATURE
}

/// Odds that a law which is not exact leaves this part of a gap, beside one that may leave any: the size,
/// not the energy, of what it leaves is half of a normal distribution.
pub(super) fn inexact(share: f64) -> f64 {
    let size = share.clamp(0.0, 1.0).sqrt() / LEFT;
    INEXACT * 2.0 / (TAU.sqrt() * LEFT) * (-0.5 * size * size).exp()
}

/// Odds that nothing in the library causes a gap that an effect explains but for a rest.
pub(super) fn unlisted_beside_an_effect(rest: Rest) -> f64 {
    let bayes_factor = rest.log_bayes_factor.min(MOST).exp();
    let unlisted = MIMICKED + (1.0 - MIMICKED) * bayes_factor;
    let listed = 1.0 + inexact(rest.share) * bayes_factor;
    UNLISTED / (1.0 - UNLISTED) * unlisted / listed
}

/// Odds that nothing in the library causes a gap of which the best hypothesis leaves this part.
pub(super) fn unlisted(left: f64) -> f64 {
    let left = left.clamp(0.0, 1.0);
    UNLISTED * left / (1.0 - left).max(f64::MIN_POSITIVE)
}

/// Odds that a law which is no effect causes a gap, beside effects, by the logarithm of their Bayes factor.
pub(super) fn unlisted_alone(log_bayes_factor: f64) -> f64 {
    UNLISTED / (1.0 - UNLISTED) * log_bayes_factor.min(MOST).exp()
}

/// Odds that there is a gap from nothing in the library where no effect is found.
pub(super) fn unlisted_beside_nothing(rest: Rest) -> f64 {
    UNLISTED * rest.log_bayes_factor.min(MOST).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest(log_bayes_factor: f64, share: f64) -> Rest {
        Rest {
            log_bayes_factor,
            share,
        }
    }

    #[test]
    fn what_leaves_nothing_is_nearly_as_probable_as_the_library_is_complete() {
        let odds = unlisted_beside_an_effect(rest(f64::NEG_INFINITY, 0.0));
        assert!(odds > 0.01 && odds < 0.1, "{odds}");
    }

    #[test]
    fn what_leaves_much_is_not_the_cause() {
        let odds = |share| unlisted_beside_an_effect(rest(200.0, share));
        assert!(odds(0.5) > 1e3, "{}", odds(0.5));
        assert!(
            odds(0.001) < 0.2,
            "a law that is hardly wrong: {}",
            odds(0.001)
        );
        assert!(odds(0.1) < odds(0.2) && odds(0.2) < odds(0.4));
    }

    #[test]
    fn a_rest_beside_no_effect_is_a_gap() {
        assert!(unlisted_beside_nothing(rest(-3.0, 1.0)) < 0.01);
        assert!(unlisted_beside_nothing(rest(10.0, 1.0)) > 1e3);
    }
}
