//! Reference vectors: numbers with fifty digits that were computed elsewhere.
//!
//! They lie beside the workspace, in `../shared/reference`, and are no part of it. Without them
//! the tests that need them say so and end.

use serde_json::Value;

use crate::shipped::workspace;

/// A whole file, or nothing with the reason printed.
pub fn document(file: &str) -> Option<Value> {
    let path = workspace().join("../shared/reference").join(file);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: there is no {}", path.display());
        return None;
    };
    Some(serde_json::from_str(&text).unwrap_or_else(|error| panic!("{file}: {error}")))
}

/// Cases of a file, or nothing with the reason printed.
pub fn cases(file: &str) -> Option<Vec<Value>> {
    let whole = document(file)?;
    let cases = whole["cases"].as_array();
    Some(cases.unwrap_or_else(|| panic!("{file}: no cases")).clone())
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
