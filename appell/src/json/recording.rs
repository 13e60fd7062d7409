//! Recordings.

use appell_recordings::DataSet;
use appell_report::recording::{part, role, severity};
use serde_json::{Value, json};

/// Runs, channels, noise, parameters and findings of a data set.
pub fn recording(set: &DataSet) -> Value {
    let runs = set.runs.iter().map(|run| {
        let differences = run.differences.iter();
        let differences = differences.map(|own| json!({ "name": own.parameter, "by": own.by }));
        json!({
            "run": run.name, "part": part(run), "rows": run.times.len(),
            "from_s": run.times.first(), "to_s": run.times.last(),
            "step_s": run.sampling.step, "shortest_step_s": run.sampling.shortest,
            "longest_step_s": run.sampling.longest, "gaps_s": run.sampling.gaps,
            "differences": differences.collect::<Vec<_>>(),
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
        "schema": "recording/1",
        "mechanism": set.mechanism.name,
        "description": set.description,
        "runs": runs.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "findings": findings.collect::<Vec<_>>(),
    })
}
