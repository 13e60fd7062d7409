//! How probable hypotheses are beforehand.

use std::collections::BTreeSet;

use super::bench::Bench;
use crate::effects::{Candidate, EffectModel};

/// Probability beforehand that there is no gap.
pub(super) const NO_GAP: f64 = 0.5;
/// Probability beforehand that an effect does not come alone.
const NOT_ALONE: f64 = 0.2;

/// Number of effects: components of a vector are one.
pub(super) fn effects(bench: &Bench<'_>, members: &[usize]) -> usize {
    let members = members.iter().map(|&member| bench.candidate(member).name());
    members.collect::<BTreeSet<String>>().len()
}

/// Logarithm of the probability beforehand of a hypothesis with so many effects.
pub(super) fn prior(model: &EffectModel, effects: usize) -> f64 {
    let candidates = model.candidates.iter();
    let names: BTreeSet<String> = candidates.map(Candidate::name).collect();
    let each = (names.len().max(1) as f64).ln();
    match effects {
        0 => NO_GAP.ln(),
        count => (1.0 - NO_GAP).ln() + (count - 1) as f64 * NOT_ALONE.ln() - count as f64 * each,
    }
}
