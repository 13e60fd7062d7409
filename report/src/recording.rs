//! Summaries of recordings.

use std::fmt::Write as _;

use appell_recordings::{DataSet, Difference, Finding, Part, Role, Run};
use appell_spec::Severity;

use crate::text::{Table, number, short};

/// The summary as text tables, in the units of the files.
pub fn text(set: &DataSet) -> String {
    let mut text = format!("{}: {}\n", set.mechanism.name, set.mechanism.title);
    if !set.description.is_empty() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", set.description);
    }
    text.push('\n');
    text += &runs(set);
    text.push('\n');
    text += &channels(set);
    if !set.findings.is_empty() {
        text.push('\n');
    }
    for line in sentences(&set.findings) {
        let _ = writeln!(text, "{line}");
    }
    text
}

fn runs(set: &DataSet) -> String {
    let columns = "run | for | rows | seconds | step in ms | gaps";
    let mut table = Table::new("", columns, 2..6);
    for run in &set.runs {
        table.rows.push(vec![
            run.name.clone(),
            part(run).to_owned(),
            run.times.len().to_string(),
            number(run.duration()),
            number(1e3 * run.sampling.step),
            run.sampling.gaps.len().to_string(),
        ]);
    }
    let mut text = table.text();
    for run in &set.runs {
        for difference in differences(set, run) {
            let _ = writeln!(text, "in {}: {difference}", run.name);
        }
    }
    text
}

/// What differs in a run, a sentence for each parameter: `cart.mass differs by +0.2 kg from the other runs`.
pub fn differences(set: &DataSet, run: &Run) -> Vec<String> {
    let sentence = |difference: &Difference| {
        let mut all = set.mechanism.parameters.iter();
        let own = all.find(|own| own.label.name == difference.parameter)?;
        let (unit, name) = (&own.label.unit, set.named(&difference.parameter));
        let by = unit.from_si(difference.by);
        let (sign, by) = (if by < 0.0 { "" } else { "+" }, short(by));
        Some(format!(
            "{name} differs by {sign}{by} {} from the other runs",
            unit.text
        ))
    };
    run.differences.iter().filter_map(sentence).collect()
}

/// Role of a run.
pub fn part(run: &Run) -> &'static str {
    match run.part {
        Part::Fit => "fit",
        Part::Test => "test",
    }
}

fn channels(set: &DataSet) -> String {
    let columns = "channel | holds | unit | noise | stated | step | from";
    let mut table = Table::new("", columns, 3..6);
    for channel in &set.channels {
        let shown = |value: Option<f64>| {
            let value = value.map(|value| channel.unit.from_si(value));
            value.map_or_else(String::new, |value| format!("{value:.2e}"))
        };
        let label = channel.role.label(&set.mechanism);
        let name = label.map_or("", |label| label.name.as_str());
        let what = format!("{} {name}", role(channel.role));
        let noise = channel.noise;
        table.rows.push(vec![
            channel.column.clone(),
            what.trim_end().to_owned(),
            channel.unit.text.clone(),
            shown(noise.map(|noise| noise.std)),
            shown(channel.stated_noise),
            shown(noise.and_then(|noise| noise.quantum)),
            noise.map_or("", |noise| noise.source.word()).to_owned(),
        ]);
    }
    table.text()
}

/// Quantity of a channel.
pub fn role(role: Role) -> &'static str {
    match role {
        Role::Measures(_) => "measured",
        Role::Input(_) => "input",
        Role::Recorded => "not in the model",
    }
}

/// `warning: run.csv:12: theta: 3 values of 200 missing`, about some channels.
fn sentence(finding: &Finding, channels: &[&str]) -> String {
    let mut text = format!("{}: ", severity(finding));
    if let Some(run) = &finding.run {
        let line = finding.line.map(|line| format!(":{line}"));
        let _ = write!(text, "{run}{}: ", line.unwrap_or_default());
    }
    match channels {
        [] => {}
        [first, second, rest @ ..] if rest.len() > 1 => {
            let _ = write!(text, "{first}, {second} and {} more: ", rest.len());
        }
        few => {
            let _ = write!(text, "{}: ", few.join(", "));
        }
    }
    text + &finding.message
}

/// Findings as lines; the same one about several channels of a run is one line.
pub fn sentences<'f>(findings: impl IntoIterator<Item = &'f Finding>) -> Vec<String> {
    let findings: Vec<&Finding> = findings.into_iter().collect();
    let about = |finding: &&Finding| Finding {
        channel: None,
        ..(*finding).clone()
    };
    let same = findings.chunk_by(|one, next| one.channel.is_some() && about(one) == about(next));
    let line = |same: &[&Finding]| {
        let channels: Vec<&str> = same
            .iter()
            .filter_map(|own| own.channel.as_deref())
            .collect();
        sentence(same[0], &channels)
    };
    same.map(line).collect()
}

/// The word for the severity of a finding.
pub fn severity(finding: &Finding) -> &'static str {
    match finding.kind.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}
