//! Failures and states in the names and units of the spec.

use std::fmt::Write as _;

use crate::integrate::{Cause, Failure};
use crate::model::ModelInfo;

/// The failure in the names and units of the spec.
pub fn describe(failure: &Failure, info: &ModelInfo) -> String {
    let name = |index: usize| {
        info.states
            .get(index)
            .map_or("?", |state| state.name.as_ref())
    };
    let reason = match failure.cause {
        Cause::NonFinite { component } => {
            format!("`{}` or its rate is not finite", name(component))
        }
        Cause::StepTooSmall { h } => format!(
            "the step shrank to {h:.1e} s: the motion is singular here, or too stiff for the method"
        ),
        Cause::Inconsistent | Cause::Chattering => failure.cause.to_string(),
        Cause::TooManySteps { steps } => format!("the limit of {steps} steps was reached"),
        Cause::OutOfRange { component, range } => match info.states.get(component) {
            Some(state) => {
                let [lower, upper] = range.map(|limit| state.shown(limit));
                format!(
                    "`{}` leaves its range {lower} … {upper} {}",
                    state.name, state.unit
                )
            }
            None => failure.cause.to_string(),
        },
    };
    let state = describe_state(&failure.state, info);
    format!("at t = {:.9} s {reason}; state:{state}", failure.t)
}

/// A state in the names and units of the spec.
pub(super) fn describe_state(state: &[f64], info: &ModelInfo) -> String {
    let mut text = String::new();
    for (i, (state, &value)) in info.states.iter().zip(state).enumerate() {
        let separator = if i == 0 { "" } else { "," };
        let value = state.to_unit(value);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{separator} {} = {value:.6} {}",
            state.name, state.unit
        );
    }
    text
}
