//! Reference vectors: numbers with fifty digits that were computed elsewhere.
//!
//! They lie in `tests/reference`.

use serde_json::Value;

use crate::shipped::workspace;

/// The text of a file.
pub fn text(file: &str) -> String {
    let path = workspace().join("tests/reference").join(file);
    let text = std::fs::read_to_string(&path);
    text.unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A whole file.
pub fn document(file: &str) -> Value {
    serde_json::from_str(&text(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Cases of a file.
pub fn cases(file: &str) -> Vec<Value> {
    let whole = document(file);
    let cases = whole["cases"].as_array();
    cases.unwrap_or_else(|| panic!("{file}: no cases")).clone()
}

/// A number of a case.
pub fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// All numbers of a list, of a list of lists too.
pub fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        _ => vec![number(value)],
    }
}
