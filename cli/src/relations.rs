//! Input-free relations, identified parameters and recovered inputs as text, figure and JSON.

use std::fmt::Write as _;

use appell_gap::inverse::{Answer, Estimate, Inputs};
use appell_report::figure::{Figure, Panel, Series};
use appell_runtime::model::ModelInfo;
use serde_json::{Value, json};

use appell_report::text::{number, table};

/// Number of runs drawn.
const DRAWN_RUNS: usize = 3;
/// Half-width of a 95 % band in standard deviations.
const BAND: f64 = 1.96;

/// The report as text tables.
pub(crate) fn text(answer: &Answer) -> String {
    let mut text = format!(
        "{} input-free relation{}, spline knots every {:.0} ms\n",
        answer.relations,
        if answer.relations == 1 { "" } else { "s" },
        1e3 * answer.spacing,
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "mean square residual relative to the noise {} (1 if model and noise are right)\n",
        number(answer.normalised_square)
    );
    if !answer.estimates.is_empty() {
        let _ = writeln!(text, "95 % intervals\n\n{}", estimates(&answer.estimates));
    }
    let mut rows = vec![["column", "noise"].map(str::to_owned).to_vec()];
    for (column, std) in &answer.noise {
        rows.push(vec![column.clone(), format!("{std:.3e}")]);
    }
    text + &table(&rows, 1..2)
}

fn estimates(estimates: &[Estimate]) -> String {
    let heading = ["value", "nominal", "found", "from", "to", "unit", ""];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for estimate in estimates {
        let quantity = &estimate.quantity;
        let bias = if estimate.is_bias { "bias of " } else { "" };
        let [low, high] = estimate.interval95.map(|end| number(quantity.to_unit(end)));
        rows.push(vec![
            format!("{bias}{}", quantity.name),
            number(quantity.to_unit(estimate.nominal)),
            number(quantity.to_unit(estimate.value)),
            low,
            high,
            quantity.unit.to_string(),
            remark(estimate).to_owned(),
        ]);
    }
    table(&rows, 1..5)
}

/// What the motions do not determine.
fn remark(estimate: &Estimate) -> &'static str {
    match estimate.interval95 {
        [low, high] if low.is_infinite() && high.is_infinite() => "not determined by these motions",
        [_, high] if high.is_infinite() => "not bounded from above by these motions",
        [low, _] if low.is_infinite() => "not bounded from below by these motions",
        _ => "",
    }
}

/// The inputs of the first runs, each with its band.
pub(crate) fn figure(info: &ModelInfo, answer: &Answer) -> Figure {
    let panels = answer.inputs.iter().take(DRAWN_RUNS).flat_map(|run| {
        let inputs = info.inputs.iter().take(info.declared_inputs).enumerate();
        inputs.map(|(input, quantity)| {
            let shifted = |sign: f64| -> Vec<f64> {
                let values = run.values[input].iter().zip(&run.stds[input]);
                values
                    .map(|(value, std)| quantity.to_unit(value + sign * BAND * std))
                    .collect()
            };
            let series = |label: String, y: Vec<f64>| Series {
                label,
                x: run.times.clone(),
                y,
            };
            Panel {
                unit: quantity.unit.to_string(),
                series: vec![
                    series(format!("{}, {}", quantity.name, run.run), shifted(0.0)),
                    series("95 % from".to_owned(), shifted(-1.0)),
                    series("to".to_owned(), shifted(1.0)),
                ],
            }
        })
    });
    Figure {
        title: format!("{}: inputs of recorded motions", info.name),
        x_label: "t [s]".to_owned(),
        panels: panels.collect(),
        marks: Vec::new(),
        equal_axes: false,
    }
}

/// The result as JSON, in SI.
pub(crate) fn json(info: &ModelInfo, answer: &Answer) -> Value {
    let end = |end: f64| end.is_finite().then_some(end);
    let estimates = answer.estimates.iter().map(|estimate| {
        json!({
            "name": estimate.quantity.name, "unit": estimate.quantity.unit,
            "bias": estimate.is_bias, "nominal": estimate.nominal, "value": estimate.value,
            "std": estimate.std, "robust_std": estimate.robust_std,
            "interval95": estimate.interval95.map(end), "told": estimate.is_told(),
            "profile": estimate.profile,
        })
    });
    let names: Vec<&str> = info
        .inputs
        .iter()
        .map(|input| input.name.as_ref())
        .collect();
    let inputs = |run: &Inputs| {
        json!({
            "run": run.run, "inputs": &names[..info.declared_inputs], "t": run.times,
            "values": run.values, "stds": run.stds,
        })
    };
    let noise = answer.noise.iter();
    let noise = noise.map(|(column, std)| json!({ "column": column, "std": std }));
    let rows = answer.correlation.row_iter();
    let correlation = rows.map(|row| row.iter().copied().collect::<Vec<f64>>());
    json!({
        "schema": "inverse/1",
        "mechanism": info.name,
        "relations": answer.relations,
        "normalised_square": answer.normalised_square,
        "spacing_s": answer.spacing,
        "estimates": estimates.collect::<Vec<_>>(),
        "noise": noise.collect::<Vec<_>>(),
        "noise_correlation": correlation.collect::<Vec<_>>(),
        "runs": answer.inputs.iter().map(inputs).collect::<Vec<_>>(),
    })
}
