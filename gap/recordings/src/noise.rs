//! The noise level of each channel: stated, and checked against the data.
//!
//! It is estimated from differences of neighbouring samples if the motion is slow relative to the
//! sampling, else at standstill. A sensor of resolution q has at least the noise q/√12. A stated
//! level is trusted to within a factor of two; within it, the data decide.

use appell_estimate::smoothing::Samples;
use appell_estimate::smoothing::noise::{at_standstill, from_differences};

use crate::level::{Noise, NoiseSource};
use crate::quantum::quantum;
use crate::{Channel, DataSet, Finding, FindingKind, Part, Run};

/// Largest factor by which a stated level may be wrong.
const TRUST: f64 = 2.0;
/// Resolution, relative to the noise, from which it is reported.
const NOTABLE: f64 = 0.5;

/// Estimates the noise of every measured channel from the training runs.
pub(crate) fn find(set: &mut DataSet) {
    let runs: Vec<&Run> = set.runs.iter().filter(|r| r.part == Part::Fit).collect();
    for (index, channel) in set.channels.iter_mut().enumerate() {
        let values = || runs.iter().map(|run| &*run.values[index]);
        let mut tell = |kind, message: String| {
            let finding = Finding::new(kind, message);
            set.findings.push(finding.of_channel(&channel.column));
        };
        if is_constant(values()) {
            let message = "the channel never changes in the runs to fit";
            tell(FindingKind::Constant, message.to_owned());
        }
        if !channel.is_measured() {
            continue;
        }
        let records: Vec<Samples<'_>> = runs
            .iter()
            .filter_map(|run| Samples::new(&run.times, &run.values[index]).ok())
            .collect();
        let (noise, finding) = judged(channel, &records, quantum(values()));
        channel.noise = noise;
        if let Some((kind, message)) = finding {
            tell(kind, message);
        }
        let stepped = noise.and_then(|noise| Some((noise.quantum?, noise.std)));
        if let Some((step, _)) = stepped.filter(|(step, std)| *step > NOTABLE * std) {
            let message = format!("values in steps of {}", in_unit(channel, step));
            tell(FindingKind::Quantised, message);
        }
    }
}

fn is_constant<'v>(records: impl Iterator<Item = &'v [f64]>) -> bool {
    // Missing values, NaN, are neither smaller nor larger.
    let [low, high] = records
        .flatten()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(*value), high.max(*value)]
        });
    high <= low
}

/// Estimate from the data.
struct Level {
    std: f64,
    source: NoiseSource,
    /// Whether it is only an upper bound.
    bound: bool,
}

/// The level of samples of a sensor whose resolution alone has the noise `floor`.
fn level(records: &[Samples<'_>], floor: f64) -> Option<Level> {
    let differences = from_differences(records)?;
    let is_bound = !differences.settled;
    let at_rest = is_bound.then(|| at_standstill(records)).flatten();
    let (std, source, bound) = match at_rest {
        Some(std) => (std, NoiseSource::Standstill, false),
        None => (differences.std, NoiseSource::Differences, is_bound),
    };
    let (std, source, bound) = if std < floor {
        (floor, NoiseSource::Quantisation, false)
    } else {
        (std, source, bound)
    };
    Some(Level { std, source, bound })
}

type Told = Option<(FindingKind, String)>;

/// The level that is used, from the stated one, the estimate and the resolution of the sensor.
fn judged(
    channel: &Channel,
    records: &[Samples<'_>],
    quantum: Option<f64>,
) -> (Option<Noise>, Told) {
    let floor = quantum.map_or(0.0, |step| step / 12f64.sqrt());
    let level = level(records, floor);
    let stated = channel.stated_noise.filter(|std| *std > 0.0);
    let noise = |std, source, found| {
        (std > 0.0).then_some(Noise {
            std,
            source,
            found,
            quantum,
        })
    };
    match (stated, level) {
        (None, None) => (None, None),
        (Some(std), None) => (noise(std, NoiseSource::Stated, None), None),
        (None, Some(level)) => {
            let told = level.bound.then(|| {
                let found = in_unit(channel, level.std);
                let message = format!(
                    "the motion is too fast for the sampling to separate the noise; it is at most {found}"
                );
                (FindingKind::NoiseBound, message)
            });
            (noise(level.std, level.source, Some(level.std)), told)
        }
        (Some(stated), Some(level)) => {
            // The stated level may or may not include the resolution.
            let allowed = stated / TRUST..=stated.hypot(floor) * TRUST;
            let within = level.std.clamp(*allowed.start(), *allowed.end());
            let open = level.bound && level.std > stated;
            let told = (!open && !allowed.contains(&level.std)).then(|| {
                let message = format!(
                    "the stated noise is {}, the data show {}; {} is used",
                    in_unit(channel, stated),
                    in_unit(channel, level.std),
                    in_unit(channel, within)
                );
                (FindingKind::NoiseDisagrees, message)
            });
            // An upper bound above the stated level does not contradict it.
            let (std, source) = if open {
                (stated, NoiseSource::Stated)
            } else {
                (within, level.source)
            };
            (noise(std, source, Some(level.std)), told)
        }
    }
}

/// A value in the unit of the files, with three digits.
fn in_unit(channel: &Channel, value: f64) -> String {
    let value = channel.unit.from_si(value);
    let rounded = format!("{value:.2e}").parse().unwrap_or(value);
    format!("{rounded} {}", channel.unit.text)
}
