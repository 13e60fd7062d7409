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
use serde_json::{Value, json};

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

/// A result about a data set, with numbers of a robot under the names of its file.
pub fn in_names_of(set: &DataSet, value: Value) -> Value {
    match value {
        Value::String(text) => set.named(&text).into(),
        Value::Array(values) => values
            .into_iter()
            .map(|value| in_names_of(set, value))
            .collect(),
        Value::Object(fields) => {
            let fields = fields.into_iter();
            object(fields.map(|(key, value)| (key, in_names_of(set, value))))
        }
        other => other,
    }
}

/// Fields by their keys.
pub(crate) fn object<K: ToString>(fields: impl IntoIterator<Item = (K, Value)>) -> Value {
    let fields = fields.into_iter();
    Value::Object(
        fields
            .map(|(key, value)| (key.to_string(), value))
            .collect(),
    )
}

/// Values by the names of their quantities.
pub(crate) fn named(quantities: &[Quantity], values: &[f64]) -> Value {
    let pairs = quantities.iter().zip(values);
    object(pairs.map(|(quantity, &value)| (&quantity.name, json!(value))))
}

/// The rows of a matrix.
pub(crate) fn rows(matrix: &DMatrix<f64>) -> Value {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().copied().collect::<Value>())
        .collect()
}

/// The names of quantities.
pub fn names(quantities: &[Quantity]) -> Vec<&str> {
    let names = quantities.iter().map(|quantity| quantity.name.as_ref());
    names.collect()
}
