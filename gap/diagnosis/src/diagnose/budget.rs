//! The shares of the gap: of parameters within their tolerances, of each effect of the best
//! hypothesis, and the unexplained remainder.
//!
//! The share of an effect is its reduction of the mean square prediction error, averaged over all orders in which the
//! effects can be added (L. S. Shapley, *A value for n-person games*, 1953): shares add up, and none depends on an
//! order. Every intermediate model is fitted to the training runs and evaluated on the held-out runs. A set of effects
//! that predicts worse than one of its subsets counts as that subset.

use appell_estimate::Estimation;

use super::bench::SHARES;
use super::prediction::{Errors, Paired};
use super::report::{LAW, REFIT, REST};
use super::{Bench, Comparison, Fitted, Result, Share};
use crate::effects::{Acts, EffectModel};

/// Prediction errors of the models between which the gap is divided.
pub(super) struct Ends<'e> {
    /// Of the stated model.
    pub(super) stated: &'e Errors,
    /// Of the re-fitted model; effects are added to the better of both.
    pub(super) refitted: &'e Errors,
    /// With all effects.
    pub(super) effects: &'e Errors,
    /// With all effects and a measured law.
    pub(super) law: Option<&'e Errors>,
    /// Expected error of the true model.
    pub(super) floor: f64,
    /// Smallest material share of the gap of the re-fitted model.
    pub(super) tolerance: f64,
}

/// The shares of the `effects` of a hypothesis, each with its members, and of the law measured in addition.
/// `errors` gives the prediction errors with some members only.
pub(super) fn of(
    effects: &[(String, Vec<usize>)],
    ends: &Ends<'_>,
    errors: impl Fn(&[usize]) -> Result<Errors>,
) -> Result<Vec<Share>> {
    let count = effects.len();
    let all = (1 << count) - 1;
    let mut between: Vec<Errors> = Vec::new();
    for set in 1..all {
        between.push(errors(&subset(effects, set))?);
    }
    let floor = ends.floor;
    let means = Paired::of(&[ends.stated, ends.refitted]).means();
    // If the fitted parameters predict worse than the stated ones, these are the base.
    let base = if means[1] < means[0] {
        ends.refitted
    } else {
        ends.stated
    };
    let mut models = vec![ends.stated, base];
    models.extend(&between);
    if count > 0 {
        models.push(ends.effects);
    }
    models.extend(ends.law);
    // A set of effects is encoded as a bit mask; its model has that index after the stated one.
    let paired = Paired::of(&models);
    let gap = |means: &[f64]| means[0] - floor * floor;
    let mut parts = Vec::new();
    let means = paired.means();
    let left = (means[1] - floor * floor) / gap(&means);
    // Without a gap of the re-fitted model there is nothing to explain.
    let is_left = means[1] > (1.0 + ends.tolerance) * floor * floor;
    let mut add = |name: String, share: &dyn Fn(&[f64]) -> f64| {
        let closed = share(&means);
        parts.push(Share {
            closed,
            interval: paired.interval95(share),
            is_material: closed > ends.tolerance * left.max(0.0) && (is_left || name == REFIT),
            name,
        });
    };
    add(REFIT.to_owned(), &|means| {
        (means[0] - means[1]) / gap(means)
    });
    for (place, (name, _)) in effects.iter().enumerate() {
        add(name.clone(), &|means| {
            shapley(&at_their_best(&means[1..=all + 1]), place, count) / gap(means)
        });
    }
    if ends.law.is_some() {
        add(LAW.to_owned(), &|means| {
            (means[means.len() - 2] - means[means.len() - 1]) / gap(means)
        });
    }
    add(REST.to_owned(), &|means| {
        (means[means.len() - 1] - floor * floor) / gap(means)
    });
    Ok(parts)
}

/// The shares if an alternative model leads: means of the stated model, the re-fitted one and the alternative.
pub(super) fn of_alternative(
    name: &str,
    paired: &Paired,
    floor: f64,
    tolerance: f64,
) -> Vec<Share> {
    let gap = move |means: &[f64]| means[0] - floor * floor;
    let part = |name: &str, share: &dyn Fn(&[f64]) -> f64| {
        let closed = share(&paired.means());
        Share {
            name: name.to_owned(),
            closed,
            interval: paired.interval95(share),
            is_material: closed > tolerance,
        }
    };
    vec![
        part(name, &|means| (means[0] - means[2]) / gap(means)),
        part(REST, &|means| (means[2] - floor * floor) / gap(means)),
    ]
}

/// For every coalition the smallest error over its subsets. That of the whole is unchanged, so that shares add up
/// to its reduction.
fn at_their_best(means: &[f64]) -> Vec<f64> {
    let mut best = means.to_vec();
    for set in 1..means.len() - 1 {
        let without = (0..usize::BITS).map(|place| set & !(1 << place));
        let parts = without.map(|part| best[part]);
        best[set] = parts.fold(best[set], f64::min);
    }
    best
}

/// The Shapley value of a player for the reduction of `means`, which are indexed by the bit mask of the coalition.
fn shapley(means: &[f64], place: usize, players: usize) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    let own = 1 << place;
    let others = (0..means.len()).filter(|set| set & own == 0);
    others
        .map(|set| {
            let before = set.count_ones();
            let after = u32::try_from(players).unwrap_or(u32::MAX) - before - 1;
            factorial(before) * factorial(after) * (means[set] - means[set | own])
        })
        .sum::<f64>()
        / factorial(u32::try_from(players).unwrap_or(u32::MAX))
}

/// The effects of some members: components of a vector are one effect.
pub(super) fn effects(model: &EffectModel, members: &[usize]) -> Vec<(String, Vec<usize>)> {
    let mut effects: Vec<(String, Vec<usize>)> = Vec::new();
    for &member in members {
        let name = model.candidate(member).name();
        match effects.iter_mut().find(|(own, _)| *own == name) {
            Some((_, members)) => members.push(member),
            None => effects.push((name, vec![member])),
        }
    }
    effects
}

/// The members of the effects in a bit mask.
fn subset(effects: &[(String, Vec<usize>)], set: usize) -> Vec<usize> {
    let effects = effects.iter().enumerate();
    let chosen = effects.filter(|(place, _)| set & (1 << place) != 0);
    let mut members: Vec<usize> = chosen
        .flat_map(|(_, (_, members))| members.clone())
        .collect();
    members.sort_unstable();
    members
}

/// The fit with some members of the best hypothesis. It starts from the best known fit of a subset,
/// and with the sizes of the members in the whole hypothesis.
pub(super) fn with(
    bench: &Bench<'_>,
    comparison: &Comparison,
    best: &Fitted,
    members: &[usize],
) -> Result<Fitted> {
    let known = |own: &&Fitted| own.members.iter().all(|one| members.contains(one));
    let known = comparison.fits.iter().map(|(own, _)| own).filter(known);
    let nearest = known.max_by(|a, b| a.evidence.log().total_cmp(&b.evidence.log()));
    let nearest = nearest.unwrap_or_else(|| comparison.nominal());
    // A search that was given up is continued.
    if nearest.members == members && nearest.fit.is_optimum() {
        return Ok(nearest.clone());
    }
    let setup = bench.setup(members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let (mut start, whole) = (
        bench.carried(nearest, &estimation),
        bench.carried(best, &estimation),
    );
    let new = members.iter().filter(|one| !nearest.members.contains(one));
    for &member in new {
        let candidate = bench.candidate(member);
        let own = bench.own(candidate).into_iter();
        let mut places: Vec<usize> = own.map(|(place, _)| place).collect();
        if let Some(free) = bench.of_signal(candidate.acts, &setup) {
            places.push(estimation.layout().place(free.unknown)?);
        }
        if let Acts::Parameter(index) = candidate.acts {
            places.push(index);
        }
        for place in places {
            start[place] = whole[place];
        }
    }
    bench.fit(SHARES, members, &estimation, &start)
}

#[cfg(test)]
mod tests {
    use super::{at_their_best, shapley};

    #[test]
    fn shares_add_up_and_twins_share_alike() {
        // Either of two twins reduces 10 by 6; both by 7.
        let means = [10.0, 4.0, 4.0, 3.0];
        let [first, second] = [0, 1].map(|place| shapley(&means, place, 2));
        assert!((first - 3.5).abs() < 1e-12 && (first - second).abs() < 1e-12);
        // One of three has no effect.
        let means = [9.0, 5.0, 9.0, 5.0, 3.0, 1.0, 3.0, 1.0];
        let shares = [0, 1, 2].map(|place| shapley(&means, place, 3));
        assert!(shares[1].abs() < 1e-12, "{shares:?}");
        assert!((shares.iter().sum::<f64>() - 8.0).abs() < 1e-12);
    }

    #[test]
    fn what_misleads_alone_takes_nothing() {
        // The second alone increases the error, together with the first it reduces it by one more.
        let best = at_their_best(&[10.0, 2.0, 30.0, 1.0]);
        assert_eq!(best, [10.0, 2.0, 10.0, 1.0]);
        let [first, second] = [0, 1].map(|place| shapley(&best, place, 2));
        assert!((first - 8.5).abs() < 1e-12 && (second - 0.5).abs() < 1e-12);
        // No player, or one.
        assert_eq!(at_their_best(&[3.0]), [3.0]);
        assert_eq!(at_their_best(&[3.0, 4.0]), [3.0, 4.0]);
    }
}
