//! The gap report that `appell apply` reads, and the summary of the improved spec.

use std::fmt::Write as _;
use std::path::Path;

use appell_gap::diagnose::{Changes, Refitted, SignalEffect};
use serde::Deserialize;

use appell::Error;
use appell::files;
use appell_report::text::{number, with_unit};

/// Name and version of the format.
const SCHEMA: &str = "gap-report/1";

/// The parts of a report that are needed here.
#[derive(Debug, Deserialize)]
pub(crate) struct Report {
    schema: String,
    pub(crate) mechanism: String,
    which: Vec<Hypothesis>,
    #[serde(default)]
    tied: Vec<Vec<String>>,
}

/// A hypothesis of a report.
#[derive(Debug, Deserialize)]
pub(crate) struct Hypothesis {
    effects: Vec<String>,
    probability: f64,
    #[serde(default)]
    parameters: Vec<Found>,
    changes: Option<Written>,
}

#[derive(Debug, Deserialize)]
struct Found {
    name: String,
    value: Option<f64>,
    std: Option<f64>,
    unit: String,
}

#[derive(Debug, Deserialize)]
struct Written {
    items: String,
    inputs: Vec<Added>,
    parameters: Vec<Parameter>,
    beside: Vec<Outside>,
}

#[derive(Debug, Deserialize)]
struct Added {
    input: String,
    adds: String,
}

#[derive(Debug, Deserialize)]
struct Parameter {
    name: String,
    stated: f64,
    value: f64,
    std: Option<f64>,
    unit: String,
}

#[derive(Debug, Deserialize)]
struct Outside {
    effect: String,
    acts: String,
    on: String,
}

impl Report {
    /// Reads the file that `appell diagnose --json` wrote.
    pub(crate) fn read(path: &Path) -> Result<Self, Error> {
        let file = path.display();
        let text = files::read(path, files::MAX_DATA)?;
        let report: Self = serde_json::from_str(&text).map_err(|cause| {
            Error::Data(format!(
                "{file}: this is not a gap report: {cause}\n  write one with `appell diagnose --json {file}`"
            ))
        })?;
        if report.schema != SCHEMA {
            let found = &report.schema;
            return Err(Error::Data(format!(
                "{file}: unsupported schema `{found}`; this version reads `{SCHEMA}`"
            )));
        }
        Ok(report)
    }

    /// The hypothesis with this number, from 1; the most probable one without.
    pub(crate) fn hypothesis(&self, wanted: Option<usize>) -> Result<&Hypothesis, Error> {
        let count = self.which.len();
        let place = wanted.unwrap_or(1);
        let found = place.checked_sub(1).and_then(|index| self.which.get(index));
        let found = found.ok_or_else(|| {
            Error::Usage(format!(
                "there is no hypothesis {place}: the report has {count}, numbered from 1"
            ))
        })?;
        if let Some(name) = found.alternative() {
            return Err(Error::Usage(format!(
                "hypothesis {place} is another model, `{name}`: use its spec\n  choose another \
                 hypothesis with `--hypothesis`:\n{}",
                self.list()
            )));
        }
        if found.changes.is_none() {
            return Err(Error::Usage(format!(
                "hypothesis {place} states that no effect of the library explains the gap: there is \
                nothing to write\n  choose another one with `--hypothesis`:\n{}",
                self.list()
            )));
        }
        Ok(found)
    }

    fn list(&self) -> String {
        let lines = self.which.iter().enumerate().map(|(index, hypothesis)| {
            let percent = 100.0 * hypothesis.probability;
            format!("    {}  {percent:5.1} %  {}", index + 1, hypothesis.name())
        });
        lines.collect::<Vec<_>>().join("\n")
    }

    /// Hypotheses that the recordings cannot distinguish from this one.
    fn rivals(&self, hypothesis: &Hypothesis) -> Vec<&str> {
        let name = hypothesis.effects.join("+");
        let groups = self.tied.iter().filter(|group| group.contains(&name));
        let others = groups.flatten().filter(|other| **other != name);
        others.map(String::as_str).collect()
    }
}

impl Hypothesis {
    /// Its effects in one line.
    pub(crate) fn name(&self) -> String {
        if self.effects.is_empty() {
            return "nominal model, its parameters fitted".to_owned();
        }
        self.effects.join(" + ")
    }

    /// The alternative model that it stands for, if any.
    fn alternative(&self) -> Option<&str> {
        self.effects.first()?.strip_prefix("alternative:")
    }

    /// Its changes of the spec.
    pub(crate) fn changes(&self) -> Changes {
        let Some(written) = &self.changes else {
            return Changes::default();
        };
        let inputs = written.inputs.iter();
        let parameters = written.parameters.iter().map(|p| Refitted {
            name: p.name.clone(),
            stated: p.stated,
            value: p.value,
            std: p.std,
            unit: p.unit.clone(),
        });
        let signal_effects = written.beside.iter().map(|b| SignalEffect {
            effect: b.effect.clone(),
            acts: b.acts.clone(),
            on: b.on.clone(),
        });
        Changes {
            items: written.items.clone(),
            inputs: inputs
                .map(|one| (one.input.clone(), one.adds.clone()))
                .collect(),
            parameters: parameters.collect(),
            signal_effects: signal_effects.collect(),
        }
    }

    /// What was written to the spec, and what belongs elsewhere.
    pub(crate) fn summary(&self, report: &Report, changes: &Changes, file: &str) -> String {
        let mut text = format!(
            "{file}: {} with {} ({:.1} %)\n",
            report.mechanism,
            self.name(),
            100.0 * self.probability
        );
        let is_of_signal = |value: &&Found| {
            let mut effects = changes.signal_effects.iter();
            effects.any(|own| value.name.starts_with(&format!("{}.", own.effect)))
        };
        // Writing to a string cannot fail.
        for value in self.parameters.iter().filter(|value| !is_of_signal(value)) {
            let _ = writeln!(text, "  found     {} = {}", value.name, value.sentence());
        }
        for one in &changes.parameters {
            let _ = writeln!(text, "  changed   {}", refitted(one));
        }
        for one in &changes.signal_effects {
            let own = |value: &&Found| value.name.starts_with(&format!("{}.", one.effect));
            let value = self.parameters.iter().find(own).map(Found::sentence);
            let _ = writeln!(
                text,
                "  elsewhere {}",
                elsewhere(one, &value.unwrap_or_default())
            );
        }
        for rival in report.rivals(self) {
            let _ = writeln!(
                text,
                "  tied with {rival}: these recordings cannot distinguish them"
            );
        }
        if !changes.parameters.is_empty() {
            text += "  note      `[parameters]` of a recording.toml override those of a spec: enter \
            the new values there too\n";
            text += &for_recordings(&changes.parameters);
        }
        text
    }
}

impl Found {
    fn sentence(&self) -> String {
        let value = self.value.map_or_else(|| "unknown".to_owned(), number);
        let std = self.std.map(|std| format!(" ± {}", number(std)));
        with_unit(&(value + &std.unwrap_or_default()), &self.unit)
    }
}

/// `m = 1.02 ± 0.01 kg, stated as 1 kg`
fn refitted(one: &Refitted) -> String {
    let std = one.std.map(|std| format!(" ± {}", number(std)));
    let value = number(one.value) + std.as_deref().unwrap_or_default();
    let value = with_unit(&value, &one.unit);
    let rest = match std {
        Some(_) => {
            let stated = with_unit(&number(one.stated), &one.unit);
            format!("fitted; stated as {stated}")
        }
        None => "as stated by the recordings".to_owned(),
    };
    format!("{} = {value}, {rest}", one.name)
}

/// The fitted parameters as `[parameters]` of a `recording.toml`; those held fixed are there already.
fn for_recordings(parameters: &[Refitted]) -> String {
    let fitted = parameters.iter();
    let lines = fitted.filter_map(|one| {
        let std = one.std?;
        let value = digits(one.value, one.value / std);
        let (name, unit, std) = (&one.name, &one.unit, digits(std, 1.0));
        Some(format!(
            "{name} = {{ value = {value}, unit = \"{unit}\", std = {std} }}\n"
        ))
    });
    let lines: String = lines.collect();
    if lines.is_empty() {
        return lines;
    }
    format!("\n[parameters]\n{lines}")
}

/// A number rounded to a hundredth of its standard deviation.
fn digits(value: f64, deviations: f64) -> f64 {
    let digits = deviations.abs().log10().ceil();
    if !digits.is_finite() {
        return value;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "twelve at most"
    )]
    let digits = digits.clamp(0.0, 12.0) as usize + 2;
    format!("{value:.digits$e}").parse().unwrap_or(value)
}

/// Where an effect belongs that a spec cannot express.
fn elsewhere(own: &SignalEffect, value: &str) -> String {
    let (effect, on) = (&own.effect, &own.on);
    let rest = match own.acts.as_str() {
        "lag" => format!(
            "{on} follows its command through a first-order lag with the time constant {value}; a spec \
            cannot express this: put the filter between controller and model"
        ),
        "delay" => format!(
            "{on} follows its command with a delay of {value}; a spec cannot express this: write `delay_ms` in \
             the feedback law of `appell simulate --feedback`, or delay the commands of a table"
        ),
        "bias" => format!("the sensor {on} has a bias of {value}: subtract it where {on} is read"),
        "scale" => {
            format!("the sensor {on} reads {value} times the true value: divide where {on} is read")
        }
        _ => format!("the sensor {on} has a delay of {value}: shift its times where it is read"),
    };
    format!("{effect}: {rest}")
}
