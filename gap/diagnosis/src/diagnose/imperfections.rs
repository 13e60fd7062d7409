//! Imperfections of channels that do not affect predictions: in long recordings a delay of a millisecond is significant
//! but immaterial. It is not a cause, and must not favour a hypothesis that imitates it. Such imperfections are
//! therefore nuisance parameters of every hypothesis, including the nominal model.

use appell_estimate::Estimation;

use super::DiagnoseError;
use super::bench::Bench;
use super::budget;
use super::calibration::IMMATERIAL;
use super::evidence::Fitted;
use super::held_out::{ORIGINS, horizon};
use super::horizon::Judged;
use super::imperfection::Imperfection;
use super::prediction::{errors, noise};

/// The imperfections that the leading hypothesis has in addition to other effects and that close less of the gap of
/// their channels than the tolerance, in predictions of the training runs. Alone they would be the cause of the gap.
pub(super) fn immaterial(judged: &Judged<'_>) -> Result<Vec<Imperfection>, DiagnoseError> {
    let (bench, comparison) = (&judged.bench, &judged.comparison);
    let (best, nominal) = (comparison.best(), comparison.nominal());
    let is_of_channel = |member: &&usize| bench.candidate(**member).acts.channel().is_some();
    let of_channels: Vec<usize> = best.members.iter().filter(is_of_channel).copied().collect();
    if of_channels.is_empty() || of_channels.len() == best.members.len() {
        return Ok(Vec::new());
    }
    let (noise, horizon) = (noise(bench, best)?, horizon(&bench.recordings));
    let square = |fitted: &Fitted, channel: usize| {
        let mut alone = vec![f64::INFINITY; noise.len()];
        alone[channel] = noise[channel];
        let errors = errors(&bench.recordings, bench, fitted, &alone, horizon, ORIGINS)?;
        Ok::<f64, DiagnoseError>(errors.mean())
    };
    let setup = bench.setup(&best.members);
    let mut immaterial = Vec::new();
    for member in of_channels {
        let mut others = best.members.clone();
        others.retain(|&own| own != member);
        let without = budget::with(bench, comparison, best, &others)?;
        let acts = bench.candidate(member).acts;
        let (Some(free), Some(channel)) = (bench.of_signal(acts, &setup), acts.channel()) else {
            continue;
        };
        let whole = square(best, channel)?;
        let closed = square(nominal, channel)? - whole;
        if square(&without, channel)? - whole < IMMATERIAL * closed {
            let found = best.fit.values[best.layout.place(free.unknown)?];
            immaterial.push(Imperfection { acts, found });
        }
    }
    Ok(immaterial)
}

/// The leading hypothesis of `before`, in which nuisance parameters replace the members that are imperfections.
pub(super) fn known(bench: &Bench<'_>, before: &Judged<'_>) -> Result<Fitted, DiagnoseError> {
    let best = before.comparison.best();
    let mut members = best.members.clone();
    members.retain(|&member| {
        let acts = bench.candidate(member).acts;
        !bench.imperfections.iter().any(|one| one.acts == acts)
    });
    let setup = bench.setup(&members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let start = if before.bench.is_over_windows() {
        bench.taken(&before.bench, best)?.fit.values
    } else {
        bench.carried(best, &estimation)
    };
    bench.fit(&members, &estimation, &start)
}
