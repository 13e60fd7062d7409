//! A simulated motion.

use appell_runtime::Trajectory;
use appell_runtime::simulate::{Breach, Limit};
use serde_json::{Value, json};

use super::{named, object};

/// The summary of a motion; `failure` is the reason of an early end.
pub fn motion(trajectory: &Trajectory, failure: Option<&str>) -> Value {
    let info = trajectory.info();
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
    let extrema = all.iter().enumerate().map(|(column, quantity)| {
        let [min, max] = extrema(trajectory, column);
        let max_abs = max.abs().max(min.abs());
        let told = json!({ "min": min, "max": max, "max_abs": max_abs });
        (&quantity.name, told)
    });
    json!({
        "schema": "simulated/1",
        "mechanism": info.name,
        "parameters": named(&info.parameters, trajectory.parameters()),
        "t_end_s": trajectory.times().last(),
        "rows": trajectory.len(),
        "failure": failure,
        "events": breaches(trajectory),
        "initial_state": named(&all[..states], row(0)),
        "final_state": named(&all[..states], row(last)),
        "final_values": named(&all[states..], row(last).get(states..).unwrap_or_default()),
        "extrema": object(extrema),
        "statistics": {
            "steps": trajectory.statistics.steps,
            "rejected": trajectory.statistics.rejected,
            "evaluations": trajectory.statistics.evaluations,
        },
    })
}

/// Smallest and largest value of a recorded column, in SI.
pub fn extrema(trajectory: &Trajectory, column: usize) -> [f64; 2] {
    let values = (0..trajectory.len()).map(|row| trajectory.row(row)[column]);
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Where the motion leaves the range of validity of its model.
fn breaches(trajectory: &Trajectory) -> Value {
    let info = trajectory.info();
    let contact = |index: usize| {
        info.contacts
            .get(index)
            .map(|contact| contact.name.as_ref())
    };
    let breach = |breach: &Breach| {
        let (kind, place) = match breach.limit {
            Limit::Range { state } => {
                let name = info.states.get(state).map(|state| state.name.as_ref());
                ("out_of_range", json!({ "state": name }))
            }
            Limit::Contact { contact: index } => {
                ("contact_lost", json!({ "contact": contact(index) }))
            }
            Limit::Friction { contact: index } => ("slip", json!({ "contact": contact(index) })),
            Limit::Condition { of } => {
                let name = trajectory.conditions().get(of);
                ("ill_conditioned", json!({ "of": name }))
            }
        };
        json!({
            "t_s": breach.t,
            "kind": kind,
            "where": place,
            "value": breach.value,
            "state": named(&info.states, &breach.state),
        })
    };
    trajectory.breaches.iter().map(breach).collect()
}
