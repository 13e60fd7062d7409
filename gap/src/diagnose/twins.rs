//! Hypotheses under two names that say the same of every motion: a bias of a motor and a constant force where it
//! acts, say. No experiment tells them apart, so they share one probability.

use super::DiagnoseError;
use super::bench::Bench;
use super::calibration::SEARCHED;
use super::compare::Comparison;
use super::screen::imitated;
use crate::effects::Acts;

/// Places of the fits that say the same as the best one: their evidence is the same as far as searches go, and at
/// the best one nothing of what they have besides is new.
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
    // Lags and delays are alike where they are short, and not the same.
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
