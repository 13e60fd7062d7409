//! Results as JSON, in SI.

mod design;
mod ensemble;
mod identification;
mod inverse;
mod motion;
mod recording;
mod robot;

use appell_recordings::DataSet;
use appell_runtime::model::Quantity;
use nalgebra::DMatrix;
use serde_json::{Map, Value, json};

pub use crate::gap_report::json as diagnosis;
pub use crate::steady::chart::json as chart;
pub use crate::steady::export::json as steady;
pub use design::{design, schedule};
pub use ensemble::ensemble;
pub use identification::identification;
pub use inverse::inverse;
pub use motion::{extrema, motion};
pub use recording::recording;
pub use robot::robot;

use crate::capture::Converted;
use crate::check::{Checked, Thorough};
use crate::control::attraction::Explored;

/// Disturbed motions and their fates.
pub fn attraction(region: &Explored<'_>) -> Value {
    region.json()
}

/// A checked spec.
pub fn check(checked: &Checked) -> Value {
    checked.to_json()
}

/// The numerical check of a spec.
pub fn thorough(thorough: &Thorough) -> Value {
    thorough.to_json()
}

/// A converted motion capture.
pub fn capture(converted: &Converted) -> Value {
    converted.to_json()
}

/// A result about a data set, with numbers of a robot under the names of its file.
pub fn in_names_of(set: &DataSet, value: Value) -> Value {
    match value {
        Value::String(text) => set.named(&text).into(),
        Value::Array(values) => values
            .into_iter()
            .map(|value| in_names_of(set, value))
            .collect(),
        Value::Object(fields) => {
            let fields = fields
                .into_iter()
                .map(|(key, value)| (key, in_names_of(set, value)));
            Value::Object(fields.collect())
        }
        other => other,
    }
}

/// Values by the names of their quantities.
pub(crate) fn named(quantities: &[Quantity], values: &[f64]) -> Map<String, Value> {
    let pairs = quantities.iter().zip(values);
    pairs
        .map(|(quantity, &value)| (quantity.name.to_string(), json!(value)))
        .collect()
}

/// The rows of a matrix.
pub(crate) fn rows(matrix: &DMatrix<f64>) -> Value {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().copied().collect::<Value>())
        .collect()
}

/// The names of quantities.
pub(crate) fn names(quantities: &[Quantity]) -> Vec<&str> {
    let names = quantities.iter().map(|quantity| quantity.name.as_ref());
    names.collect()
}
