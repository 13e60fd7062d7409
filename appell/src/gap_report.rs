//! The file of a gap report: written after a diagnosis, and read again to change the spec.

use std::path::Path;

use appell_gap::diagnose::{Advice, Ahead, Change, Changes, ENGINE, Law, Report};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{Error, Field, files};

/// The share of the re-fitted parameters in the budget.
const REFIT: &str = "refit";
/// Name and version of the format.
const SCHEMA: &str = "gap-report/1";

/// A gap report as JSON; `next` is the file of the proposed experiment, `findings` are those about the data.
pub fn json(report: &Report, next: Option<&Path>, findings: &[String]) -> Value {
    let joined = |group: &[Vec<String>]| -> Vec<String> {
        group.iter().map(|effects| effects.join("+")).collect()
    };
    let tied = report.tied.iter().map(|group| joined(group));
    let far = report.how_far.as_ref().map(|far| {
        let mut far = json!(far);
        far["horizons"] = report.horizons.iter().map(ahead).collect();
        far
    });
    let failed = report
        .failed
        .iter()
        .map(|(effects, reason)| json!({ "effects": effects, "reason": reason }));
    let disturbances = report.disturbances.iter().map(
        |(name, before, after)| json!({ "name": name, "nominal": before, "with_effect": after }),
    );
    let experiment = report.experiment.as_ref().map(|one| {
        json!({
            "separates": joined(&one.separates),
            "file": next.and_then(Path::file_name).map(|name| name.to_string_lossy()),
            "separation_now": one.separation_now, "separation_then": one.separation_then,
            "about": one.about,
        })
    });
    let mut json = json!({
        "schema": SCHEMA,
        "engine": ENGINE,
        "mechanism": report.mechanism,
        "verdict": report.verdict.word(),
        "hints": report.hints,
        "tolerances": report.tolerances,
        "interpolated": report.interpolated,
        "by_simulation": report.is_by_simulation,
        "by_forces": report.is_by_forces,
        "rows": { "fitted": report.rows[0], "all": report.rows[1] },
        "where": report.place,
        "which": report.which,
        "tied": tied.collect::<Vec<_>>(),
        "advice": Advice::of(report),
        "how_far": far,
        "experiment": experiment,
        "detectable": report.detectable,
        "left": report.left,
        "law": report.law.as_ref().map(law),
        "change": report.change.as_ref().map(change),
        "independent": report.independent,
        "failed": failed.collect::<Vec<_>>(),
        "disturbances": disturbances.collect::<Vec<_>>(),
        "data": findings,
    });
    if let Some(format) = report.robot {
        json["robot"] = format.into();
    }
    if !report.locked.is_empty() {
        json["locked"] = report.locked.clone().into();
    }
    json
}

/// A measured law: its curve with standard deviations, and the closest analytic forms.
fn law(law: &Law) -> Value {
    let column = |of: fn(&[f64; 3]) -> f64| law.curve.iter().map(of).collect::<Vec<_>>();
    json!({
        "equation": law.equation, "unit": law.unit, "depends_on": law.depends_on,
        "variable": law.variable, "variable_unit": law.variable_unit, "factor": law.factor,
        "at": column(|[x, ..]| *x), "value": column(|[_, force, _]| *force),
        "std": column(|[.., std]| *std),
        "log_bayes_factor": law.log_bayes_factor,
        "forms": law.forms,
    })
}

/// The difference from the previous recordings, in SI.
fn change(change: &Change) -> Value {
    let (verdict, effects) = &change.before;
    json!({
        "changed": change.is_changed,
        "before": { "verdict": verdict.word(), "effects": effects },
        "parameters": change.parameters,
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

/// The parts of a written report that change a spec, or stand in the table of several rigs.
#[derive(Debug, Deserialize)]
pub struct GapReport {
    schema: String,
    /// Its verdict.
    #[serde(default)]
    pub verdict: String,
    /// Name of the mechanism.
    pub mechanism: String,
    /// The format of the robot file that was diagnosed, `URDF` or `MJCF`.
    #[serde(default)]
    pub(crate) robot: Option<String>,
    /// Joints of that robot that were rigid.
    #[serde(default)]
    pub(crate) locked: Vec<String>,
    which: Vec<Hypothesis>,
    #[serde(default)]
    tied: Vec<Vec<String>>,
    /// Prediction errors on held-out runs; nothing without such runs.
    #[serde(default)]
    pub how_far: Option<HowFar>,
}

/// How far the gap closes on the held-out runs.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct HowFar {
    /// Horizon in s.
    pub horizon_s: Option<f64>,
    /// Prediction error of the stated model, in units of the noise.
    pub nominal: Option<f64>,
    /// The same with the diagnosed effect.
    pub with_effect: Option<f64>,
    /// Part of the gap that closes.
    pub closed: Option<f64>,
    budget: Vec<Share>,
}

/// A part of the gap: an effect, `refit`, `law` or `unexplained`.
#[derive(Debug, Deserialize)]
struct Share {
    effect: String,
    /// How much of the gap it is.
    closed: Option<f64>,
    interval: [Option<f64>; 2],
    #[serde(rename = "material")]
    is_material: bool,
}

/// A hypothesis of a report.
#[derive(Debug, Clone, Deserialize)]
pub struct Hypothesis {
    /// Its effects.
    pub effects: Vec<String>,
    /// Its probability.
    pub probability: f64,
    #[serde(default)]
    pub(crate) parameters: Vec<Found>,
    changes: Option<Changes>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Found {
    pub(crate) name: String,
    pub(crate) value: Option<f64>,
    pub(crate) std: Option<f64>,
    pub(crate) unit: String,
    /// Value without the effect.
    pub(crate) without: Option<f64>,
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
        let place = wanted.unwrap_or(1);
        let found = self.numbered(place)?;
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

    /// The same for a robot file; `None` if there is no gap, and numbers within their tolerances hardly improve the
    /// predictions of the held-out runs. If no effect of the library explains the gap,
    /// the numbers that were fitted without effects belong to it.
    pub(crate) fn for_robot(&self, wanted: Option<usize>) -> Result<Option<Hypothesis>, Error> {
        let found = self.numbered(wanted.unwrap_or(1))?;
        let is_right = found.effects.is_empty() && self.verdict == "no_gap" && !self.needs_refit();
        if wanted.is_none() && is_right {
            return Ok(None);
        }
        if found.changes.is_some() || found.alternative().is_some() {
            let found = self.hypothesis(wanted)?;
            return Ok(Some(found.clone().with_gains()));
        }
        let nominal = self.which.iter().find(|other| other.effects.is_empty());
        let found = Hypothesis {
            changes: nominal.and_then(|nominal| nominal.changes.clone()),
            ..found.clone()
        };
        Ok(Some(found.with_gains()))
    }

    /// Whether the fitted numbers close a material share of the errors on the held-out runs.
    fn needs_refit(&self) -> bool {
        let mut shares = self.how_far.iter().flat_map(|far| &far.budget);
        shares.any(|share| {
            share.effect == REFIT && share.is_material && share.interval[0] > Some(0.0)
        })
    }

    /// The most probable hypothesis in words, and its probability.
    pub fn first(&self) -> (String, f64) {
        let Some(first) = self.which.first() else {
            return (String::new(), f64::NAN);
        };
        let name = match &first.effects[..] {
            [] => "nominal model".to_owned(),
            effects => effects.join(" + "),
        };
        (name, first.probability)
    }

    /// The parts of the gap in words, the largest first.
    pub fn budget(&self) -> String {
        let mut parts: Vec<(&str, f64)> = (self.how_far.iter())
            .flat_map(|far| &far.budget)
            .filter_map(|part| Some((part.effect.as_str(), part.closed?)))
            .collect();
        parts.sort_by(|a, b| b.1.total_cmp(&a.1));
        let parts = parts.into_iter();
        let parts = parts.map(|(name, closed)| format!("{name} {:.1} %", 100.0 * closed));
        parts.collect::<Vec<_>>().join("; ")
    }

    fn numbered(&self, place: usize) -> Result<&Hypothesis, Error> {
        let found = place.checked_sub(1).and_then(|index| self.which.get(index));
        found.ok_or_else(|| {
            let count = self.which.len();
            let message =
                format!("there is no hypothesis {place}: the report has {count}, numbered from 1");
            Error::request(Field::Hypothesis, message)
        })
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
    /// The same, in which gains and scales that were fitted within their tolerances are effects.
    fn with_gains(mut self) -> Self {
        let gains = self.changes.iter().flat_map(|changes| &changes.gains);
        for gain in gains {
            let effect = gain.name.rsplit_once('.').map_or("", |(effect, _)| effect);
            self.effects.push(effect.to_owned());
            self.parameters.push(Found {
                name: gain.name.clone(),
                value: Some(gain.value),
                std: gain.std,
                unit: gain.unit.clone(),
                without: Some(gain.stated),
            });
        }
        self
    }

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
        self.changes.clone().unwrap_or_default()
    }
}
