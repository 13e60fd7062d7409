//! The inputs of recorded motions.

use appell_gap::inverse::{Answer, Inputs};
use appell_runtime::model::ModelInfo;
use serde_json::{Value, json};

use super::{names, rows};

/// Input-free relations, estimated parameters and the inputs of recorded motions.
pub fn inverse(info: &ModelInfo, answer: &Answer) -> Value {
    let end = |end: f64| end.is_finite().then_some(end);
    let estimates = answer.estimates.iter().map(|estimate| {
        json!({
            "name": estimate.quantity.name, "unit": estimate.quantity.unit,
            "bias": estimate.is_bias, "nominal": estimate.nominal, "value": estimate.value,
            "std": estimate.std, "robust_std": estimate.robust_std,
            "interval95": estimate.interval95.map(end), "told": estimate.is_bounded(),
            "profile": estimate.profile,
        })
    });
    let names = names(&info.inputs);
    let inputs = |run: &Inputs| {
        json!({
            "run": run.run, "inputs": &names[..info.declared_inputs], "t": run.times,
            "values": run.values, "stds": run.stds,
        })
    };
    let noise = answer.noise.iter();
    let noise = noise.map(|(column, std)| json!({ "column": column, "std": std }));
    json!({
        "schema": "inverse/1",
        "mechanism": info.name,
        "relations": answer.relations,
        "normalised_square": answer.normalised_square,
        "spacing_s": answer.spacing,
        "estimates": estimates.collect::<Vec<_>>(),
        "noise": noise.collect::<Vec<_>>(),
        "noise_correlation": rows(&answer.correlation),
        "runs": answer.inputs.iter().map(inputs).collect::<Vec<_>>(),
    })
}
