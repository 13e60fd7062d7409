//! Where a motion leaves the range of validity of its model.

use appell_runtime::Trajectory;
use appell_runtime::simulate::{Breach, Limit};
use serde_json::{Map, Value, json};

use appell_report::text::number;

/// Number of breaches listed one by one.
const MOST_SHOWN: usize = 10;

/// One line per breach; empty if there is none.
pub(crate) fn text(trajectory: &Trajectory) -> String {
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

/// The breaches as JSON, in SI.
pub(crate) fn json(trajectory: &Trajectory) -> Value {
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
        let states = info.states.iter().zip(&breach.state);
        let states: Map<String, Value> = states
            .map(|(state, &value)| (state.name.to_string(), json!(value)))
            .collect();
        json!({
            "t_s": breach.t,
            "kind": kind,
            "where": place,
            "value": breach.value,
            "state": states,
        })
    };
    trajectory.breaches.iter().map(breach).collect()
}
