//! The file of a gap report: written after a diagnosis, and read again to change the spec.

use std::path::Path;

use appell_gap::diagnose::{
    Ahead, Change, Changes, ENGINE, Interpolated, Law, Refitted, Report, SignalEffect, Tolerances,
    Window,
};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{Error, Field, files};

/// Name and version of the format.
const SCHEMA: &str = "gap-report/1";

/// A gap report as JSON; `next` is the file of the proposed experiment, `findings` are those about the data.
pub fn json(report: &Report, next: Option<&Path>, findings: &[String]) -> Value {
    let equations = report.place.equations.iter().map(|e| {
        json!({ "name": e.name, "share": e.share, "p_value": e.p_value, "rms": e.rms, "unit": e.unit })
    });
    let windows = report.place.windows.iter().map(window);
    let region = report
        .place
        .region
        .iter()
        .map(|r| json!({ "variable": r.variable, "description": r.description, "z": r.z }));
    let which = report.which.iter().map(|h| {
        let parameters = h.parameters.iter().map(value);
        json!({
            "effects": h.effects, "probability": h.probability, "same_as": h.same_as,
            "log_bayes_factor": h.log_bayes_factor, "parameters": parameters.collect::<Vec<_>>(),
            "changes": h.changes.as_ref().map(changes),
        })
    });
    let tied = report.tied.iter().map(|group| {
        let names = group.iter().map(|effects| effects.join("+"));
        names.collect::<Vec<_>>()
    });
    let far = report.how_far.as_ref().map(|far| {
        json!({
            "horizon_s": far.horizon_s, "nominal": far.nominal, "refitted": far.refitted,
            "with_effect": far.with_effect, "noise_floor": far.noise_floor, "closed": far.closed,
            "closed_ci95": far.closed_ci95, "closed_vs_refitted": far.closed_vs_refitted,
            "before": far.before, "bettered_ci95": far.bettered_ci95,
            "budget": far.budget.iter().map(|part| json!({
                "effect": part.name, "closed": part.closed, "interval": part.interval,
                "material": part.is_material,
            })).collect::<Vec<_>>(),
            "runs": far.runs, "horizons": report.horizons.iter().map(ahead).collect::<Vec<_>>(),
        })
    });
    let detectable = report
        .detectable
        .iter()
        .map(|d| json!({ "effect": d.effect, "smallest": d.smallest, "unit": d.unit }));
    let failed = report
        .failed
        .iter()
        .map(|(effects, reason)| json!({ "effects": effects, "reason": reason }));
    let disturbances = report.disturbances.iter().map(
        |(name, before, after)| json!({ "name": name, "nominal": before, "with_effect": after }),
    );
    let experiment = report.experiment.as_ref().map(|one| {
        json!({
            "separates": one.separates.iter().map(|effects| effects.join("+")).collect::<Vec<_>>(),
            "file": next.and_then(Path::file_name).map(|name| name.to_string_lossy()),
            "separation_now": one.separation_now, "separation_then": one.separation_then,
            "about": one.about,
        })
    });
    json!({
        "schema": SCHEMA,
        "engine": ENGINE,
        "mechanism": report.mechanism,
        "verdict": report.verdict.word(),
        "hints": report.hints.iter().map(|hint| json!({
            "variable": hint.variable,
            "equation": hint.equation,
            "gain": hint.gain,
            "log_bayes_factor": hint.log_bayes_factor,
        })).collect::<Vec<_>>(),
        "tolerances": report.tolerances.map(tolerances),
        "interpolated": report.interpolated.iter().map(interpolated).collect::<Vec<_>>(),
        "by_simulation": report.is_by_simulation,
        "by_forces": report.is_by_forces,
        "rows": { "fitted": report.rows[0], "all": report.rows[1] },
        "where": {
            "domain": report.place.domain,
            "equations": equations.collect::<Vec<_>>(),
            "windows": windows.collect::<Vec<_>>(),
            "region": region.collect::<Vec<_>>(),
        },
        "which": which.collect::<Vec<_>>(),
        "tied": tied.collect::<Vec<_>>(),
        "how_far": far,
        "experiment": experiment,
        "detectable": detectable.collect::<Vec<_>>(),
        "left": report.left.as_ref().map(|left| json!({
            "place": left.place,
            "variable": left.variable,
            "about": left.about,
            "log_bayes_factor": left.log_bayes_factor,
            "gain": left.gain,
            "explained": left.explained,
        })),
        "law": report.law.as_ref().map(law),
        "change": report.change.as_ref().map(change),
        "imperfections": report.imperfections.iter().map(value).collect::<Vec<_>>(),
        "independent": report.independent,
        "failed": failed.collect::<Vec<_>>(),
        "disturbances": disturbances.collect::<Vec<_>>(),
        "data": findings,
    })
}

/// A value that was found.
fn value(found: &appell_gap::diagnose::Value) -> Value {
    json!({ "name": found.name, "value": found.value, "std": found.std, "unit": found.unit })
}

/// A measured law: its curve with standard deviations, and the closest analytic forms.
fn law(law: &Law) -> Value {
    let column = |of: fn(&[f64; 3]) -> f64| law.curve.iter().map(of).collect::<Vec<_>>();
    let forms = law.forms.iter().map(|form| {
        json!({ "form": form.text, "share": form.share, "log_bayes_factor": form.log_bayes_factor })
    });
    json!({
        "equation": law.equation, "unit": law.unit, "depends_on": law.depends_on,
        "variable": law.variable, "variable_unit": law.variable_unit, "factor": law.factor,
        "at": column(|[x, ..]| *x), "value": column(|[_, force, _]| *force),
        "std": column(|[.., std]| *std),
        "log_bayes_factor": law.log_bayes_factor,
        "forms": forms.collect::<Vec<_>>(),
    })
}

/// The difference from the previous recordings, in SI.
fn change(change: &Change) -> Value {
    let (verdict, effects) = &change.before;
    let parameters = change.parameters.iter().map(
        |one| json!({ "name": one.name, "value": one.value, "std": one.std, "spread": one.spread }),
    );
    json!({
        "changed": change.is_changed,
        "before": { "verdict": verdict.word(), "effects": effects },
        "parameters": parameters.collect::<Vec<_>>(),
    })
}

/// Prediction errors at one horizon.
fn ahead(ahead: &Ahead) -> Value {
    let horizon = ahead.horizon.is_finite().then_some(ahead.horizon);
    json!({
        "horizon_s": horizon, "free_run": horizon.is_none(), "nominal": ahead.nominal,
        "refitted": ahead.refitted, "with_effect": ahead.with_effect,
        "noise_floor": ahead.noise_floor,
    })
}

/// The changes of the spec, as [`Hypothesis::changes`] reads them.
fn changes(changes: &Changes) -> Value {
    let inputs = changes.inputs.iter();
    let parameters = changes.parameters.iter().map(|p| {
        json!({ "name": p.name, "stated": p.stated, "value": p.value, "std": p.std, "unit": p.unit })
    });
    let beside = changes.signal_effects.iter();
    json!({
        "items": changes.items,
        "inputs": inputs.map(|(input, adds)| json!({ "input": input, "adds": adds })).collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "beside": beside.map(|b| json!({
            "effect": b.effect, "acts": b.acts, "on": b.on, "output": b.output,
        })).collect::<Vec<_>>(),
    })
}

/// The parts of a written report that change a spec.
#[derive(Debug, Deserialize)]
pub struct GapReport {
    schema: String,
    /// Name of the mechanism.
    pub mechanism: String,
    which: Vec<Hypothesis>,
    #[serde(default)]
    tied: Vec<Vec<String>>,
    #[serde(default)]
    pub(crate) imperfections: Vec<Found>,
}

/// A hypothesis of a report.
#[derive(Debug, Deserialize)]
pub struct Hypothesis {
    effects: Vec<String>,
    /// Its probability.
    pub probability: f64,
    #[serde(default)]
    pub(crate) parameters: Vec<Found>,
    changes: Option<WrittenChanges>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Found {
    pub(crate) name: String,
    pub(crate) value: Option<f64>,
    pub(crate) std: Option<f64>,
    pub(crate) unit: String,
}

#[derive(Debug, Deserialize)]
struct WrittenChanges {
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
    #[serde(default)]
    output: Option<String>,
}

impl GapReport {
    /// Reads a file that [`json()`] filled.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = files::read(path, files::MAX_DATA)?;
        Self::parse(&path.to_string_lossy(), &text)
    }

    /// Reads a text that [`json()`] made; `file` is its name in messages.
    pub fn parse(file: &str, text: &str) -> Result<Self, Error> {
        let report: Self = serde_json::from_str(text).map_err(|cause| {
            let message =
                format!("this is not a gap report: {cause}\n  write one with `appell diagnose`");
            Error::data(file, message)
        })?;
        if report.schema != SCHEMA {
            let found = &report.schema;
            let message = format!("unsupported schema `{found}`; this version reads `{SCHEMA}`");
            return Err(Error::data(file, message));
        }
        Ok(report)
    }

    /// The hypothesis with this number, from 1; the most probable one without.
    pub fn hypothesis(&self, wanted: Option<usize>) -> Result<&Hypothesis, Error> {
        let count = self.which.len();
        let place = wanted.unwrap_or(1);
        let found = place.checked_sub(1).and_then(|index| self.which.get(index));
        let found = found.ok_or_else(|| {
            let message =
                format!("there is no hypothesis {place}: the report has {count}, numbered from 1");
            Error::request(Field::Hypothesis, message)
        })?;
        if let Some(name) = found.alternative() {
            let message = format!(
                "hypothesis {place} is another model, `{name}`: use its spec\n  choose another \
                 hypothesis:\n{}",
                self.list()
            );
            return Err(Error::request(Field::Hypothesis, message));
        }
        if found.changes.is_none() {
            let message = format!(
                "hypothesis {place} states that no effect of the library explains the gap: there is \
                 nothing to write\n  choose another one:\n{}",
                self.list()
            );
            return Err(Error::request(Field::Hypothesis, message));
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
    pub(crate) fn rivals(&self, hypothesis: &Hypothesis) -> Vec<&str> {
        let name = hypothesis.effects.join("+");
        let groups = self.tied.iter().filter(|group| group.contains(&name));
        let others = groups.flatten().filter(|other| **other != name);
        others.map(String::as_str).collect()
    }
}

impl Hypothesis {
    /// Its effects in one line.
    pub fn name(&self) -> String {
        if self.effects.is_empty() {
            return "nominal model, its parameters fitted".to_owned();
        }
        if self.effects == ["unknown"] && self.changes.is_some() {
            return "a measured force that no effect of the library explains".to_owned();
        }
        self.effects.join(" + ")
    }

    /// The alternative model that it represents, if any.
    fn alternative(&self) -> Option<&str> {
        self.effects.first()?.strip_prefix("alternative:")
    }

    /// Its changes of the spec.
    pub fn changes(&self) -> Changes {
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
            output: b.output.clone(),
        });
        Changes {
            items: written.items.clone(),
            brought: Vec::new(),
            inputs: inputs
                .map(|one| (one.input.clone(), one.adds.clone()))
                .collect(),
            parameters: parameters.collect(),
            signal_effects: signal_effects.collect(),
        }
    }
}

fn window(window: &Window) -> Value {
    let mut fields = json!({
        "run": window.run, "from_s": window.from, "to_s": window.to, "equation": window.equation, "z": window.z,
    });
    if let Some(channel) = &window.unexplained {
        fields["unexplained"] = json!(channel);
    }
    fields
}

fn tolerances(found: Tolerances) -> Value {
    json!({ "factor": found.factor, "log_bayes_factor": found.log_bayes_factor })
}

fn interpolated(found: &Interpolated) -> Value {
    json!({ "input": found.input, "log_likelihood": found.log_likelihood })
}
