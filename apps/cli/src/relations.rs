//! Input-free relations, identified parameters and recovered inputs as text.

use std::fmt::Write as _;

use appell_gap::inverse::{Answer, Estimate};

use appell_report::row;
use appell_report::text::{number, table};

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
    let mut rows = vec![row!["column", "noise"]];
    for (column, std) in &answer.noise {
        rows.push(row![column, format!("{std:.3e}")]);
    }
    text + &table(&rows, 1..2)
}

fn estimates(estimates: &[Estimate]) -> String {
    let mut rows = vec![row!["value", "nominal", "found", "from", "to", "unit", ""]];
    for estimate in estimates {
        let quantity = &estimate.quantity;
        let bias = if estimate.is_bias { "bias of " } else { "" };
        let shown = |si: f64| number(quantity.to_unit(si));
        let [low, high] = estimate.interval95.map(shown);
        rows.push(row![
            format!("{bias}{}", quantity.name),
            shown(estimate.nominal),
            shown(estimate.value),
            low,
            high,
            quantity.unit,
            remark(estimate)
        ]);
    }
    table(&rows, 1..5)
}

/// A remark on parameters that the motions do not determine.
fn remark(estimate: &Estimate) -> &'static str {
    match estimate.interval95 {
        [low, high] if low.is_infinite() && high.is_infinite() => "not determined by these motions",
        [_, high] if high.is_infinite() => "not bounded from above by these motions",
        [low, _] if low.is_infinite() => "not bounded from below by these motions",
        _ => "",
    }
}
