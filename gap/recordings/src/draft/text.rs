//! The text of a draft.

use std::fmt::Write as _;

use appell_spec::Mechanism;

use super::judged::Judged;
use super::log::{Clock, Log, line};
use super::quantities::Quantity;
use super::words::Kind;
use crate::robot::Robot;
use crate::time;

/// Tolerances that are usual for numbers of a robot file, by attribute.
const TOLERANCES: [(&str, &str); 11] = [
    ("mass", "{ std = \"3 %\" }"),
    ("com", "{ std = 0.002, unit = \"m\" }"),
    ("inertia", "{ std = \"10 %\" }"),
    ("kp", "{ std = \"2 %\" }"),
    ("kv", "{ std = \"5 %\" }"),
    ("gain", "{ std = \"2 %\" }"),
    ("gear", "{ std = \"2 %\" }"),
    ("armature", "{ std = \"10 %\" }"),
    ("damping", "{ std = \"15 %\" }"),
    ("frictionloss", "{ std = \"15 %\" }"),
    ("stiffness", "{ std = \"10 %\" }"),
];
/// Usual tolerance of a parameter of a spec, relative to its value.
const TOLERANCE: f64 = 0.03;

/// The patterns that may be in `[parameters]` of a robot.
pub(super) fn patterns() -> Vec<String> {
    let all = TOLERANCES.iter();
    all.map(|(attribute, _)| format!("*.{attribute}")).collect()
}

/// What a draft says.
pub(super) struct Content<'c> {
    /// Path of the mechanism.
    pub(super) mechanism: &'c str,
    pub(super) names: &'c Mechanism,
    pub(super) robot: Option<&'c Robot>,
    pub(super) log: &'c Log,
    pub(super) quantities: &'c [Quantity],
    pub(super) channels: &'c [Judged],
    /// Columns that are no quantity, with a question for each that may be one.
    pub(super) others: &'c [usize],
    /// Noise levels in the unit of each channel, where they are known.
    pub(super) noise: Vec<Option<f64>>,
    pub(super) fit: &'c [String],
    pub(super) test: &'c [String],
}

impl Content<'_> {
    /// The text of the description.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, to: &mut String) -> std::fmt::Result {
        writeln!(
            to,
            "# Drafted from the recordings. A line that begins with `# ?` asks for what is missing.\n"
        )?;
        writeln!(to, "mechanism   = {}", quoted(self.mechanism))?;
        writeln!(to, "description = \"\"")?;
        match &self.log.clock {
            Clock::Rate(rate) => writeln!(to, "rate        = {rate}  # rows per second")?,
            Clock::Unknown => writeln!(
                to,
                "# ? no column is the time: how many rows are there per second?\n# rate      = 100"
            )?,
            Clock::Column { .. } => {}
        }
        self.parameters(to)?;
        writeln!(to, "\n[channels]")?;
        if let Clock::Column {
            question: Some(question),
            ..
        } = &self.log.clock
        {
            writeln!(to, "# ? {}", comment(question))?;
        }
        if let Some(line) = line(&self.log.clock, &self.log.names) {
            writeln!(to, "{line}")?;
        }
        for (channel, noise) in self.channels.iter().zip(&self.noise) {
            self.channel(to, channel, *noise)?;
        }
        for &column in self.others {
            let name = &self.log.names[column];
            writeln!(to, "# {} = {{ unit = \"1\" }}  # in no model?", key(name))?;
        }
        let list = |names: &[String]| {
            let names = ranges(names).into_iter().map(|name| quoted(&name));
            names.collect::<Vec<_>>().join(", ")
        };
        writeln!(to, "\n[runs]\nfit  = [{}]", list(self.fit))?;
        writeln!(to, "test = [{}]  # held out", list(self.test))
    }

    fn parameters(&self, to: &mut String) -> std::fmt::Result {
        if let Some(robot) = self.robot {
            writeln!(
                to,
                "\n[parameters]  # tolerances, one standard deviation; these are usual: write how well you know yours"
            )?;
            let has = |attribute: &str| {
                let pattern = format!("*.{attribute}");
                robot.numbers(&pattern).next().is_some()
            };
            for (attribute, tolerance) in TOLERANCES.iter().filter(|(own, _)| has(own)) {
                writeln!(to, "\"*.{attribute}\" = {tolerance}")?;
            }
            return Ok(());
        }
        writeln!(
            to,
            "\n[parameters]  # tolerances, one standard deviation; these are usual: keep those of what you know so well"
        )?;
        for own in &self.names.parameters {
            let label = &own.label;
            let value = label.unit.from_si(own.value);
            let std = rounded(
                label
                    .unit
                    .from_si(own.std.unwrap_or(TOLERANCE * own.value.abs())),
            );
            writeln!(
                to,
                "# {} = {{ value = {value}, unit = {}, std = {std} }}",
                label.name,
                quoted(&label.unit.text)
            )?;
        }
        Ok(())
    }

    fn channel(&self, to: &mut String, channel: &Judged, noise: Option<f64>) -> std::fmt::Result {
        let quantity = &self.quantities[channel.quantity];
        for question in &channel.questions {
            writeln!(to, "# ? {}", comment(question))?;
        }
        let verb = match quantity.kind {
            Kind::Command => "input",
            Kind::Position | Kind::Rate | Kind::Torque => "measures",
        };
        let name = key(&self.log.names[channel.column]);
        let quantity = quoted(&quantity.name);
        match &channel.unit {
            Some(unit) => write!(
                to,
                "{name} = {{ {verb} = {quantity}, unit = {}",
                quoted(unit)
            )?,
            None => write!(
                to,
                "# {name} = {{ {verb} = {quantity}, counts_per_turn = 4096, gear = 1"
            )?,
        }
        if let Some(noise) = noise {
            write!(to, ", noise_std = {}", rounded(noise))?;
        }
        if channel.reversed {
            write!(to, ", reversed = true")?;
        }
        write!(to, " }}")?;
        if let Some(note) = &channel.note {
            write!(to, "  # {note}")?;
        }
        writeln!(to)
    }
}

/// Successive episodes of a file as one range: `all.parquet#0-7`.
fn ranges(names: &[String]) -> Vec<String> {
    let episode = |name: &String| {
        let (file, number) = name.rsplit_once('#')?;
        Some((file.to_owned(), number.parse::<u64>().ok()?))
    };
    let mut all: Vec<(String, Option<[u64; 2]>)> = Vec::new();
    for name in names {
        match (episode(name), all.last_mut()) {
            (Some((file, number)), Some((last, Some([_, end]))))
                if *last == file && *end + 1 == number =>
            {
                *end = number;
            }
            (Some((file, number)), _) => all.push((file, Some([number; 2]))),
            (None, _) => all.push((name.clone(), None)),
        }
    }
    let written = |(file, range): (String, Option<[u64; 2]>)| match range {
        None => file,
        Some([first, last]) if first == last => format!("{file}#{first}"),
        Some([first, last]) => format!("{file}#{first}-{last}"),
    };
    all.into_iter().map(written).collect()
}

/// Three digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// A text in one line.
fn comment(text: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(plain).collect()
}

/// A key of a table.
fn key(name: &str) -> String {
    if time::is_bare(name) {
        name.to_owned()
    } else {
        quoted(name)
    }
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = "\"".to_owned();
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
