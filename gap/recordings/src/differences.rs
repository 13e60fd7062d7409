//! What differs in a run: a known weight in the gripper, another number of the rig.
//!
//! ```toml
//! [run."loaded.csv"]
//! payload    = { on = "hand", mass = 1.5, at = [0, 0, 0.08] }    # kg and m, from the origin of the body along its axes
//! parameters = { "wrist.damping" = { value = 0.4 } }             # as in [parameters], without a tolerance
//! ```
//!
//! The value of all runs, and its tolerance, stand in `[parameters]`; that of the run differs from it by a known amount.
//! A payload is a body of the spec without mass, whose mass differs in its runs.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write as _;

use appell_spec::compose::Composition;
use appell_spec::expr::Span;
use appell_spec::mechanism::ParameterId;
use appell_spec::{Code, Mechanism, did_you_mean, shown};
use toml::de::DeTable;

use crate::fields::{Fields, Value};
use crate::named::Named;
use crate::parameters::parameter;
use crate::robot::Robot;
use crate::set::Difference;
use crate::{Parameter, Part, Spec};

/// The section.
pub(crate) const SECTION: &str = "run";
const KEYS: &[&str] = &["payload", "parameters"];

/// A weight on a body in some runs.
pub(crate) struct Payload {
    run: String,
    on: String,
    mass: f64,
    at: [f64; 3],
    place: Span,
}

/// The tables of the runs.
fn tables<'a, 'd>(
    fields: &mut Fields<'_>,
    table: &'a DeTable<'d>,
) -> Vec<(String, Span, &'a DeTable<'d>)> {
    let mut tables = Vec::new();
    let section = fields.section(table, SECTION);
    for (key, value) in section.into_iter().flatten() {
        let own = fields.table(value, "a table such as { payload = { … } }");
        tables.extend(own.map(|own| (key.get_ref().to_string(), key.span(), own)));
    }
    tables
}

/// The names of the parameters of a table, that of all runs or of one.
pub(crate) fn parameter_keys(table: &DeTable<'_>) -> Vec<String> {
    let own = table.get("parameters");
    let own = own.and_then(|own| own.get_ref().as_table());
    let keys = own.into_iter().flat_map(DeTable::keys);
    keys.map(|key| key.get_ref().to_string()).collect()
}

/// The names of parameters that runs have of their own.
pub(crate) fn keys(table: &DeTable<'_>) -> Vec<String> {
    let runs = table.get(SECTION).and_then(|own| own.get_ref().as_table());
    let runs = runs.into_iter().flat_map(DeTable::values);
    let runs = runs.filter_map(|run| run.get_ref().as_table());
    runs.flat_map(parameter_keys).collect()
}

/// The payloads of all runs.
pub(crate) fn payloads(fields: &mut Fields<'_>, table: &DeTable<'_>) -> Vec<Payload> {
    let mut payloads = Vec::new();
    for (run, _, own) in tables(fields, table) {
        fields.only(own, KEYS);
        let Some(value) = own.get("payload") else {
            continue;
        };
        let wanted = "a table { on = \"hand\", mass = 1.5, at = [0, 0, 0.08] }";
        let Some(own) = fields.table(value, wanted) else {
            continue;
        };
        fields.only(own, &["on", "mass", "at"]);
        let on = fields.string(own, "on");
        let mass = own.get("mass");
        if mass.is_none() {
            fields.missing("mass", value.span(), "");
        }
        let mass = mass.and_then(|mass| fields.number(mass));
        let at = own
            .get("at")
            .map_or(Some([0.0; 3]), |at| vector(fields, at));
        if on.is_none() && own.get("on").is_none() {
            fields.missing("on", value.span(), "name the body that carries the payload");
        }
        if let Some(mass) = mass.filter(|mass| *mass < 0.0) {
            let message = format!("a payload of {mass} kg");
            let help = "a mass is not negative";
            fields.tell(Code::ValueOutsideLimits, message, value.span(), help);
        } else if let (Some((on, place)), Some(mass), Some(at)) = (on, mass, at) {
            payloads.push(Payload {
                run,
                on,
                mass,
                at,
                place,
            });
        }
    }
    payloads
}

fn vector(fields: &mut Fields<'_>, value: &Value<'_>) -> Option<[f64; 3]> {
    let list = value.get_ref().as_array().filter(|list| list.len() == 3);
    let Some(list) = list else {
        fields.wrong_type(value, "three numbers in m");
        return None;
    };
    let mut at = [0.0; 3];
    for (at, value) in at.iter_mut().zip(list.iter()) {
        *at = fields.number(value)?;
    }
    Some(at)
}

/// A spec with the bodies of payloads, and the mass of each in its run.
pub(crate) fn with_payloads(
    fields: &mut Fields<'_>,
    payloads: &[Payload],
    mut spec: Spec,
    mechanism: &Mechanism,
    robot: Option<&Robot>,
) -> (Spec, Vec<(String, Difference)>) {
    // Payloads of one place are one body.
    let mut bodies: BTreeMap<(&str, [u64; 3]), String> = BTreeMap::new();
    let (mut items, mut differences) = (String::new(), Vec::new());
    for payload in payloads {
        let place = (payload.on.as_str(), payload.at.map(f64::to_bits));
        let count = bodies.len();
        let name = match bodies.entry(place) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(other) => {
                let Some([point, frame, own]) = carrier(mechanism, robot, &payload.on) else {
                    let known = mechanism.bodies.iter().map(|body| body.name.as_str());
                    fields.unknown("body", &payload.on, payload.place.clone(), known);
                    continue;
                };
                let name = free_name(mechanism, &format!("payload_on_{own}"), count);
                items.push_str(&body(&name, point, frame, payload.at));
                other.insert(name).clone()
            }
        };
        differences.push((
            payload.run.clone(),
            Difference {
                parameter: format!("{name}_mass"),
                by: payload.mass,
            },
        ));
    }
    let composed = Composition::new(&spec.text).and_then(|mut whole| {
        whole.add(&items)?;
        Ok(whole.text())
    });
    // What does not compose was reported when the spec was read.
    if let (Ok(text), false) = (composed, items.is_empty()) {
        spec.text = text;
    }
    (spec, differences)
}

/// The origin of a body, its frame and its name in the spec: a point of the spec, or the centre of mass of a body.
fn carrier<'m>(
    mechanism: &'m Mechanism,
    robot: Option<&Robot>,
    name: &str,
) -> Option<[&'m str; 3]> {
    let frame = |id| mechanism.frames[id].name.as_str();
    let bodies = robot.map(|robot| robot.dictionary.bodies.iter());
    let of_file = bodies.and_then(|mut bodies| bodies.find(|body| body.name == name));
    let names = [Some(name), of_file.map(|body| body.body.as_str())];
    for name in names.into_iter().flatten() {
        let point = mechanism.points.iter().find(|point| point.name == name);
        if let Some(body) = mechanism.bodies.iter().find(|body| body.name == name) {
            let origin = point.unwrap_or(&mechanism.points[body.centre]);
            let frame = frame(body.frame.unwrap_or(origin.frame));
            return Some([&origin.name, frame, &body.name]);
        }
        if let Some(point) = point {
            return Some([&point.name, frame(point.frame), &point.name]);
        }
    }
    None
}

/// The parameters of the runs that differ from those of all runs; `payloads` are those of masses.
pub(crate) fn of_runs(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    named: Named<'_>,
    parameters: &[Parameter],
    payloads: &[(String, Difference)],
    runs: &[(String, Part)],
) -> BTreeMap<String, Vec<Difference>> {
    let mut all: BTreeMap<String, Vec<Difference>> = BTreeMap::new();
    for (run, difference) in payloads {
        all.entry(run.clone()).or_default().push(difference.clone());
    }
    for (run, at, own) in tables(fields, table) {
        if !runs.iter().any(|(name, _)| *name == run) {
            let known = runs.iter().map(|(name, _)| name.as_str());
            let help = did_you_mean(&run, known, || "the runs are those of `[runs]`".to_owned());
            let message = format!("there is no run `{}`", shown(&run));
            fields.tell(Code::UnknownReference, message, at, &help);
        }
        let of_run = fields.section(own, "parameters");
        for (key, value) in of_run.into_iter().flatten() {
            let found = named.parameters(key.get_ref());
            if found.is_empty() {
                let known = named.mechanism.parameters.iter();
                let known = known.map(|parameter| parameter.label.name.as_str());
                fields.unknown("parameter", key.get_ref(), key.span(), known);
            }
            for (index, one) in found {
                let Some(read) = parameter(fields, value, named, parameters, (index, one)) else {
                    break;
                };
                let own = &named.mechanism.parameters[ParameterId::new(index)];
                all.entry(run.clone()).or_default().push(Difference {
                    parameter: own.label.name.clone(),
                    by: read.value - parameters[index].value,
                });
            }
        }
    }
    all
}

/// A name that is not in the spec, nor that of another payload.
fn free_name(mechanism: &Mechanism, wanted: &str, own: usize) -> String {
    let is_known = |name: &str| {
        mechanism.bodies.iter().any(|body| body.name == name)
            || mechanism.points.iter().any(|point| point.name == name)
    };
    let mut name = match own {
        0 => wanted.to_owned(),
        own => format!("{wanted}_{}", own + 1),
    };
    while is_known(&name) {
        name.push_str("_too");
    }
    name
}

fn body(name: &str, point: &str, frame: &str, at: [f64; 3]) -> String {
    let mut items = String::new();
    let [x, y, z] = at.map(|own| format!("\"{own} [m]\""));
    let mass = format!(
        "{name}_mass = {{ value = 0, unit = \"kg\", at_least = 0, about = \"mass of a payload of some runs\" }}"
    );
    let place =
        format!("{name} = {{ from = \"{point}\", in = \"{frame}\", at = [{x}, {y}, {z}] }}");
    let heavy = format!("{name} = {{ centre = \"{name}\", mass = \"{name}_mass\" }}");
    for (section, item) in [("parameters", mass), ("points", place), ("bodies", heavy)] {
        // A text takes everything.
        let _ = writeln!(items, "[{section}]\n{item}\n");
    }
    items
}
