//! Units and signs of channels that contradict the recorded motion: exactly one other unit, or the opposite sign,
//! reconciles the channel with the equations, with the rates, or with the declared range.

mod balance;

use appell_recordings::{Channel, DataSet, Measured, Role};
use appell_runtime::model::Model;
use appell_spec::units;

use appell_estimate::in_parallel;
use balance::Balance;

/// Units of loggers and sensors.
const UNITS: [&str; 26] = [
    "rad", "deg", "rev", "rad/s", "deg/s", "rpm", "rev/s", "rad/s^2", "deg/s^2", "m", "mm", "m/s",
    "mm/s", "m/s^2", "mm/s^2", "N", "mN", "kN", "N*m", "mN*m", "V", "mV", "A", "mA", "kg", "g",
];
/// Units of one system, which are likely to be wrong together.
const SYSTEMS: [&[&str]; 4] = [
    &["rad", "rad/s", "rad/s^2"],
    &["deg", "deg/s", "deg/s^2"],
    &["m", "m/s", "m/s^2"],
    &["mm", "mm/s", "mm/s^2"],
];
/// Standard gravity in m/s², the unit of many accelerometers.
const GRAVITY: f64 = 9.806_65;
/// Factor below which a wrong unit cannot be distinguished from wrong parameters.
const LEAST: f64 = 5.0;
/// Factor below which a real effect may imitate a unit.
const MODEST: f64 = 50.0;
/// Relative residual above which an equation does not explain the measurement.
const BROKEN: f64 = 0.7;
/// Relative residual below which it explains nearly all of it.
const WHOLE: f64 = 0.35;
/// Relative residual below which it explains a part of it, noise included.
const PARTLY: f64 = 0.8;
/// Factors by which the right unit reduces the residual, if the equation then explains nearly all and if only a part.
const BETTER: [f64; 2] = [4.0, 20.0];
/// Advantage over another reading, as the logarithm of a residual, that decides between them.
const DECIDES: f64 = 0.7;
/// The same of the opposite sign over the stated one. Of 863 reversals in 196 data sets with right signs, real rigs
/// among them, none has a smaller residual; but some do where the model lacks much, such as a belt between two joints.
const REVERSED: f64 = 0.4;

/// A doubt about a channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Doubt {
    /// Its column.
    pub column: String,
    /// The contradiction, and the unit or sign to write.
    pub message: String,
    /// Whether it concerns the sign: an unmodelled effect may contradict a right one.
    pub is_sign: bool,
}

/// Another unit of a channel.
#[derive(Clone)]
struct Reading {
    channel: usize,
    unit: String,
    /// Factor by which the values in SI become larger.
    factor: f64,
}

/// Another reading of the recordings, with the sum of its log residuals.
struct Rival {
    readings: Vec<Reading>,
    score: f64,
}

/// The channels whose units or signs the training runs contradict.
pub fn doubts(set: &DataSet, model: &dyn Model) -> Vec<Doubt> {
    let balance = Balance::new(set, model);
    let stated = balance.missed(&vec![1.0; set.channels.len()]);
    let units = unit_doubts(set, &balance, &stated);
    if units.is_empty() {
        sign_doubts(set, &balance, &stated)
    } else {
        units
    }
}

impl Balance<'_> {
    /// The residuals of other readings, with all of their factors times another one.
    fn read(&self, readings: &[Reading], by: f64) -> Vec<Option<f64>> {
        let mut factors = vec![1.0; self.set.channels.len()];
        for reading in readings {
            factors[reading.channel] = by * reading.factor;
        }
        self.missed(&factors)
    }
}

/// The best of some rivals, and those that are nearly as good.
fn best(rivals: Vec<Option<Rival>>) -> Option<(Rival, Vec<Rival>)> {
    let mut rivals: Vec<Rival> = rivals.into_iter().flatten().collect();
    rivals.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut rivals = rivals.into_iter();
    let best = rivals.next()?;
    let tied = rivals.take_while(|other| other.score < best.score + DECIDES);
    let tied = tied.collect();
    Some((best, tied))
}

/// Channels that fit the equations in another unit.
fn unit_doubts(set: &DataSet, balance: &Balance<'_>, stated: &[Option<f64>]) -> Vec<Doubt> {
    if !stated.iter().flatten().any(|part| *part > BROKEN) {
        return Vec::new();
    }
    let rival = |readings: Vec<Reading>| {
        let missed = balance.read(&readings, 1.0);
        let mut varying = mended(stated, &missed)?;
        varying.retain(|index| *index < balance.varying());
        let least = readings
            .iter()
            .map(|own| own.factor.max(1.0 / own.factor))
            .fold(f64::INFINITY, f64::min);
        let near = if least < MODEST { 1.08 } else { 1.3 };
        // The residual has its minimum at the factor of the unit.
        let of = |missed: &[Option<f64>]| score(varying.iter().map(|index| missed[*index]));
        let at = of(&missed);
        let is_best = varying.is_empty()
            || [near, 1.0 / near]
                .iter()
                .all(|by| of(&balance.read(&readings, *by)) > at);
        let score = score(missed.into_iter());
        is_best.then_some(Rival { readings, score })
    };
    let Some((best, tied)) = best(in_parallel(readings(set), rival)) else {
        return Vec::new();
    };
    let readings = best.readings.iter();
    readings
        .map(|reading| doubt(set, reading, tied.first()))
        .collect()
}

/// Channels consistent with the equations only with reversed sign, such as a sensor axis mounted backwards. Signs that
/// are undetermined by a mirror symmetry are not reported.
fn sign_doubts(set: &DataSet, balance: &Balance<'_>, stated: &[Option<f64>]) -> Vec<Doubt> {
    let most = score(stated.iter().copied()) - REVERSED;
    let reversed = |channels: Vec<usize>| {
        let reversed = |channel| Reading {
            channel,
            unit: String::new(),
            factor: -1.0,
        };
        let readings: Vec<Reading> = channels.into_iter().map(reversed).collect();
        let score = score(balance.read(&readings, 1.0).into_iter());
        (score < most).then_some(Rival { readings, score })
    };
    let Some((best, tied)) = best(in_parallel(axes(set), reversed)) else {
        return Vec::new();
    };
    let others = tied.iter();
    let others = others.map(|other| format!(", or that of {}", named(set, other)));
    let message = format!(
        "the motion fits the equations better with the sign of {} reversed{}, unless an effect is missing: write \
         reversed = true in its line of [channels], or vouch for the sign with reversed = false",
        named(set, &best),
        others.collect::<String>()
    );
    vec![Doubt {
        column: set.channels[best.readings[0].channel].column.clone(),
        message,
        is_sign: true,
    }]
}

fn named(set: &DataSet, rival: &Rival) -> String {
    let names = rival.readings.iter();
    let names = names.map(|own| format!("`{}`", set.channels[own.channel].column));
    names.collect::<Vec<_>>().join(" and ")
}

/// Channels that are reversed together: each alone, and a coordinate with its rate.
fn axes(set: &DataSet) -> Vec<Vec<usize>> {
    let is_known = |&channel: &usize| {
        let own = &set.channels[channel];
        own.reversed.is_none() && own.role.label(&set.mechanism).is_some()
    };
    let channels: Vec<usize> = (0..set.channels.len()).filter(is_known).collect();
    let mut all: Vec<Vec<usize>> = channels.iter().map(|&channel| vec![channel]).collect();
    for coordinate in set.mechanism.coordinates.ids() {
        let speed = set.mechanism.speed_of(coordinate);
        let is_own = |&&channel: &&usize| match set.channels[channel].role {
            Role::Measures(Measured::Coordinate(own)) => own == coordinate.index(),
            Role::Measures(Measured::PseudoVelocity(own)) => {
                speed.is_some_and(|speed| speed.index() == own)
            }
            _ => false,
        };
        let own: Vec<usize> = channels.iter().filter(is_own).copied().collect();
        if own.len() > 1 {
            all.push(own);
        }
    }
    all
}

/// The residuals that another reading reduces decisively, if there is one and no residual increases.
fn mended(stated: &[Option<f64>], read: &[Option<f64>]) -> Option<Vec<usize>> {
    let mut mended = Vec::new();
    for (index, (before, after)) in stated.iter().zip(read).enumerate() {
        let (Some(before), Some(after)) = (before, after) else {
            continue;
        };
        let gains = |most: f64, better: f64| *after < most && better * after < *before;
        let is_mended = gains(WHOLE, BETTER[0]) || gains(PARTLY, BETTER[1]);
        if *before > BROKEN && is_mended {
            mended.push(index);
        } else if *after > WHOLE.max(1.1 * before) {
            return None;
        }
    }
    (!mended.is_empty()).then_some(mended)
}

/// Sum of the logarithms of relative residuals.
fn score(missed: impl Iterator<Item = Option<f64>>) -> f64 {
    let parts = missed.flatten();
    parts.map(|part| part.clamp(0.01, 100.0).ln()).sum()
}

/// Channels in other units: each alone, and all channels of one system of units.
fn readings(set: &DataSet) -> Vec<Vec<Reading>> {
    let others: Vec<Vec<Reading>> = (set.channels.iter().enumerate())
        .map(|(index, channel)| others(index, channel, set))
        .collect();
    let alone = others.iter().flatten();
    let mut all: Vec<Vec<Reading>> = alone.map(|reading| vec![reading.clone()]).collect();
    for system in SYSTEMS {
        let own = others.iter().filter_map(|others| {
            let mut others = others.iter();
            others.find(|reading| system.contains(&&*reading.unit))
        });
        let own: Vec<Reading> = own.cloned().collect();
        if own.len() > 1 {
            all.push(own);
        }
    }
    all
}

/// Other units of a channel.
fn others(index: usize, channel: &Channel, set: &DataSet) -> Vec<Reading> {
    let label = channel.role.label(&set.mechanism);
    if channel.unit_checked || label.is_none() {
        return Vec::new();
    }
    let has_angle = channel.unit.has_angle() || label.is_some_and(|label| label.unit.has_angle());
    let own = &channel.unit;
    let known = UNITS.iter().filter_map(|text| units::parse(text).ok());
    let alike =
        known.filter(|unit| unit.dimension == own.dimension && unit.has_angle() == has_angle);
    let alike = alike.map(|unit| (unit.scale / own.scale, unit.text));
    let is_acceleration = units::parse("m/s^2").is_ok_and(|unit| unit.dimension == own.dimension);
    let gravity = is_acceleration.then(|| (GRAVITY / own.scale, "standard gravity".to_owned()));
    // The gain of an actuator is often off by a small factor.
    let is_input = matches!(channel.role, Role::Input(_));
    let least = if is_input { MODEST } else { LEAST };
    alike
        .chain(gravity)
        .filter(|(factor, _)| factor.max(1.0 / factor) > least)
        .map(|(factor, unit)| Reading {
            channel: index,
            unit,
            factor,
        })
        .collect()
}

/// The sentence for a channel.
fn doubt(set: &DataSet, reading: &Reading, tied: Option<&Rival>) -> Doubt {
    let channel = &set.channels[reading.channel];
    let (own, other) = (&channel.unit.text, &reading.unit);
    let values = set.runs.iter().flat_map(|run| &run.values[reading.channel]);
    // A missing value is no maximum.
    let largest = values.fold(0.0, |most: f64, value| most.max(value.abs()));
    let largest = channel.unit.from_si(largest);
    let write = match &channel.unit_at {
        _ if units::parse(other).is_err() => format!("convert the column with 1 = {GRAVITY} m/s^2"),
        Some((file, line, column)) => {
            format!("write unit = \"{other}\" at {file}:{line}:{column}")
        }
        None => format!("describe the column in a recording.toml with unit = \"{other}\""),
    };
    let tied = tied.map(|rival| {
        let names = rival
            .readings
            .iter()
            .map(|own| format!("`{}` in {}", set.channels[own.channel].column, own.unit));
        format!("; or {}", names.collect::<Vec<_>>().join(" and "))
    });
    let message = format!(
        "values up to {largest:.4} {own} contradict the equations, which they fit in {other}{}: {write}, or vouch \
         for {own} with unit_checked = true",
        tied.unwrap_or_default()
    );
    Doubt {
        column: channel.column.clone(),
        message,
        is_sign: false,
    }
}
