//! What an identification found, for people and for programs.

use std::fmt::Write as _;

use appell_gap::data::DataSet;
use appell_gap::identify::{AHEAD, Answer, Estimate, HeldOut, IdentifyError, Known};
use appell_runtime::estimate::EstimateError;
use appell_runtime::figure::{Figure, Panel, Series};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::recording;
use crate::table::{number, table};

/// Parts of a combination that are smaller are not told.
const NEGLIGIBLE: f64 = 0.1;
/// Combinations that are known to more tolerances than this are not known.
const UNKNOWN: f64 = 100.0;
/// Runs that are drawn.
const DRAWN_RUNS: usize = 2;

pub(crate) fn failure(error: &IdentifyError) -> Failure {
    match error {
        IdentifyError::UnknownParameter { .. } | IdentifyError::UnknownAddition { .. } => {
            Failure::Usage(error.to_string())
        }
        IdentifyError::Estimate(EstimateError::Diverged { .. } | EstimateError::Stuck { .. }) => {
            Failure::Computation(format!(
                "{error}; where the values of the rig are far off, `--start shooting` may help"
            ))
        }
        IdentifyError::Estimate(_) => Failure::Computation(error.to_string()),
        _ => Failure::Data(error.to_string()),
    }
}

/// The tables that a person reads.
pub(crate) fn text(set: &DataSet, answer: &Answer) -> String {
    let mut text = recording::text(set);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n{}", parameters(answer));
    let _ = writeln!(text, "{}", combinations(answer));
    let _ = writeln!(text, "{}", levels(answer));
    let _ = writeln!(text, "{}", residuals(answer));
    if answer.held_out.is_empty() {
        text.push_str("No run was held out: nothing tells how the model predicts.\n");
    } else {
        text += "Errors on the runs that were held out, in units of the noise\n\n";
        text += &held_out(answer);
    }
    text
}

fn in_unit(estimate: &Estimate, value: f64) -> String {
    number(value / estimate.quantity.scale)
}

fn parameters(answer: &Answer) -> String {
    let heading = [
        "parameter",
        "nominal",
        "tolerance",
        "found",
        "from",
        "to",
        "unit",
        "",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for estimate in &answer.parameters {
        let ends = estimate.interval95().map(|end| in_unit(estimate, end));
        let [low, high] = if estimate.at_limit {
            Default::default()
        } else {
            ends
        };
        let tolerance = estimate.tolerance.map(|std| in_unit(estimate, std));
        rows.push(vec![
            estimate.quantity.name.to_string(),
            in_unit(estimate, estimate.nominal),
            tolerance.unwrap_or_default(),
            in_unit(estimate, estimate.value),
            low,
            high,
            estimate.quantity.unit.to_string(),
            remark(estimate).to_owned(),
        ]);
    }
    format!("95 % intervals\n\n{}", table(&rows, 1..6))
}

fn remark(estimate: &Estimate) -> &'static str {
    match (estimate.at_limit, estimate.left) {
        (true, _) => "at the limit of its range",
        (_, Some(left)) if left > 0.5 => "hardly told by the recordings",
        _ => "",
    }
}

/// Which combinations are known better than their tolerances.
fn combinations(answer: &Answer) -> String {
    let known = answer
        .combinations
        .iter()
        .filter(|known| known.deviation < 1.0);
    let mut text = format!(
        "{} of {} combinations of parameters are known better than beforehand\n\n",
        known.clone().count(),
        answer.combinations.len()
    );
    let mut rows = vec![vec![
        "known to".to_owned(),
        "in parts of the tolerances".to_owned(),
    ]];
    for combination in &answer.combinations {
        let known_to = if combination.deviation < UNKNOWN {
            number(combination.deviation)
        } else {
            "not at all".to_owned()
        };
        rows.push(vec![known_to, sum(answer, combination)]);
    }
    text += &table(&rows, 0..1);
    text
}

/// `0.8 m + 0.6 l`
fn sum(answer: &Answer, combination: &Known) -> String {
    let mut text = String::new();
    let parts = combination.parts.iter().zip(&answer.parameters);
    for (part, estimate) in parts.filter(|(part, _)| part.abs() >= NEGLIGIBLE) {
        let sign = match (part.is_sign_negative(), text.is_empty()) {
            (true, true) => "-",
            (false, true) => "",
            (true, false) => " - ",
            (false, false) => " + ",
        };
        let _ = write!(text, "{sign}{:.2} {}", part.abs(), estimate.quantity.name);
    }
    text
}

fn levels(answer: &Answer) -> String {
    let heading = ["level", "of", "nominal model", "fitted model"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (what, levels) in [
        ("noise", &answer.noise),
        ("disturbance", &answer.disturbances),
    ] {
        for level in levels {
            rows.push(vec![
                what.to_owned(),
                level.name.clone(),
                format!("{:.3e}", level.nominal),
                format!("{:.3e}", level.fitted),
            ]);
        }
    }
    table(&rows, 2..4)
}

/// Whether what the filter did not expect is noise.
fn residuals(answer: &Answer) -> String {
    let heading = [
        "channel",
        "neighbours correlate by",
        "noise stays below",
        "",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (column, consistency) in &answer.whiteness {
        let remark = if consistency.is_white() {
            ""
        } else {
            "the model or the sensor lacks something"
        };
        rows.push(vec![
            column.clone(),
            number(consistency.correlation),
            number(consistency.correlation_band[1]),
            remark.to_owned(),
        ]);
    }
    let text = "What the fitted model did not expect one step ahead, on the runs that were fitted";
    format!("{text}\n\n{}", table(&rows, 1..3))
}

fn held_out(answer: &Answer) -> String {
    let heading = ["ahead", "channel", "nominal model", "fitted model"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for error in &answer.held_out {
        rows.push(vec![
            ahead(error),
            error.column.clone().unwrap_or_else(|| "all".to_owned()),
            number(error.nominal),
            number(error.fitted),
        ]);
    }
    table(&rows, 2..4)
}

fn ahead(error: &HeldOut) -> String {
    match error.horizon {
        horizon if horizon <= 0.0 => "one step".to_owned(),
        horizon if horizon.is_finite() => format!("{horizon} s"),
        _ => "free run".to_owned(),
    }
}

/// The first runs that were held out: a panel for each channel and one for its errors.
pub(crate) fn figure(set: &DataSet, answer: &Answer) -> Figure {
    let mut runs: Vec<&str> = answer
        .traces
        .iter()
        .map(|trace| trace.run.as_str())
        .collect();
    runs.dedup();
    runs.truncate(DRAWN_RUNS);
    let traces = answer.traces.iter();
    let shown = traces.filter(|trace| runs.contains(&trace.run.as_str()));
    let panels = shown.flat_map(|trace| {
        let channel = set.channels.iter().find(|c| c.column == trace.column);
        let in_unit = |values: &[f64]| -> Vec<f64> {
            let values = values.iter();
            values
                .map(|&value| channel.map_or(value, |channel| channel.unit.from_si(value)))
                .collect()
        };
        let series = |label: String, y: &[f64]| Series {
            label,
            x: trace.times.clone(),
            y: in_unit(y),
        };
        let unit = channel.map_or_else(String::new, |channel| channel.unit.text.clone());
        let error = |predicted: &[f64]| -> Vec<f64> {
            let pairs = trace.measured.iter().zip(predicted);
            pairs
                .map(|(measured, predicted)| measured - predicted)
                .collect()
        };
        let name = format!("{}, {}", trace.column, trace.run);
        let motion = vec![
            series(name.clone(), &trace.measured),
            series(format!("nominal, {AHEAD} s ahead"), &trace.nominal),
            series(format!("fitted, {AHEAD} s ahead"), &trace.fitted),
        ];
        let errors = vec![
            series(format!("{name}: error of nominal"), &error(&trace.nominal)),
            series("error of fitted".to_owned(), &error(&trace.fitted)),
        ];
        [motion, errors].map(|series| Panel {
            unit: unit.clone(),
            series,
        })
    });
    Figure {
        title: format!("{}: runs that were held out", set.mechanism.name),
        x_label: "t [s]".to_owned(),
        panels: panels.collect(),
        marks: Vec::new(),
        equal_axes: false,
    }
}

/// Everything for programs, in SI.
pub(crate) fn json(set: &DataSet, answer: &Answer) -> Value {
    let parameters = answer.parameters.iter().map(|estimate| {
        json!({
            "name": estimate.quantity.name, "unit": estimate.quantity.unit,
            "nominal": estimate.nominal, "tolerance": estimate.tolerance,
            "value": estimate.value, "std": estimate.std, "robust_std": estimate.robust_std,
            "interval95": estimate.interval95(), "at_limit": estimate.at_limit,
        })
    });
    let rows = answer.correlation.row_iter();
    let correlation = rows.map(|row| row.iter().copied().collect::<Vec<f64>>());
    let combinations = answer
        .combinations
        .iter()
        .map(|known| json!({ "parts": known.parts, "deviation_in_tolerances": known.deviation }));
    let levels = |levels: &[appell_gap::identify::Level]| {
        let levels = levels.iter().map(
            |level| json!({ "name": level.name, "nominal": level.nominal, "fitted": level.fitted }),
        );
        levels.collect::<Vec<_>>()
    };
    let whiteness = answer.whiteness.iter().map(|(column, consistency)| {
        json!({
            "channel": column, "count": consistency.count,
            "normalised_square": consistency.squares / consistency.count as f64,
            "band99": consistency.band.map(|end| end / consistency.count as f64),
            "correlation": consistency.correlation,
            "correlation_band99": consistency.correlation_band,
        })
    });
    let held_out = answer.held_out.iter().map(|error| {
        let horizon = error.horizon.is_finite().then_some(error.horizon);
        json!({
            "horizon_s": horizon, "free_run": horizon.is_none(), "channel": error.column,
            "nominal": error.nominal, "fitted": error.fitted,
        })
    });
    json!({
        "schema": "identified/1",
        "mechanism": set.mechanism.name,
        "parameters": parameters.collect::<Vec<_>>(),
        "correlation": correlation.collect::<Vec<_>>(),
        "combinations": combinations.collect::<Vec<_>>(),
        "noise": levels(&answer.noise),
        "disturbances": levels(&answer.disturbances),
        "innovations": whiteness.collect::<Vec<_>>(),
        "log_likelihood": { "nominal": answer.log_likelihoods[0], "fitted": answer.log_likelihoods[1] },
        "held_out": held_out.collect::<Vec<_>>(),
    })
}

/// A page that needs no network.
pub(crate) fn page(set: &DataSet, answer: &Answer) -> String {
    let escaped = text(set, answer)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: parameters</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>{name}: parameters from recordings</h1>\n{figure}\n<pre>{escaped}</pre>\n\
         </body>\n</html>\n",
        name = set.mechanism.name,
        figure = figure(set, answer).to_svg(),
    )
}

/// Light and dark, as the figure inside.
const STYLE: &str = "\
:root { color-scheme: light dark; }
body { font-family: system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem;
  background: light-dark(#fdfdfb, #16181c); color: light-dark(#1c1c1a, #e6e6e6); }
pre { overflow-x: auto; font-size: 0.85rem; line-height: 1.35; }
svg { max-width: 100%; height: auto; }
";
