//! The contents of `recording.toml`.
//!
//! ```toml
//! mechanism   = "pendulum"                 # a name of the library, or the path of a spec beside this file
//! description = "driven pendulum, encoder at the pivot"
//!
//! [parameters]                             # of this rig; std = tolerance, 0 = known exactly
//! m = { value = 2.04, unit = "kg", std = 0.04 }
//!
//! [channels]                               # every column other than the times
//! theta = { measures = "theta", unit = "deg", noise_std = 0.05 }
//! tau   = { input = "tau", unit = "N m" }  # held to the next row; interpolation = "linear" joins rows by lines, "cubic" by a spline
//! room  = { unit = "K" }                   # recorded, and in no model
//! omega = { measures = "omega", unit = "rpm", unit_checked = true }   # never doubted
//! alpha = { measures = "alpha", unit = "rad", reversed = true }       # positive the other way round
//! clock = { time = true, unit = "ms" }     # the column of the times, where its name does not tell it
//!
//! [runs]
//! fit  = ["run1.csv", "run2.csv"]
//! test = ["run3.csv"]
//! ```

use std::borrow::Cow;
use std::path::Path;

use appell_spec::expr::Span;
use appell_spec::limits::MAX_FILE;
use appell_spec::mechanism::{Interpolation, ParameterId};
use appell_spec::units::{Dimension, Unit};
use appell_spec::{Code, Mechanism, did_you_mean, shown};
use toml::Spanned;
use toml::de::DeTable;

use crate::channel::{Channel, Measured, Role};
use crate::fields::{Fields, Tolerance, Value};
use crate::limits::MAX_RUNS;
use crate::named::Named;
use crate::robot::{self, Robot};
use crate::time::{self, Stated, TIME, may_be_time};
use crate::{DataError, Library, Parameter, Part, Spec};

/// A description whose names and units fit the mechanism.
pub(crate) struct Manifest {
    pub(crate) spec: Spec,
    pub(crate) robot: Option<Robot>,
    pub(crate) mechanism: Mechanism,
    pub(crate) description: String,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) time: Stated,
    pub(crate) channels: Vec<Channel>,
    pub(crate) runs: Vec<(String, Part)>,
}

const KEYS: &[&str] = &[
    "mechanism",
    "description",
    "lock",
    "base",
    "parameters",
    "channels",
    "runs",
];
/// Keys of a channel that the times do not have.
const CHANNEL_KEYS: [&str; 6] = [
    "measures",
    "input",
    "noise_std",
    "unit_checked",
    "reversed",
    "interpolation",
];
/// How an input may run between rows.
const INTERPOLATIONS: [(&str, Interpolation); 3] = [
    ("hold", Interpolation::Hold),
    ("linear", Interpolation::Linear),
    ("cubic", Interpolation::Cubic),
];

/// Reads a description; `instead` replaces the mechanism that it names.
pub(crate) fn read(
    path: &Path,
    text: &str,
    library: Library<'_>,
    instead: Option<Spec>,
) -> Result<Manifest, DataError> {
    let file = path.to_string_lossy();
    let (mut fields, table) = Fields::new(&file, text);
    if fields.is_wrong() {
        return Err(fields.report().into());
    }
    let table = table.get_ref();
    fields.only(table, KEYS);
    let named = fields.string(table, "mechanism");
    let spec = match (instead, named) {
        (Some(spec), _) => Some(spec),
        (None, Some((name, at))) => find(&name, at, path, library, &mut fields)?,
        (None, None) => {
            let message = "the key `mechanism` is missing";
            let help = "name a shipped mechanism, or the path of a spec relative to this file";
            fields.tell(Code::MissingKey, message, 0..0, help);
            None
        }
    };
    let Some(spec) = spec else {
        return Err(fields.report().into());
    };
    let options = robot::options(&mut fields, table);
    if fields.is_wrong() {
        return Err(fields.report().into());
    }
    let keys = parameter_keys(table);
    let robot = Robot::read(Path::new(&spec.file), &spec.text, keys, &options)?;
    let (spec, robot) = match robot {
        Some((spec, robot)) => (spec, Some(robot)),
        None => (spec, None),
    };
    let mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
    let description = fields.string(table, "description");
    let named = Named {
        mechanism: &mechanism,
        robot: robot.as_ref(),
    };
    let parameters = parameters(&mut fields, table, named);
    let (time, channels) = channels(&mut fields, table, named);
    let runs = runs(&mut fields, table, path.parent().unwrap_or(Path::new("")));
    if fields.is_wrong() {
        return Err(fields.report().into());
    }
    Ok(Manifest {
        description: description.map_or_else(String::new, |(text, _)| text),
        spec,
        robot,
        mechanism,
        parameters,
        time,
        channels,
        runs,
    })
}

/// The keys of `[parameters]`.
fn parameter_keys(table: &DeTable<'_>) -> Vec<String> {
    let section = table
        .get("parameters")
        .and_then(|own| own.get_ref().as_table());
    let keys = section.into_iter().flat_map(DeTable::keys);
    keys.map(|key| key.get_ref().to_string()).collect()
}

/// The spec of a name, or of a path relative to the description.
fn find(
    name: &str,
    at: Span,
    manifest: &Path,
    library: Library<'_>,
    fields: &mut Fields<'_>,
) -> Result<Option<Spec>, DataError> {
    if let Some((_, spec)) = library.iter().find(|(known, _)| *known == name) {
        return Ok(Some(spec.clone()));
    }
    let folder = manifest.parent().unwrap_or(Path::new(""));
    let path = match appell_files::below(folder, name) {
        Ok(path) => path,
        Err(error) => {
            fields.tell(Code::NotAllowedHere, error.to_string(), at, "");
            return Ok(None);
        }
    };
    if path.exists() {
        return Ok(Some(Spec {
            file: path.to_string_lossy().into_owned(),
            text: appell_files::read_text(&path, MAX_FILE as u64)?,
        }));
    }
    let names = || library.iter().map(|(name, _)| *name);
    let help = did_you_mean(name, names(), || {
        "name a shipped mechanism, or the path of a spec relative to this file".to_owned()
    });
    let message = format!("there is no mechanism and no file `{}`", shown(name));
    fields.tell(Code::UnknownReference, message, at, &help);
    Ok(None)
}

/// The parameters of the spec with the values of this rig. An exact name counts before a pattern.
fn parameters(fields: &mut Fields<'_>, table: &DeTable<'_>, named: Named<'_>) -> Vec<Parameter> {
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
                    unknown(fields, "parameter", name, key.span(), known);
                }
            }
        }
        for (index, one) in found {
            let own = &named.mechanism.parameters[ParameterId::new(index)];
            let stated = named.robot.is_some().then(|| parameters[index]);
            match parameter(fields, value, own, stated, one) {
                Some(read) => parameters[index] = read,
                None => break,
            }
        }
    }
    parameters
}

/// Reads a parameter. One of a robot, `stated` in its file, needs no value; it may be a factor, of a number that is
/// `one` in SI.
fn parameter(
    fields: &mut Fields<'_>,
    value: &Value<'_>,
    own: &appell_spec::mechanism::Parameter,
    stated: Option<Parameter>,
    one: f64,
) -> Option<Parameter> {
    let Some(table) = value.get_ref().as_table() else {
        let wanted = "a table such as { value = 1.2, unit = \"kg\", std = 0.03 }";
        fields.wrong_type(value, wanted);
        return None;
    };
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
            let message = "the key `value` is missing";
            fields.tell(Code::MissingKey, message, value.span(), "");
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

/// The description of the times, and the channels.
fn channels(
    fields: &mut Fields<'_>,
    table: &DeTable<'_>,
    named: Named<'_>,
) -> (Stated, Vec<Channel>) {
    let Some(table) = fields.section(table, "channels") else {
        if table.get("channels").is_none() {
            let message = "the section `[channels]` is missing";
            let help =
                "write a line for each column, such as x = { measures = \"x\", unit = \"m\" }";
            fields.tell(Code::MissingSection, message, 0..0, help);
        }
        return (Stated::default(), Vec::new());
    };
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let mut time = Stated::default();
    if let Some((name, value)) = clock(fields, &entries) {
        entries.retain(|(key, _)| key.get_ref() != name);
        time = Stated {
            column: Some(name.to_owned()),
            unit: unit_of_times(fields, name, value),
            by_name_alone: name != TIME && !is_time(value),
        };
    }
    let read = entries
        .into_iter()
        .filter_map(|(key, value)| channel(fields, key.get_ref(), value, key.span(), named));
    let channels: Vec<Channel> = read.collect();
    if !fields.is_wrong() && !channels.iter().any(Channel::is_measured) {
        let message = "no channel measures anything";
        let help =
            "at least one needs `measures`, the name of a coordinate, pseudo-velocity or output";
        fields.tell(Code::MissingKey, message, 0..0, help);
    }
    (time, channels)
}

/// The entry of the times: the one with `time = true`, that of `t`, or the only other one with the name of a clock and
/// no other role.
fn clock<'e>(
    fields: &mut Fields<'_>,
    entries: &[(&'e Spanned<Cow<'e, str>>, &'e Value<'e>)],
) -> Option<(&'e str, &'e Value<'e>)> {
    let is_bare = |value: &Value<'_>| {
        let table = value.get_ref().as_table();
        let has = |key: &&str| table.is_some_and(|table| table.get(*key).is_some());
        !CHANNEL_KEYS.iter().chain(&["time"]).any(has)
    };
    let lines = || {
        entries
            .iter()
            .map(|(key, value)| (&**key.get_ref(), *value))
    };
    let mut stated = entries.iter().filter(|(_, value)| is_time(value));
    if let Some((key, value)) = stated.next() {
        if let Some((second, _)) = stated.next() {
            let message = "a second column of the times";
            let help = format!(
                "remove `time = true` here, or at `{}`",
                shown(key.get_ref())
            );
            fields.tell(Code::DuplicateName, message, second.span(), &help);
        }
        return Some((key.get_ref(), value));
    }
    if let Some(own) = lines().find(|(name, _)| *name == TIME) {
        return Some(own);
    }
    let mut clocks =
        (entries.iter()).filter(|(key, value)| may_be_time(key.get_ref()) && is_bare(value));
    let (first, value) = clocks.next()?;
    if let Some((second, _)) = clocks.next() {
        let (first, other) = (first.get_ref(), second.get_ref());
        let message = format!(
            "`{}` and `{}` may both be the times",
            shown(first),
            shown(other)
        );
        let help = format!("write {} for the one that is", time::line(first, "s"));
        fields.tell(Code::ConflictingKeys, message, second.span(), &help);
    }
    Some((first.get_ref(), value))
}

/// Whether an entry has `time = true`.
fn is_time(value: &Value<'_>) -> bool {
    let table = value.get_ref().as_table();
    table.and_then(|table| table.get("time")?.get_ref().as_bool()) == Some(true)
}

/// The unit of the times in their line.
fn unit_of_times(fields: &mut Fields<'_>, name: &str, value: &Value<'_>) -> Option<Unit> {
    let Some(table) = value.get_ref().as_table() else {
        fields.wrong_type(value, "a table such as { unit = \"ms\" }");
        return None;
    };
    let is_channel = |key: &&str| table.get(*key).is_some();
    if CHANNEL_KEYS.iter().any(is_channel) {
        let message = format!("`{}` is the time, not a channel", shown(name));
        let help = "remove the line, or state the unit of the times alone: { unit = \"ms\" }";
        fields.tell(Code::ReservedName, message, value.span(), help);
        return None;
    }
    fields.only(table, &["time", "unit"]);
    fields.flag(table, "time");
    fields
        .unit(table, Some((name, &Unit::si(Dimension::TIME))))
        .filter(|_| table.get("unit").is_some())
}

fn channel(
    fields: &mut Fields<'_>,
    column: &str,
    value: &Value<'_>,
    at: Span,
    named: Named<'_>,
) -> Option<Channel> {
    let Some(table) = value.get_ref().as_table() else {
        let wanted = "a table such as { measures = \"theta\", unit = \"rad\" }";
        fields.wrong_type(value, wanted);
        return None;
    };
    fields.only(
        table,
        &[
            "measures",
            "input",
            "unit",
            "unit_checked",
            "reversed",
            "noise_std",
            "interpolation",
            "time",
        ],
    );
    fields.flag(table, "time");
    let measures = fields.string(table, "measures");
    let input = fields.string(table, "input");
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
    let unit = fields.unit(table, label.map(|label| (label.name.as_str(), &label.unit)));
    let stated = fields.deviation(table, "noise_std");
    if stated.is_some() && !matches!(role, Role::Measures(_)) {
        let message = "only measured channels have noise";
        fields.tell(Code::NotAllowedHere, message, at, "remove `noise_std`");
        return None;
    }
    let unit: Unit = match unit {
        Some(unit) => unit,
        // An invalid unit has been reported; a recorded channel may have none.
        None if table.get("unit").is_none() => Unit::si(Dimension::NONE),
        None => return None,
    };
    let interpolation = interpolation(fields, table, role);
    let unit_checked = fields.flag(table, "unit_checked");
    let reversed = fields.flag(table, "reversed");
    let place = table.get("unit").map_or(at, Spanned::span);
    let stated_noise = stated.map(|std| std * unit.scale);
    Some(Channel {
        unit_at: Some(fields.place(place)),
        unit_checked,
        reversed: table.get("reversed").map(|_| reversed),
        interpolation,
        ..Channel::new(column, role, unit, stated_noise)
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
    let own = named.robot.and_then(|robot| robot.measured(name));
    let found = Measured::named(own.unwrap_or(name), mechanism);
    if found.is_none() {
        let is_input = mechanism.inputs.iter().any(|i| i.label.name == name);
        if is_input {
            let message = format!("`{name}` is an input, which is commanded");
            let help = format!("write input = \"{name}\"");
            fields.tell(Code::NotAllowedHere, message, at, &help);
        } else if let Some(robot) = named.robot {
            let known = robot.quantities();
            let known = known.iter().map(String::as_str);
            unknown(fields, "joint, its velocity or torque", name, at, known);
        } else {
            let known = Measured::names(mechanism);
            let what = "coordinate, pseudo-velocity or output";
            unknown(fields, what, name, at, known.into_iter());
        }
    }
    found.map(Role::Measures)
}

fn commanded(fields: &mut Fields<'_>, name: &str, at: Span, named: Named<'_>) -> Option<Role> {
    let names = || named.mechanism.inputs.iter().map(|i| i.label.name.as_str());
    let own = named.robot.and_then(|robot| robot.input(name));
    let found = names().position(|known| known == own.unwrap_or(name));
    if found.is_none() {
        unknown(fields, "input", name, at, names());
    }
    found.map(Role::Input)
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

fn unknown<'n>(
    fields: &mut Fields<'_>,
    what: &str,
    name: &str,
    at: Span,
    known: impl Iterator<Item = &'n str> + Clone,
) {
    let help = did_you_mean(name, known.clone(), || {
        let list: Vec<&str> = known.collect();
        if list.is_empty() {
            format!("the mechanism has no {what}")
        } else {
            format!("there are {}", list.join(", "))
        }
    });
    let message = format!("the spec has no {what} `{}`", shown(name));
    fields.tell(Code::UnknownName, message, at, &help);
}

/// The files of the runs, those to fit first.
fn runs(fields: &mut Fields<'_>, table: &DeTable<'_>, folder: &Path) -> Vec<(String, Part)> {
    let Some(table) = fields.section(table, "runs") else {
        if table.get("runs").is_none() {
            let message = "the section `[runs]` is missing";
            let help = "write fit = [\"run1.csv\"] and test = [\"run2.csv\"]";
            fields.tell(Code::MissingSection, message, 0..0, help);
        }
        return Vec::new();
    };
    fields.only(table, &["fit", "test"]);
    let mut runs: Vec<(String, Part)> = Vec::new();
    for (key, part) in [("fit", Part::Fit), ("test", Part::Test)] {
        for (name, at) in fields.strings(table, key) {
            if let Err(error) = appell_files::below(folder, &name) {
                fields.tell(Code::NotAllowedHere, error.to_string(), at, "");
            } else if let Some((_, other)) = runs.iter().find(|(other, _)| *other == name) {
                let message = format!("the run `{}` stands here twice", shown(&name));
                let help = if *other == part {
                    "remove one of them"
                } else {
                    "a run that is held out may not be fitted"
                };
                fields.tell(Code::DuplicateName, message, at, help);
            } else if runs.len() == MAX_RUNS {
                let message = format!("a data set has at most {MAX_RUNS} runs");
                fields.tell(Code::LimitExceeded, message, at, "");
                return runs;
            } else {
                runs.push((name, part));
            }
        }
    }
    if !fields.is_wrong() && !runs.iter().any(|(_, part)| *part == Part::Fit) {
        let message = "there is no run to fit";
        let help = "write fit = [\"run1.csv\"]";
        fields.tell(Code::MissingKey, message, 0..0, help);
    }
    runs
}
