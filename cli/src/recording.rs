//! A summary of recordings as text and JSON.

use std::fmt::Write as _;

use appell::recording::{sentence, severity};
use appell_gap::data::{DataSet, Part, Role, Run};
use appell_report::text::{number, table};
use serde_json::{Value, json};

/// The summary as text tables, in the units of the files.
pub(crate) fn text(set: &DataSet) -> String {
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
    for finding in &set.findings {
        let _ = writeln!(text, "{}", sentence(finding));
    }
    text
}

fn runs(set: &DataSet) -> String {
    let heading = ["run", "for", "rows", "seconds", "step in ms", "gaps"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for run in &set.runs {
        rows.push(vec![
            run.name.clone(),
            part(run).to_owned(),
            run.times.len().to_string(),
            number(run.duration()),
            number(1e3 * run.sampling.step),
            run.sampling.gaps.len().to_string(),
        ]);
    }
    table(&rows, 2..6)
}

fn part(run: &Run) -> &'static str {
    match run.part {
        Part::Fit => "fit",
        Part::Test => "test",
    }
}

fn channels(set: &DataSet) -> String {
    let heading = [
        "channel", "holds", "unit", "noise", "stated", "step", "from",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for channel in &set.channels {
        let shown = |value: Option<f64>| {
            let value = value.map(|value| channel.unit.from_si(value));
            value.map_or_else(String::new, |value| format!("{value:.2e}"))
        };
        let label = channel.role.label(&set.mechanism);
        let name = label.map_or("", |label| label.name.as_str());
        let noise = channel.noise;
        rows.push(vec![
            channel.column.clone(),
            format!("{} {name}", role(channel.role))
                .trim_end()
                .to_owned(),
            channel.unit.text.clone(),
            shown(noise.map(|noise| noise.std)),
            shown(channel.stated_noise),
            shown(noise.and_then(|noise| noise.quantum)),
            noise.map_or("", |noise| noise.source.word()).to_owned(),
        ]);
    }
    table(&rows, 3..6)
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Measures(_) => "measured",
        Role::Input(_) => "input",
        Role::Recorded => "not in the model",
    }
}

/// The summary as JSON, in SI.
pub(crate) fn json(set: &DataSet) -> Value {
    let runs = set.runs.iter().map(|run| {
        json!({
            "run": run.name, "part": part(run), "rows": run.times.len(),
            "from_s": run.times.first(), "to_s": run.times.last(),
            "step_s": run.sampling.step, "shortest_step_s": run.sampling.shortest,
            "longest_step_s": run.sampling.longest, "gaps_s": run.sampling.gaps,
        })
    });
    let channels = set.channels.iter().map(|channel| {
        let label = channel.role.label(&set.mechanism);
        let noise = channel.noise;
        json!({
            "channel": channel.column, "role": role(channel.role),
            "quantity": label.map(|label| &label.name), "unit": channel.unit.text,
            "noise_std": noise.map(|noise| noise.std),
            "noise_from": noise.map(|noise| noise.source.word()),
            "noise_stated": channel.stated_noise,
            "noise_found": noise.and_then(|noise| noise.found),
            "quantum": noise.and_then(|noise| noise.quantum),
        })
    });
    let own = set.mechanism.parameters.iter();
    let parameters = own.zip(&set.parameters).map(|(own, parameter)| {
        json!({
            "name": own.label.name, "value": parameter.value, "std": parameter.std,
        })
    });
    let findings = set.findings.iter().map(|finding| {
        json!({
            "kind": finding.kind.word(), "severity": severity(finding), "run": finding.run,
            "line": finding.line, "channel": finding.channel, "message": finding.message,
        })
    });
    json!({
        "mechanism": set.mechanism.name,
        "description": set.description,
        "runs": runs.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "findings": findings.collect::<Vec<_>>(),
    })
}
