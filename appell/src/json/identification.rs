//! Estimated parameters.

use appell_gap::identify::Answer;
use appell_recordings::DataSet;
use serde_json::{Value, json};

use super::rows;

/// The result of an identification.
pub fn identification(set: &DataSet, answer: &Answer) -> Value {
    let parameters = answer.parameters.iter().map(|estimate| {
        json!({
            "name": estimate.quantity.name, "unit": estimate.quantity.unit,
            "nominal": estimate.nominal, "tolerance": estimate.tolerance,
            "value": estimate.value, "std": estimate.std, "robust_std": estimate.robust_std,
            "interval95": estimate.interval95(), "at_limit": estimate.at_limit,
        })
    });
    let whiteness = answer.whiteness.iter().map(|(column, consistency)| {
        json!({
            "channel": column, "count": consistency.count,
            "normalised_square": consistency.squares / consistency.count as f64,
            "band99": consistency.band.map(|end| end / consistency.count as f64),
            "correlation": consistency.correlation,
            "correlation_band99": consistency.correlation_band,
        })
    });
    let courses = answer.courses.iter().map(|course| {
        json!({
            "parameter": course.quantity.name, "run": course.run, "t_s": course.times,
            "value": course.values, "std": course.deviations,
        })
    });
    let held_out = answer.held_out.iter().map(|error| {
        let horizon = error.horizon.is_finite().then_some(error.horizon);
        json!({
            "horizon_s": horizon, "free_run": horizon.is_none(), "channel": error.column,
            "nominal": error.nominal, "fitted": error.fitted,
        })
    });
    let repeatability = answer.repeatability.iter().map(|one| {
        let runs = one
            .runs
            .iter()
            .map(|(run, [value, std])| json!({ "run": run, "value": value, "std": std }));
        json!({
            "name": one.name, "spread": one.spread, "p_value": one.p_value, "differs": one.differs,
            "runs": runs.collect::<Vec<_>>(),
        })
    });
    json!({
        "schema": "identified/1",
        "mechanism": set.mechanism.name,
        "is_optimum": answer.is_optimum,
        "parameters": parameters.collect::<Vec<_>>(),
        "correlation": rows(&answer.correlation),
        "combinations": answer.combinations,
        "noise": answer.noise,
        "disturbances": answer.disturbances,
        "innovations": whiteness.collect::<Vec<_>>(),
        "log_likelihood": { "nominal": answer.log_likelihoods[0], "fitted": answer.log_likelihoods[1] },
        "repeatability": repeatability.collect::<Vec<_>>(),
        "drifting": courses.collect::<Vec<_>>(),
        "held_out": held_out.collect::<Vec<_>>(),
    })
}
