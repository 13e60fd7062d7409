//! `[parameters]`: the numbers of a rig with their tolerances.

use appell_spec::expr::Span;
use appell_spec::mechanism::ParameterId;
use appell_spec::units::{Dimension, Unit};
use appell_spec::{Code, did_you_mean, shown};
use toml::de::DeTable;

use crate::Parameter;
use crate::fields::{Fields, Tolerance, Value};
use crate::named::Named;
use crate::robot::Robot;

/// The parameters of the spec with the values of this rig. An exact name counts before a pattern.
pub(crate) fn parameters(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    named: Named<'_>,
) -> Vec<Parameter> {
    let own = named.mechanism.parameters.iter();
    let mut parameters: Vec<Parameter> = own.map(Parameter::stated).collect();
    let Some(table) = fields.section(table, "parameters") else {
        return parameters;
    };
    let is_pattern = |name: &str| name.starts_with('*');
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| (!is_pattern(key.get_ref()), key.span().start));
    for (key, value) in entries {
        let name = key.get_ref().as_ref();
        let found = named.parameters(name);
        if found.is_empty() {
            match named.robot {
                // A time constant or a delay of an actuator is no parameter of the spec.
                Some(robot) if robot.numbers(name).next().is_some() => {}
                Some(robot) => unknown_number(fields, robot, name, key.span()),
                None => {
                    let own = named.mechanism.parameters.iter();
                    let known = own.map(|parameter| parameter.label.name.as_str());
                    fields.unknown("parameter", name, key.span(), known);
                }
            }
        }
        for (index, one) in found {
            let Some(read) = parameter(fields, value, named, &parameters, (index, one)) else {
                break;
            };
            parameters[index] = read;
        }
    }
    parameters
}

/// Reads one of the parameters. One of a robot, stated in its file, needs no value; it may be a factor, of a number that
/// is `one` in SI.
pub(crate) fn parameter(
    fields: &mut Fields<'_>,
    value: &Value<'_>,
    named: Named<'_>,
    parameters: &[Parameter],
    (index, one): (usize, f64),
) -> Option<Parameter> {
    let own = &named.mechanism.parameters[ParameterId::new(index)];
    let stated = named.robot.is_some().then(|| parameters[index]);
    let wanted = "a table such as { value = 1.2, unit = \"kg\", std = 0.03 }";
    let table = fields.table(value, wanted)?;
    fields.only(table, &["value", "unit", "std"]);
    let is_factor = stated.is_some() && own.label.unit.dimension == Dimension::NONE;
    let quantity = (own.label.name.as_str(), &own.label.unit);
    let unit = fields.unit(table, (!is_factor).then_some(quantity));
    let unit = unit.or_else(|| is_factor.then(|| Unit::si(Dimension::NONE)))?;
    let scale = unit.scale / one;
    let tolerance = fields.tolerance(table, "std");
    let value = match (table.get("value"), stated) {
        (Some(number), _) => {
            let at = number.span();
            let value = fields.number(number)? * scale;
            outside(fields, own, value, &unit, &at);
            value
        }
        (None, Some(stated)) => stated.value,
        (None, None) => {
            fields.missing("value", value.span(), "");
            return None;
        }
    };
    let std = tolerance.map(|tolerance| match tolerance {
        Tolerance::Absolute(std) => std * scale,
        Tolerance::Relative(share) => share * value.abs(),
    });
    Some(Parameter { value, std })
}

/// Reports a value outside the limits of its parameter.
fn outside(
    fields: &mut Fields<'_>,
    own: &appell_spec::mechanism::Parameter,
    value: f64,
    unit: &Unit,
    at: &Span,
) {
    let limits = [
        own.at_least
            .filter(|least| value < *least)
            .map(|least| ("below", least)),
        own.at_most
            .filter(|most| value > *most)
            .map(|most| ("above", most)),
    ];
    for (side, limit) in limits.into_iter().flatten() {
        let limit = unit.from_si(limit);
        let message = format!(
            "`{}` is {side} its limit of {limit} {}",
            own.label.name, unit.text
        );
        fields.tell(Code::ValueOutsideLimits, message, at.clone(), "");
    }
}

/// Reports a key of `[parameters]` that names nothing of a robot.
fn unknown_number(fields: &mut Fields<'_>, robot: &Robot, name: &str, at: Span) {
    let entries = robot.dictionary.entries.iter();
    let known: Vec<String> = entries
        .map(|entry| format!("{}.{}", entry.element, entry.attribute))
        .collect();
    let help = did_you_mean(name, known.iter().map(String::as_str), || {
        "write ELEMENT.ATTRIBUTE with names of the robot file, such as \"elbow.damping\", or \"*.mass\" for all"
            .to_owned()
    });
    let message = format!("the robot has no number `{}`", shown(name));
    fields.tell(Code::UnknownName, message, at, &help);
}
