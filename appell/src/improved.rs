//! The spec improved by a hypothesis of a gap report.

use std::fmt::Write as _;

use appell_gap::diagnose::{Changes, Refitted, SignalEffect};
use appell_report::text::{number, with_unit};
use appell_spec::foreign::toml_string;
use serde_json::json;

use crate::Error;
use crate::correction::{Correction, tied};
use crate::gap_report::{Found, GapReport, Hypothesis};
use crate::source::Source;

impl Source {
    /// The spec with a hypothesis of a gap report, numbered from 1; by default the most probable one.
    /// Comments and layout are preserved. The result is a valid spec; `file` is its name in error messages.
    pub fn improved(
        &self,
        report: &GapReport,
        hypothesis: Option<usize>,
        file: &str,
    ) -> Result<Correction, Error> {
        let name = self.mechanism()?.name;
        if report.mechanism != name {
            let message = format!(
                "the report is about `{}`, but the spec describes `{name}`",
                report.mechanism
            );
            return Err(Error::data(&self.file, message));
        }
        let hypothesis = report.hypothesis(hypothesis)?;
        let changes = hypothesis.changes();
        let note = format!("Found by `appell diagnose`: {}", hypothesis.name());
        let spec = changes.improved(&self.text, &note);
        let spec = spec.map_err(|error| Error::data(&self.file, error.to_string()))?;
        appell_spec::load(file, &spec)?;
        let rivals = report.rivals(hypothesis);
        Ok(Correction {
            text: spec,
            about: format!(
                "{} with {} ({:.1} %)",
                report.mechanism,
                hypothesis.name(),
                100.0 * hypothesis.probability
            ),
            lines: lines(hypothesis, &changes, &rivals),
            edits: json!({ "edits": changes, "tied_with": rivals }),
        })
    }
}

/// The changes written to a spec, and those that belong elsewhere.
fn lines(hypothesis: &Hypothesis, changes: &Changes, rivals: &[&str]) -> String {
    let mut text = String::new();
    let of =
        |value: &Found, one: &SignalEffect| value.name.starts_with(&format!("{}.", one.effect));
    let effects = &changes.signal_effects;
    let others = hypothesis.parameters.iter();
    let is_elsewhere = |one: &SignalEffect| one.output.is_none();
    let others = others.filter(|value| {
        let mut signals = effects.iter().filter(|one| is_elsewhere(one));
        !signals.any(|one| of(value, one))
    });
    // Writing to a string cannot fail.
    for value in others {
        let _ = writeln!(text, "  found     {} = {}", value.name, value.sentence());
    }
    for one in &changes.parameters {
        let _ = writeln!(text, "  changed   {}", refitted(one));
    }
    let is_of = |one: &Refitted, effect: &SignalEffect| {
        one.name
            .strip_prefix(&effect.effect)
            .is_some_and(|rest| rest.starts_with('.'))
    };
    let gains = changes.gains.iter();
    for one in gains.filter(|one| !effects.iter().any(|effect| is_of(one, effect))) {
        let _ = writeln!(text, "  changed   {}", refitted(one));
    }
    for one in effects {
        let mut values = hypothesis.parameters.iter();
        let value = values.find(|value| of(value, one)).map(Found::sentence);
        let gain = changes.gains.iter().find(|gain| is_of(gain, one));
        let value = value.or_else(|| gain.map(|gain| number(gain.value)));
        let value = value.unwrap_or_default();
        let _ = writeln!(text, "  elsewhere {}", elsewhere(one, &value));
    }
    text += &tied(rivals);
    if !changes.parameters.is_empty() {
        text += "  note      `[parameters]` of a recording.toml override those of a spec: enter \
        the new values there too\n";
        text += &for_recordings(&changes.parameters);
    }
    text
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
        let (name, unit, std) = (&one.name, toml_string(&one.unit), digits(std, 1.0));
        Some(format!(
            "{name} = {{ value = {value}, unit = {unit}, std = {std} }}\n"
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
    if let Some(output) = &own.output {
        return format!(
            "{effect}: the channel {on} shows something else: write `measures = \"{output}\"` for it in \
             recording.toml"
        );
    }
    let rest = match own.acts.as_str() {
        "lag" => format!(
            "{on} follows its command through a first-order lag with the time constant {value}; a spec \
            cannot express this: put the filter between controller and model"
        ),
        "delay" => format!(
            "{on} follows its command with a delay of {value}; a spec cannot express this: write `delay_ms` in \
             the feedback law, or delay the commands of a table"
        ),
        "bias" => format!("the sensor {on} has a bias of {value}: subtract it where {on} is read"),
        "scale" => {
            format!("the sensor {on} reads {value} times the true value: divide where {on} is read")
        }
        "slow" => format!(
            "the sensor {on} lags with the time constant {value}: undo the low-pass filter where it is read"
        ),
        _ => format!("the sensor {on} has a delay of {value}: shift its times where it is read"),
    };
    format!("{effect}: {rest}")
}
