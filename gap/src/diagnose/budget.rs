//! How the gap divides: what parameters within their tolerances account for, each effect of the best
//! hypothesis, and what nothing explains.
//!
//! The share of an effect is the mean, over all orders in which the effects can be added, of what it takes
//! from the mean squared error of prediction (L. S. Shapley, *A value for n-person games*, 1953): shares
//! add up, and none depends on an order. Every model on the way is fitted to the runs to fit and judged
//! on those held out. One that predicts worse than with fewer effects stands for the better one: whoever has only
//! these effects would leave out what misleads.

use appell_estimate::Estimation;

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::Comparison;
use super::evidence::Fitted;
use super::prediction::{Errors, Paired};
use super::report::{LAW, REFIT, REST, Share};
use crate::effects::{Acts, EffectModel};

/// The errors between which the gap divides.
pub(super) struct Ends<'e> {
    /// Of the stated model.
    pub(super) stated: &'e Errors,
    /// Of what effects are added to.
    pub(super) base: &'e Errors,
    /// With all effects.
    pub(super) effects: &'e Errors,
    /// With a measured law beside them.
    pub(super) law: Option<&'e Errors>,
    /// Where everything is right.
    pub(super) floor: f64,
    /// Share of what the re-fitted model leaves beyond which a part is material.
    pub(super) tolerance: f64,
}

/// The parts of the `effects` of a hypothesis, each with its members, and of the law that was measured beside it.
/// `errors` are those with some members alone.
pub(super) fn of(
    effects: &[(String, Vec<usize>)],
    ends: &Ends<'_>,
    errors: impl Fn(&[usize]) -> Result<Errors, DiagnoseError>,
) -> Result<Vec<Share>, DiagnoseError> {
    let count = effects.len();
    let all = (1 << count) - 1;
    let mut between: Vec<Errors> = Vec::new();
    for set in 1..all {
        between.push(errors(&subset(effects, set))?);
    }
    let floor = ends.floor;
    let mut models = vec![ends.stated, ends.base];
    models.extend(&between);
    if count > 0 {
        models.push(ends.effects);
    }
    models.extend(ends.law);
    // A set of effects stands at its number, after the stated model.
    let paired = Paired::of(&models);
    let gap = |means: &[f64]| means[0] - floor * floor;
    let mut parts = Vec::new();
    let means = paired.means();
    let left = (means[1] - floor * floor) / gap(&means);
    // Where re-fitted parameters predict to within the noise, nothing is left that could have a cause.
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

/// The parts where another model leads: means of the stated model, the re-fitted one and the other.
pub(super) fn of_alternative(
    name: &str,
    paired: &Paired,
    (floor, tolerance): (f64, f64),
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

/// Every coalition with the least of what parts of it leave. The whole stands as it is, so that shares add up
/// to what it takes.
fn at_their_best(means: &[f64]) -> Vec<f64> {
    let mut best = means.to_vec();
    for set in 1..means.len() - 1 {
        let without = (0..usize::BITS).map(|place| set & !(1 << place));
        let parts = without.map(|part| best[part]);
        best[set] = parts.fold(best[set], f64::min);
    }
    best
}

/// What the player at a place takes from `means`, which hold all coalitions by their number.
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

/// The effects of some members: components of a vector are one.
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

/// The members of the effects that a number stands for.
fn subset(effects: &[(String, Vec<usize>)], set: usize) -> Vec<usize> {
    let effects = effects.iter().enumerate();
    let chosen = effects.filter(|(place, _)| set & (1 << place) != 0);
    let mut members: Vec<usize> = chosen
        .flat_map(|(_, (_, members))| members.clone())
        .collect();
    members.sort_unstable();
    members
}

/// The fit with some members of the best hypothesis. It begins at the best one that is known without one of
/// them, and with the sizes that they have in the whole.
pub(super) fn with(
    (bench, comparison): (&Bench<'_>, &Comparison),
    best: &Fitted,
    members: &[usize],
) -> Result<Fitted, DiagnoseError> {
    let known = |own: &&Fitted| own.members.iter().all(|one| members.contains(one));
    let known = comparison.fits.iter().map(|(own, _)| own).filter(known);
    let nearest = known.max_by(|a, b| a.evidence.log().total_cmp(&b.evidence.log()));
    let nearest = nearest.unwrap_or_else(|| comparison.nominal());
    if nearest.members == members {
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
        let brought = bench.brought(member, &setup);
        let brought = brought
            .iter()
            .map(|free| estimation.layout().place(free.unknown));
        let own = bench
            .own(bench.candidate(member))
            .into_iter()
            .map(|(place, _)| Ok(place));
        for place in brought.chain(own) {
            let place = place?;
            start[place] = whole[place];
        }
        if let Acts::Parameter(_) = bench.candidate(member).acts {
            let index = bench
                .effects
                .info()
                .parameter_index(&bench.candidate(member).site);
            if let Some(index) = index {
                start[index] = whole[index];
            }
        }
    }
    bench.fit_roughly(members, &estimation, &start)
}

#[cfg(test)]
mod tests {
    use super::{at_their_best, shapley};

    #[test]
    fn shares_add_up_and_twins_share_alike() {
        // Either of two twins takes 6 of 10; both take 7.
        let means = [10.0, 4.0, 4.0, 3.0];
        let [first, second] = [0, 1].map(|place| shapley(&means, place, 2));
        assert!((first - 3.5).abs() < 1e-12 && (first - second).abs() < 1e-12);
        // One of three does nothing.
        let means = [9.0, 5.0, 9.0, 5.0, 3.0, 1.0, 3.0, 1.0];
        let shares = [0, 1, 2].map(|place| shapley(&means, place, 3));
        assert!(shares[1].abs() < 1e-12, "{shares:?}");
        assert!((shares.iter().sum::<f64>() - 8.0).abs() < 1e-12);
    }

    #[test]
    fn what_misleads_alone_takes_nothing() {
        // The second alone makes it worse, beside the first it takes one more.
        let best = at_their_best(&[10.0, 2.0, 30.0, 1.0]);
        assert_eq!(best, [10.0, 2.0, 10.0, 1.0]);
        let [first, second] = [0, 1].map(|place| shapley(&best, place, 2));
        assert!((first - 8.5).abs() < 1e-12 && (second - 0.5).abs() < 1e-12);
        // Nobody is there, or one.
        assert_eq!(at_their_best(&[3.0]), [3.0]);
        assert_eq!(at_their_best(&[3.0, 4.0]), [3.0, 4.0]);
    }
}
