//! Equivalent hypotheses with different names, such as a bias of a motor and a constant force along it.
//! No experiment can distinguish them, so they share one probability.

use super::DiagnoseError;
use super::bench::Bench;
use super::calibration::SEARCHED;
use super::compare::Comparison;
use super::screen::imitated;
use crate::effects::Acts;

/// Indices of the fits that are equivalent to the best one: their evidence is the same within the accuracy of searches,
/// and about the best one the sensitivities of their other members are linearly dependent.
pub(super) fn of_best(
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<Vec<usize>, DiagnoseError> {
    let best = comparison.best();
    let is_alike = |place: &usize| {
        let (own, _) = &comparison.fits[*place];
        own.members.len() == best.members.len()
            && (own.evidence.log() - best.evidence.log()).abs() < SEARCHED
    };
    let alike: Vec<usize> = (1..comparison.fits.len()).filter(is_alike).collect();
    if best.members.is_empty() || alike.is_empty() {
        return Ok(Vec::new());
    }
    let imitated = imitated(bench, best)?;
    // Short lags and delays are similar, but not equivalent.
    let is_late = |member: usize| {
        let acts = bench.candidate(member).acts;
        matches!(
            acts,
            Acts::Lag(_) | Acts::Delay(_) | Acts::Late(_) | Acts::Slow(_)
        )
    };
    let says_the_same = |place: &usize| {
        let mut members = comparison.fits[*place].0.members.iter();
        members.all(|&member| {
            best.members.contains(&member) || imitated.contains(&member) && !is_late(member)
        })
    };
    Ok(alike.into_iter().filter(says_the_same).collect())
}
