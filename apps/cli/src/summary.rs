//! Summary of a simulation.

use appell_runtime::Trajectory;
use appell_runtime::simulate::Breach;

use appell::json::extrema;
use appell_report::row;
use appell_report::text::{number, table};

/// The summary as text: time, cost, and a table in the units of the spec.
pub(crate) fn text(trajectory: &Trajectory) -> String {
    let Some(last) = trajectory.len().checked_sub(1) else {
        return String::new();
    };
    let t_end = trajectory.times()[last];
    let end = format!("{} s", number(t_end));
    let mut rows = vec![row!["", "start", end, "smallest", "largest", "unit"]];
    for (column, quantity) in trajectory.columns().iter().enumerate() {
        let shown = |value: f64| number(quantity.to_unit(value));
        let [low, high] = extrema(trajectory, column);
        rows.push(row![
            quantity.name,
            shown(trajectory.row(0)[column]),
            shown(trajectory.row(last)[column]),
            shown(low),
            shown(high),
            quantity.unit
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
    let breaches = breaches(trajectory);
    format!("{title}\n{} s{cost}\n{rows}{breaches}", number(t_end))
}

/// Whether all states are constant.
pub(crate) fn rests(trajectory: &Trajectory) -> bool {
    (0..trajectory.info().state_len()).all(|column| {
        let [low, high] = extrema(trajectory, column);
        high - low <= 0.0
    })
}

/// Number of breaches listed one by one.
const MOST_SHOWN: usize = 10;

/// Where a motion leaves the range of validity of its model, a line each.
fn breaches(trajectory: &Trajectory) -> String {
    let breaches = &trajectory.breaches;
    let line = |breach: &Breach| {
        let what = breach.describe(trajectory.info());
        format!("  at t = {} s {what}\n", number(breach.t))
    };
    let more = breaches.len().saturating_sub(MOST_SHOWN);
    let rest = (more > 0).then(|| format!("  and {more} more; `--json` lists all\n"));
    let shown = breaches.iter().take(MOST_SHOWN).map(line);
    shown.chain(rest).collect()
}
