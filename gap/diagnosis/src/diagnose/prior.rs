//! Prior probabilities of hypotheses.

use std::collections::BTreeSet;

use crate::effects::{Candidate, EffectModel};

/// Prior probability that there is no gap.
pub(super) const NO_GAP: f64 = 0.5;
/// Largest number of components of a vector whose subsets are evaluated.
const MOST_COMPONENTS: usize = 6;
/// Prior probability that an effect is accompanied by another.
const NOT_ALONE: f64 = 0.2;

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
