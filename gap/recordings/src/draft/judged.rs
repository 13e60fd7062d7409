//! Units and signs of bound columns, by ranges of joints and by what columns say of each other.

use std::f64::consts::PI;

use appell_spec::units;

use super::bound::Bound;
use super::evidence::{follows, rate_of};
use super::log::Log;
use super::quantities::Quantity;
use super::words::{Kind, is_current, unit, words};

/// A channel of the draft.
#[derive(Debug, Clone)]
pub(super) struct Judged {
    pub(super) column: usize,
    pub(super) quantity: usize,
    /// Unit; `None` if it is counts of an encoder, of which nothing else is known.
    pub(super) unit: Option<String>,
    pub(super) reversed: bool,
    pub(super) questions: Vec<String>,
    /// What is known beyond the description.
    pub(super) note: Option<String>,
}

/// Values outside a range by less than this part of it, and by this angle or length, are inside.
const AROUND: [f64; 2] = [0.2, 0.2];
/// Largest angle in rad of a joint without a range.
const FAR: f64 = 4.0 * PI;
/// Angles up to this size in rad may be in degrees as well.
const SMALL: f64 = 0.3;
/// Whole numbers up to more than this may be counts of an encoder.
const FEWEST_COUNTS: f64 = 20.0;
/// Least correlation that tells a unit and a sign.
const ALIKE: f64 = 0.6;
/// Largest factor between a slope and that of a unit.
const NEAR: f64 = 1.5;

/// Judges all bound columns.
pub(super) fn judge(log: &Log, bound: &[Bound], quantities: &[Quantity]) -> Vec<Judged> {
    let angles = unit_of_positions(log, bound, quantities, true);
    let lengths = unit_of_positions(log, bound, quantities, false);
    let mut judged: Vec<Judged> = bound
        .iter()
        .map(|own| {
            let quantity = &quantities[own.quantity];
            let mut judged = Judged {
                column: own.column,
                quantity: own.quantity,
                unit: Some(quantity.unit.clone()),
                reversed: false,
                questions: own.doubt.iter().cloned().collect(),
                note: None,
            };
            if quantity.kind == Kind::Position {
                let group = if quantity.has_angle {
                    &angles
                } else {
                    &lengths
                };
                judged.unit = stated(log, own.column, quantity).or_else(|| group.unit.clone());
                judged.questions.extend(group.question.clone());
            }
            judged
        })
        .collect();
    for index in 0..judged.len() {
        let quantity = &quantities[judged[index].quantity];
        let position = judged.iter().find(|own| {
            let other = &quantities[own.quantity];
            other.kind == Kind::Position && quantity.axis.is_some() && other.axis == quantity.axis
        });
        let position = position.cloned();
        match quantity.kind {
            Kind::Rate => rate(log, &mut judged[index], quantity, position.as_ref()),
            Kind::Command if quantity.is_position_command() => {
                command(log, &mut judged[index], quantity, position.as_ref());
            }
            Kind::Command if quantity.has_angle => {
                rate(log, &mut judged[index], quantity, position.as_ref());
            }
            Kind::Command | Kind::Torque => {
                let own = &mut judged[index];
                own.unit = stated(log, own.column, quantity).or(own.unit.take());
                let is_current = || {
                    let names = [&log.names[own.column], &quantity.name];
                    names.into_iter().any(|name| is_current(&words(name)))
                };
                if quantity.is_note && is_current() {
                    own.unit = Some("A".to_owned());
                }
            }
            Kind::Position => {}
        }
    }
    judged
}

/// The unit in the name of a column, if it is one of the quantity.
fn stated(log: &Log, column: usize, quantity: &Quantity) -> Option<String> {
    let said = unit(&words(&log.names[column]))?;
    let texts = [said.to_owned(), format!("{said}/s")];
    texts.into_iter().find(|text| {
        units::parse(text).is_ok_and(|unit| {
            unit.dimension == quantity.dimension && unit.has_angle() == quantity.has_angle
        })
    })
}

/// The unit of all positions of one kind.
#[derive(Default)]
struct Common {
    unit: Option<String>,
    question: Option<String>,
}

/// Units of positions: the SI one, and the one that logs have instead, with its size.
const POSITIONS: [(&str, &str, f64); 2] = [("rad", "deg", PI / 180.0), ("m", "mm", 1e-3)];

fn unit_of_positions(
    log: &Log,
    bound: &[Bound],
    quantities: &[Quantity],
    has_angle: bool,
) -> Common {
    let (si, other, size) = POSITIONS[usize::from(!has_angle)];
    let mut largest = 0.0_f64;
    let (mut fits_si, mut fits_other, mut has_ranges, mut any) = (true, true, true, false);
    let mut is_whole = true;
    for own in bound {
        let quantity = &quantities[own.quantity];
        let is_alike = quantity.kind == Kind::Position && quantity.is_angle_or_length(has_angle);
        if !is_alike || stated(log, own.column, quantity).is_some() {
            continue;
        }
        let Some(ends) = log.ends(own.column) else {
            continue;
        };
        any = true;
        largest = largest.max(ends[0].abs()).max(ends[1].abs());
        has_ranges &= quantity.range.is_some();
        fits_si &= is_within(ends, quantity.range, has_angle);
        fits_other &= is_within(ends.map(|end| end * size), quantity.range, has_angle);
        let mut values = log.column(own.column).flatten();
        is_whole &= values.all(|value| value.is_nan() || value.fract() == 0.0);
    }
    if !any {
        return Common::default();
    }
    let unit = |text: &str| Some(text.to_owned());
    if has_angle && is_whole && largest > FEWEST_COUNTS && !fits_si {
        return Common {
            unit: unit(other).filter(|_| fits_other),
            question: Some(if fits_other {
                format!("whole numbers up to {largest}: degrees, or counts of an encoder?")
            } else {
                "whole numbers, too large for angles: counts of an encoder? Write its counts_per_turn, gear and zero"
                    .to_owned()
            }),
        };
    }
    match (fits_si, fits_other) {
        (true, _) => {
            let is_large = has_angle && !has_ranges && largest > 2.0 * PI;
            let is_small = has_angle && largest < SMALL;
            let question = (is_large || is_small)
                .then(|| format!("values up to {largest:.3}: are these {si}, or {other}?"));
            let unit = unit(si);
            Common { unit, question }
        }
        (false, true) => Common {
            unit: unit(other),
            question: None,
        },
        (false, false) => Common {
            unit: unit(other),
            question: Some(format!(
                "values up to {largest:.3} leave the ranges of the joints in {si} and in {other}; which unit is it?"
            )),
        },
    }
}

/// Whether values in SI are within a range, or are angles or lengths of a robot.
fn is_within([low, high]: [f64; 2], range: Option<[f64; 2]>, is_angle: bool) -> bool {
    match range {
        Some([least, most]) => {
            let around = AROUND[1].max(AROUND[0] * (most - least));
            low > least - around && high < most + around
        }
        None if is_angle => low.abs().max(high.abs()) < FAR,
        None => low.abs().max(high.abs()) < 20.0,
    }
}

/// One of a unit in SI.
fn scale(text: &str) -> f64 {
    units::parse(text).map_or(1.0, |unit| unit.scale)
}

/// The unit in which a slope is nearest to one, with the factor between them; the first one of several.
fn nearest<'t>(texts: &[&'t str], slope: impl Fn(&str) -> f64) -> (&'t str, f64) {
    let off = |text: &&'t str| {
        let slope = slope(text);
        (*text, slope.max(1.0 / slope))
    };
    let all = texts.iter().map(off);
    let nearest = all.min_by(|(_, a), (_, b)| a.total_cmp(b));
    nearest.unwrap_or(("rad/s", 1.0))
}

/// A rate by the derivative of its position.
fn rate(log: &Log, own: &mut Judged, quantity: &Quantity, position: Option<&Judged>) {
    if let Some(unit) = stated(log, own.column, quantity) {
        own.unit = Some(unit);
    }
    let texts: &[&str] = if quantity.has_angle {
        &["rad/s", "deg/s", "rpm"]
    } else {
        &["m/s", "mm/s"]
    };
    if units::parse(texts[0]).is_ok_and(|unit| unit.dimension != quantity.dimension) {
        return;
    }
    if let Some(position) = position.filter(|position| position.unit.is_none()) {
        own.unit = stated(log, own.column, quantity);
        own.questions.extend(position.questions.iter().cloned());
        return;
    }
    let known = position.and_then(|position| {
        let unit = position.unit.as_ref()?;
        let relation = rate_of(log, position.column, own.column)?;
        Some((relation, scale(unit)))
    });
    let clear = known.filter(|(relation, _)| relation.correlation.abs() > ALIKE);
    let Some((relation, of_position)) = clear else {
        let doubtful = if stated(log, own.column, quantity).is_some() {
            None
        } else {
            // A rate is logged in the unit of its position.
            let in_degrees = position.is_some_and(|own| own.unit.as_deref() == Some("deg"));
            if in_degrees {
                own.unit = Some("deg/s".to_owned());
            }
            Some("no position tells its unit and sign; are they right?".to_owned())
        };
        own.questions.extend(doubtful);
        return;
    };
    let slope = |text: &str| relation.slope.abs() * scale(text) / of_position;
    let (best, off) = nearest(texts, slope);
    if stated(log, own.column, quantity).is_none() {
        own.unit = Some(best.to_owned());
        if off > NEAR {
            own.questions.push(format!(
                "it is {:.3} times the derivative of the position, which is no unit that is known; which one is it?",
                relation.slope.abs()
            ));
        }
    }
    if relation.correlation < 0.0 {
        own.reversed = true;
        let against = "it runs against the derivative of the position; which of both is reversed?";
        own.questions.push(against.to_owned());
    }
}

/// A command of a position by the position that follows it.
fn command(log: &Log, own: &mut Judged, quantity: &Quantity, position: Option<&Judged>) {
    let named = stated(log, own.column, quantity);
    if let Some(position) = position.filter(|position| position.unit.is_none()) {
        own.unit = named;
        own.questions.extend(position.questions.iter().cloned());
        return;
    }
    let known = position.and_then(|position| {
        let unit = position.unit.clone()?;
        Some((unit, follows(log, own.column, position.column)?))
    });
    let Some((unit, (relation, delay))) = known else {
        own.unit = named.or(own.unit.take());
        let lacks = "no position shows its unit and sign; are they right?";
        own.questions.push(lacks.to_owned());
        return;
    };
    if relation.correlation.abs() < ALIKE {
        own.unit = named.or(Some(unit));
        let far = "the position hardly follows it; are its unit and its joint right?";
        own.questions.push(far.to_owned());
        return;
    }
    let texts: &[&str] = if quantity.has_angle {
        &["rad", "deg"]
    } else {
        &["m", "mm"]
    };
    // The position in SI per command in SI, in each unit of the command.
    let slope = |text: &str| relation.slope.abs() * scale(&unit) / scale(text);
    own.unit = named.or_else(|| Some(nearest(texts, slope).0.to_owned()));
    if relation.correlation < 0.0 {
        own.reversed = true;
        let against = "the position runs against it; which of both is reversed?";
        own.questions.push(against.to_owned());
    }
    if delay < 0.0 {
        own.questions.push(format!(
            "it follows the position by {:.0} ms; is it the command, not the position?",
            -1e3 * delay
        ));
    }
    own.note = Some(format!(
        "position follows after {:.0} ms",
        1e3 * delay.max(0.0)
    ));
}
