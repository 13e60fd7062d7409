//! Windows in which the best hypothesis fails by far more than elsewhere: an external force, a contact, a fault of
//! the log.
//!
//! Prediction errors over a fraction of a second accumulate a persistent force and average out jitter. Their scale is
//! a robust one, the 90 % quantile relative to that of a normal distribution, which outliers in less than one row in ten
//! do not affect (P. J. Rousseeuw and C. Croux, *Alternatives to the median absolute deviation*, Journal of the American
//! Statistical Association 88, 1993, on scales by quantiles).

use std::collections::{BTreeMap, BTreeSet};

use appell_estimate::{Estimation, Recording};
use appell_recordings::{DataSet, Part};

use super::horizon::Judged;
use super::localise::length;
use super::prediction::taken_over;
use super::{Bench, Fitted, HeldOut, Result, Window, whole};
use crate::held_out::origins;

/// Number of prediction origins per horizon, and the largest one per run.
const EACH: f64 = 5.0;
const MOST: usize = 1000;
/// Probability of the quantile that gives the scale, and that quantile of the modulus of a standard normal variable.
const ORDINARY: f64 = 0.9;
const QUANTILE: f64 = 1.645;
/// Smallest outlying error, in scales.
const OUTSIDE: f64 = 8.0;
/// Largest part of outlying predictions: more frequent ones have a cause in the mechanism.
const RARE: f64 = 0.1;
/// Smallest number of overlapping predictions that an event spoils: a force changes the speeds, and with them the
/// predictions from all origins shortly before, while the torque of a joint at the moment when its friction turns round
/// is off in a single one.
const LASTING: usize = 2;
/// Largest number of reported windows.
const MOST_WINDOWS: usize = 20;

/// A prediction error in units of the scale of its channel.
struct Error {
    run: usize,
    from: f64,
    to: f64,
    times: f64,
    channel: usize,
}

/// The windows of some recordings, the worst first.
pub(super) fn windows(
    bench: &Bench<'_>,
    fitted: &Fitted,
    set: &DataSet,
    recordings: &[Recording],
) -> Result<Vec<Window>> {
    if recordings.is_empty() {
        return Ok(Vec::new());
    }
    let mut errors = errors(bench, fitted, recordings)?;
    let channels = errors.iter().map(|error| error.channel + 1).max();
    for channel in 0..channels.unwrap_or(0) {
        let own = errors.iter().filter(|one| one.channel == channel);
        let scale = scale(own.map(|one| one.times).collect());
        let own = errors.iter_mut().filter(|one| one.channel == channel);
        own.for_each(|one| one.times /= scale);
    }
    let all = errors.len() as f64;
    errors.retain(|one| one.times > OUTSIDE);
    if errors.len() as f64 > RARE * all {
        return Ok(Vec::new());
    }
    let measured = set.measured(bench.effects.info());
    let column = |channel: usize| measured.get(channel).map(|(own, _)| own.column.clone());
    let mut found: Vec<Window> = together(errors)
        .into_iter()
        .map(|one| Window {
            run: set.runs[one.run].name.clone(),
            from: one.from,
            to: one.to,
            equation: String::new(),
            z: one.times,
            unexplained: column(one.channel),
        })
        .collect();
    found.sort_by(|a, b| b.z.total_cmp(&a.z));
    found.truncate(MOST_WINDOWS);
    Ok(found)
}

/// The windows of the training runs, unless they are known, and of the held-out runs.
pub(super) fn of_both(
    bench: &Bench<'_>,
    fitted: &Fitted,
    [training, test]: [(&DataSet, &HeldOut); 2],
    known: Option<Vec<Window>>,
) -> Result<Vec<Window>> {
    let of = |(set, runs): (&DataSet, &HeldOut)| windows(bench, fitted, set, &runs.recordings);
    let mut found = match known {
        Some(known) => known,
        None => of(training)?,
    };
    found.extend(of(test)?);
    Ok(found)
}

/// Training runs without the windows that the best hypothesis does not predict; `None` without such windows, or without
/// a gap.
pub(super) fn rest(judged: &mut Judged<'_>, whole: &DataSet) -> Result<Option<DataSet>> {
    if judged.comparison.is_null() {
        return Ok(None);
    }
    let found = if let Some(known) = &judged.outside {
        known.clone()
    } else {
        let runs = HeldOut::of(&whole.all(Part::Test), &judged.bench)?;
        let best = judged.comparison.best();
        windows(&judged.bench, best, whole, &runs.recordings)?
    };
    judged.outside = Some(found.clone());
    let margin = 0.5 * length(&judged.bench);
    let cut = found.into_iter();
    let cut = cut.map(|one| (one.run, [one.from - margin, one.to + margin]));
    let cut: Vec<_> = cut.collect();
    Ok((!cut.is_empty()).then(|| whole.without(&cut)))
}

/// Moduli of the prediction errors, in expected standard deviations.
fn errors(bench: &Bench<'_>, fitted: &Fitted, recordings: &[Recording]) -> Result<Vec<Error>> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, recordings)?;
    let values = taken_over(bench, fitted, &estimation)?;
    let horizon = length(bench);
    let mut errors = Vec::new();
    for (run, recording) in recordings.iter().enumerate() {
        let times = recording.times();
        let duration = times[times.len() - 1] - times[0];
        let most = whole((EACH * duration / horizon).ceil());
        let origins = origins(recording, most.clamp(1, MOST));
        let predicted = estimation.predictions(&values, run, horizon, &origins)?;
        // Near an unstable equilibrium small errors grow.
        let expected = estimation.expected_errors(&values, run, horizon, &origins)?;
        let expected: BTreeMap<(usize, usize), f64> = expected
            .into_iter()
            .map(|(origin, channel, variance)| ((origin, channel), variance.sqrt()))
            .collect();
        errors.extend(predicted.into_iter().filter_map(|one| {
            let deviation = expected.get(&(one.origin, one.channel))?;
            Some(Error {
                run,
                from: times[one.origin],
                to: times[one.row],
                times: one.residual.abs() / deviation,
                channel: one.channel,
            })
        }));
    }
    Ok(errors)
}

/// The scale of ordinary errors.
fn scale(mut sizes: Vec<f64>) -> f64 {
    sizes.sort_by(f64::total_cmp);
    let place = whole(ORDINARY * sizes.len() as f64);
    let ordinary = sizes.get(place).copied().unwrap_or(f64::INFINITY);
    (ordinary / QUANTILE).max(f64::MIN_POSITIVE)
}

/// Merges errors of overlapping predictions into events, and leaves out those in a single one. An event begins where the
/// first of them ends, and ends when the filter has converged again.
fn together(mut errors: Vec<Error>) -> Vec<Error> {
    errors.sort_by(|a, b| a.run.cmp(&b.run).then(a.from.total_cmp(&b.from)));
    let mut events: Vec<(Error, [f64; 2], BTreeSet<u64>)> = Vec::new();
    for one in errors {
        match events.last_mut() {
            Some((event, [_, last], origins)) if event.run == one.run && one.from <= event.to => {
                *last = one.from;
                origins.insert(one.from.to_bits());
                event.to = event.to.max(one.to);
                if one.times > event.times {
                    (event.times, event.channel) = (one.times, one.channel);
                }
            }
            _ => {
                let ends = [one.to - (one.to - one.from) / EACH, one.from];
                let origins = BTreeSet::from([one.from.to_bits()]);
                events.push((one, ends, origins));
            }
        }
    }
    events.retain(|(_, _, origins)| origins.len() >= LASTING);
    let narrowed = events.into_iter().map(|(event, [first, last], _)| Error {
        from: first.min(last),
        to: first.max(last),
        ..event
    });
    narrowed.collect()
}
