//! A line of `[channels]`: what a column is, its unit, and its scale.
//!
//! ```toml
//! elbow = { measures = "elbow", counts_per_turn = 4096, gear = 9, zero = 2048, scale = -1 }
//! ```

use std::f64::consts::TAU;

use appell_spec::expr::Span;
use appell_spec::mechanism::{Interpolation, Label};
use appell_spec::units::{Dimension, Unit};
use appell_spec::{Code, shown};
use toml::Spanned;
use toml::de::DeTable;

use crate::channel::{Channel, Measured, Role};
use crate::fields::{Fields, Tolerance, Value};
use crate::named::Named;

/// Largest size of one in a column, in SI.
const MOST_FACTOR: f64 = 1e30;
/// Keys of a line.
const KEYS: [&str; 14] = [
    "measures",
    "input",
    "unit",
    "unit_checked",
    "reversed",
    "noise_std",
    "scale_std",
    "gain_std",
    "interpolation",
    "time",
    "counts_per_turn",
    "gear",
    "scale",
    "zero",
];
/// Keys of a line that the one of the times has as well.
const OF_TIMES: [&str; 2] = ["unit", "time"];

/// Keys of a channel that the times do not have.
pub(crate) fn channel_keys() -> impl Iterator<Item = &'static str> {
    KEYS.into_iter().filter(|key| !OF_TIMES.contains(key))
}

/// How an input may run between rows.
const INTERPOLATIONS: [(&str, Interpolation); 3] = [
    ("hold", Interpolation::Hold),
    ("linear", Interpolation::Linear),
    ("cubic", Interpolation::Cubic),
];

/// A line, of one column.
pub(crate) struct Line<'l> {
    pub(crate) column: String,
    pub(crate) value: &'l Value<'l>,
    pub(crate) at: Span,
    /// What `*` stands for.
    pub(crate) filling: Option<String>,
}

impl Line<'_> {
    /// The name under a key; in a line of a pattern, `*` in it is filled.
    fn name(
        &self,
        fields: &mut Fields<'_>,
        table: &DeTable<'_>,
        key: &str,
    ) -> Option<(String, Span)> {
        let Some(filling) = &self.filling else {
            return fields.string(table, key);
        };
        let value = table.get(key)?;
        let name = crate::named::filled(value, filling)?;
        Some((name, value.span()))
    }
}

/// Reads a line.
pub(crate) fn channel(
    fields: &mut Fields<'_>,
    line: &Line<'_>,
    named: Named<'_>,
) -> Option<Channel> {
    let Line {
        column, value, at, ..
    } = line;
    let at = at.clone();
    let wanted = "a table such as { measures = \"theta\", unit = \"rad\" }";
    let table = fields.table(value, wanted)?;
    fields.only(table, &KEYS);
    fields.flag(table, "time");
    let measures = line.name(fields, table, "measures");
    let input = line.name(fields, table, "input");
    let role = match (measures, input) {
        (Some(_), Some((_, at))) => {
            let message = "a channel has `measures` or `input`, not both";
            fields.tell(Code::ConflictingKeys, message, at, "remove one of them");
            return None;
        }
        (Some((name, at)), None) => measured(fields, &name, at, named)?,
        (None, Some((name, at))) => commanded(fields, &name, at, named)?,
        (None, None) => Role::Recorded,
    };
    let label = role.label(named.mechanism);
    let unit = unit(fields, table, role, named);
    let stated = fields.deviation(table, "noise_std");
    if stated.is_some() && table.get("measures").is_none() {
        let message = "only measured channels have noise";
        fields.tell(Code::NotAllowedHere, message, at, "remove `noise_std`");
        return None;
    }
    let tolerance = tolerance(fields, table, role);
    // An invalid unit has been reported; a recorded channel may have none.
    let unit = match unit {
        None if table.get("unit").is_none() && label.is_none() => Unit::si(Dimension::NONE),
        unit => unit?,
    };
    let Scaled {
        unit,
        is_reversed,
        turn,
    } = scaled(fields, table, unit, label)?;
    let interpolation = interpolation(fields, table, role);
    let unit_checked = fields.flag(table, "unit_checked");
    let reversed = fields.flag(table, "reversed");
    let zero = table
        .get("zero")
        .and_then(|zero| fields.number(zero))
        .unwrap_or(0.0);
    let place = table.get("unit").map_or(at, Spanned::span);
    let stated_noise = stated.map(|std| std * unit.scale);
    Some(Channel {
        unit_at: Some(fields.place(place)),
        unit_checked,
        reversed: (is_reversed || table.get("reversed").is_some())
            .then_some(reversed != is_reversed),
        interpolation,
        tolerance,
        turn,
        zero,
        ..Channel::new(column, role, unit, stated_noise)
    })
}

/// The tolerance of the scale of a sensor, `scale_std`, or of the gain of an actuator, `gain_std`.
fn tolerance(fields: &mut Fields<'_>, table: &DeTable<'_>, role: Role) -> Option<f64> {
    let keys = [
        ("scale_std", "a measured channel has a scale", "gain_std"),
        ("gain_std", "an input has a gain", "scale_std"),
    ];
    let own = match role {
        Role::Measures(_) => "scale_std",
        Role::Input(_) => "gain_std",
        Role::Recorded => "",
    };
    let mut stated = None;
    for (key, why, other) in keys {
        let Some(value) = table.get(key) else {
            continue;
        };
        if key != own {
            let message = format!("only {why}");
            let help = format!("remove `{key}`, or write `{other}`");
            fields.tell(Code::NotAllowedHere, message, value.span(), &help);
            continue;
        }
        // A scale has no unit: both forms are shares.
        let (Tolerance::Absolute(share) | Tolerance::Relative(share)) =
            fields.tolerance(table, key)?;
        stated = Some(share);
    }
    stated.filter(|share| *share > 0.0)
}

/// The unit of a column. That of an actuator's command which is no position and no rate is a note: the number counts
/// as it stands.
fn unit(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    role: Role,
    named: Named<'_>,
) -> Option<Unit> {
    let label = role.label(named.mechanism);
    let own = label.map(|label| (label.name.as_str(), &label.unit));
    if table.get("counts_per_turn").is_some() {
        return label.map(|label| label.unit.clone());
    }
    let is_note = matches!(role, Role::Input(_))
        && (label.zip(named.robot)).is_some_and(|(label, robot)| robot.is_ctrl(&label.name));
    if !is_note {
        return fields.unit(table, own);
    }
    let (_, own) = own?;
    let stated = fields.unit(table, None);
    match (stated, table.get("unit")) {
        (Some(stated), _) => Some(Unit {
            text: stated.text,
            ..own.clone()
        }),
        (None, None) => Some(own.clone()),
        (None, Some(_)) => None,
    }
}

/// A unit with what an encoder makes of it.
struct Scaled {
    unit: Unit,
    is_reversed: bool,
    /// A turn of an encoder, in SI, after which its angle begins anew.
    turn: Option<f64>,
}

/// Applies `counts_per_turn`, `gear` and `scale`.
fn scaled(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    unit: Unit,
    label: Option<&Label>,
) -> Option<Scaled> {
    let mut number = |key: &str, is_positive: bool| {
        let value = table.get(key)?;
        let number = fields.number(value)?;
        if number == 0.0 || is_positive && number < 0.0 {
            let what = if is_positive { "positive" } else { "not zero" };
            let message = format!("`{key}` is {what}");
            fields.tell(Code::ValueOutsideLimits, message, value.span(), "");
            return None;
        }
        Some(number)
    };
    let counts = number("counts_per_turn", true);
    let gear = number("gear", true);
    let scale = number("scale", false);
    if fields.is_wrong() {
        return None;
    }
    if let Some(counts_at) = table.get("counts_per_turn").map(Spanned::span)
        && table.get("unit").is_some()
    {
        let message = "counts of an encoder have no other unit";
        fields.tell(Code::ConflictingKeys, message, counts_at, "remove `unit`");
        return None;
    }
    let is_turning = label.map_or(unit.has_angle(), |label| label.unit.has_angle());
    if let Some(key) = ["counts_per_turn", "gear"]
        .into_iter()
        .find_map(|key| table.get(key))
        && !is_turning
    {
        let message = "only angles and their rates have turns";
        let help = "write the unit, and `scale` for what one count is in it";
        fields.tell(Code::NotAllowedHere, message, key.span(), help);
        return None;
    }
    let per_turn = counts.map(|counts| TAU / counts);
    let ratio = gear.unwrap_or(1.0);
    let is_rate = unit.dimension != Dimension::NONE;
    let mut text = match counts {
        Some(_) if is_rate => "counts/s".to_owned(),
        Some(_) => "counts".to_owned(),
        None if gear.is_some() => format!("{} of the motor", unit.text),
        None => unit.text.clone(),
    };
    let size = scale.map_or(1.0, f64::abs);
    if let Some(scale) = scale.filter(|scale| scale.abs().total_cmp(&1.0).is_ne()) {
        text = format!("{} {text}", scale.abs());
    }
    let factor = per_turn.unwrap_or(unit.scale) / ratio * size;
    if !(factor.is_normal() && factor < MOST_FACTOR) {
        let at = table.get("scale").or(table.get("counts_per_turn"));
        let at = at.or(table.get("gear")).map_or(0..0, Spanned::span);
        let message = format!("one in this column would be {factor:e} in SI");
        fields.tell(Code::ValueOutsideLimits, message, at, "");
        return None;
    }
    let has_turns = counts.is_some() || gear.is_some();
    Some(Scaled {
        turn: (has_turns && !is_rate).then_some(TAU / ratio),
        is_reversed: scale.is_some_and(|scale| scale < 0.0),
        unit: Unit {
            text,
            scale: factor,
            ..unit
        },
    })
}

/// How an input runs between rows.
fn interpolation(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    role: Role,
) -> Option<Interpolation> {
    let (word, at) = fields.string(table, "interpolation")?;
    if !matches!(role, Role::Input(_)) {
        let message = "only inputs run on between rows";
        fields.tell(Code::NotAllowedHere, message, at, "remove `interpolation`");
        return None;
    }
    let mut known = INTERPOLATIONS.iter();
    let found = known.find(|(own, _)| *own == word);
    if found.is_none() {
        let message = format!("`{}` is no interpolation of an input", shown(&word));
        let help = "write \"hold\" where a value holds until the next row, \"linear\" for straight lines, \"cubic\" for a spline";
        fields.tell(Code::UnknownName, message, at, help);
    }
    found.map(|(_, interpolation)| *interpolation)
}

fn measured(fields: &mut Fields<'_>, name: &str, at: Span, named: Named<'_>) -> Option<Role> {
    let mechanism = named.mechanism;
    // A log has zeros there.
    if named.robot.is_some_and(|robot| robot.is_undriven(name)) {
        return Some(Role::Recorded);
    }
    let found = named.measured(name);
    if found.is_none() {
        let is_input = mechanism.inputs.iter().any(|i| i.label.name == name);
        if is_input {
            let message = format!("`{name}` is an input, which is commanded");
            let help = format!("write input = \"{name}\"");
            fields.tell(Code::NotAllowedHere, message, at, &help);
        } else if let Some(robot) = named.robot {
            let known = robot.quantities();
            let known = known.iter().map(String::as_str);
            fields.unknown("joint, its velocity or torque", name, at, known);
        } else {
            let known = Measured::names(mechanism);
            let what = "coordinate, pseudo-velocity or output";
            fields.unknown(what, name, at, known.into_iter());
        }
    }
    found.map(Role::Measures)
}

fn commanded(fields: &mut Fields<'_>, name: &str, at: Span, named: Named<'_>) -> Option<Role> {
    let names = || named.mechanism.inputs.iter().map(|i| i.label.name.as_str());
    let found = named.commanded(name);
    if found.is_none() {
        fields.unknown("input", name, at, names());
    }
    found
}
