//! Recordings: found, read, and told of.

use std::fmt::Write as _;
use std::path::PathBuf;

use appell_gap::data::{self, DataError, DataSet, Finding, FindingKind, Part, Role, Run, Spec};
use appell_models::ALL;
use appell_spec::Severity;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::source::Source;
use crate::table::{number, table};

/// Reads a data set, or CSV files of a mechanism.
pub(crate) fn read(paths: &[PathBuf], model: Option<&str>) -> Result<DataSet, Failure> {
    let spec = model.map(Source::find).transpose()?.map(|source| Spec {
        file: source.file,
        text: source.text,
    });
    let described = |path: &PathBuf| path.is_dir() || path.ends_with(data::MANIFEST);
    match (paths, spec) {
        ([folder], spec) if described(folder) => {
            let shipped = ALL.iter().map(|shipped| {
                let (file, text) = (shipped.file.to_owned(), shipped.spec.to_owned());
                (shipped.name, Spec { file, text })
            });
            let library: Vec<(&str, Spec)> = shipped.collect();
            Ok(data::read(folder, &library, spec)?)
        }
        (paths, _) if paths.iter().any(described) => Err(Failure::Usage(
            "give one data set, or CSV files and their mechanism".to_owned(),
        )),
        (paths, Some(spec)) => Ok(data::read_bare(spec, paths)?),
        (_, None) => Err(Failure::Usage(
            "CSV files need the mechanism whose names their columns have; name a shipped one or a spec".to_owned(),
        )),
    }
}

/// Refuses times that are hardly in seconds: a filter would integrate for hours.
pub(crate) fn refuse_slow(set: &DataSet) -> Result<(), Failure> {
    let slow = |finding: &&Finding| finding.kind == FindingKind::SlowClock;
    let Some(first) = set.findings.iter().find(slow) else {
        return Ok(());
    };
    let mut runs = set.runs.iter();
    let run = runs.find(|run| first.run.as_ref() == Some(&run.name));
    let seconds = run.map_or(0.0, Run::duration);
    Err(Failure::Data(format!(
        "{}: {}: the run lasts {} s, with {}",
        first.run.as_deref().unwrap_or_default(),
        first.channel.as_deref().unwrap_or_default(),
        number(seconds),
        first.message
    )))
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        match error {
            DataError::Report(report) => Self::Report(report),
            DataError::File { path, cause } => Self::reading(&path)(cause),
            DataError::Several(errors) => {
                Self::Several(errors.into_iter().map(Self::from).collect())
            }
            whole => Self::Data(whole.to_string()),
        }
    }
}

/// The tables that a person reads, in the units of the files.
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

/// What of the recordings changes what can be concluded, a sentence each.
pub(crate) fn warnings(set: &DataSet) -> Vec<String> {
    let findings = set.findings.iter();
    let grave = findings.filter(|finding| finding.kind.severity() == Severity::Warning);
    grave.map(sentence).collect()
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

/// `warning: run.csv:12: theta: 3 values of 200 missing`
pub(crate) fn sentence(finding: &Finding) -> String {
    let mut text = format!("{}: ", severity(finding));
    if let Some(run) = &finding.run {
        let line = finding.line.map(|line| format!(":{line}"));
        let _ = write!(text, "{run}{}: ", line.unwrap_or_default());
    }
    if let Some(channel) = &finding.channel {
        let _ = write!(text, "{channel}: ");
    }
    text + &finding.message
}

fn severity(finding: &Finding) -> &'static str {
    match finding.kind.severity() {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// The same for programs, in SI.
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
