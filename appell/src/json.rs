//! Results as JSON, in SI.

mod design;
mod identification;
mod inverse;
mod motion;
mod recording;

use appell_runtime::model::Quantity;
use serde_json::{Map, Value, json};

pub use design::{design, schedule};
pub use identification::identification;
pub use inverse::inverse;
pub use motion::{extrema, motion};
pub use recording::recording;

/// Values by the names of their quantities.
pub(crate) fn named(quantities: &[Quantity], values: &[f64]) -> Map<String, Value> {
    let pairs = quantities.iter().zip(values);
    pairs
        .map(|(quantity, &value)| (quantity.name.to_string(), json!(value)))
        .collect()
}

/// The names of quantities.
pub(crate) fn names(quantities: &[Quantity]) -> Vec<&str> {
    let names = quantities.iter().map(|quantity| quantity.name.as_ref());
    names.collect()
}
