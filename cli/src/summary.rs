//! What happened in a simulation.

use appell_runtime::Trajectory;
use appell_runtime::model::Quantity;
use serde_json::{Map, Value, json};

use crate::breaches;
use appell_report::text::{number, table};

/// Smallest and largest value of a column of the samples, in SI.
fn extrema(trajectory: &Trajectory, column: usize) -> [f64; 2] {
    let values = (0..trajectory.len()).map(|row| trajectory.row(row)[column]);
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// The summary as text: time, cost, and a table in the units of the spec.
pub(crate) fn text(trajectory: &Trajectory) -> String {
    let Some(last) = trajectory.len().checked_sub(1) else {
        return String::new();
    };
    let t_end = trajectory.times()[last];
    let heading = [
        "",
        "start",
        &format!("{} s", number(t_end)),
        "smallest",
        "largest",
        "unit",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (column, quantity) in trajectory.columns().iter().enumerate() {
        let shown = |value: f64| number(quantity.to_unit(value));
        let [low, high] = extrema(trajectory, column);
        rows.push(vec![
            quantity.name.to_string(),
            shown(trajectory.row(0)[column]),
            shown(trajectory.row(last)[column]),
            shown(low),
            shown(high),
            quantity.unit.to_string(),
        ]);
    }
    let cost = trajectory.statistics;
    let cost = if cost.evaluations == 0 {
        String::new()
    } else {
        format!(
            ": {} steps, {} rejected, {} evaluations",
            cost.steps, cost.rejected, cost.evaluations
        )
    };
    let title = &trajectory.info().title;
    let rows = table(&rows, 1..5);
    let breaches = breaches::text(trajectory);
    format!("{title}\n{} s{cost}\n{rows}{breaches}", number(t_end))
}

/// The summary as JSON, in SI.
pub(crate) fn json(trajectory: &Trajectory, failure: Option<&str>) -> Value {
    let info = trajectory.info();
    let named = |list: &[Quantity], values: &[f64]| -> Map<String, Value> {
        list.iter()
            .zip(values)
            .map(|(q, &value)| (q.name.to_string(), json!(value)))
            .collect()
    };
    let last = trajectory.len().saturating_sub(1);
    let row = |row: usize| {
        if trajectory.is_empty() {
            &[][..]
        } else {
            trajectory.row(row)
        }
    };
    let states = info.state_len();
    let all = trajectory.columns();
    let extrema: Map<String, Value> = all
        .iter()
        .enumerate()
        .map(|(column, quantity)| {
            let [min, max] = extrema(trajectory, column);
            (
                quantity.name.to_string(),
                json!({ "min": min, "max": max, "max_abs": max.abs().max(min.abs()) }),
            )
        })
        .collect();
    json!({
        "mechanism": info.name,
        "parameters": named(&info.parameters, trajectory.parameters()),
        "t_end_s": trajectory.times().last(),
        "rows": trajectory.len(),
        "failure": failure,
        "events": breaches::json(trajectory),
        "initial_state": named(&all[..states], row(0)),
        "final_state": named(&all[..states], row(last)),
        "final_values": named(&all[states..], row(last).get(states..).unwrap_or_default()),
        "extrema": extrema,
        "statistics": {
            "steps": trajectory.statistics.steps,
            "rejected": trajectory.statistics.rejected,
            "evaluations": trajectory.statistics.evaluations,
        },
    })
}

/// Whether all states are constant.
pub(crate) fn rests(trajectory: &Trajectory) -> bool {
    (0..trajectory.info().state_len()).all(|column| {
        let [low, high] = extrema(trajectory, column);
        high - low <= 0.0
    })
}
