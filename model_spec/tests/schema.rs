//! The editor schema accepts and refuses what the parser accepts and refuses.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

use appell_spec::schema::json_schema;
use appell_spec::{Code, load, parse, starter};
use serde_json::{Map, Value, json};
use toml::de::{DeTable, DeValue};

fn schema() -> Value {
    serde_json::from_str(&json_schema()).unwrap()
}

fn json_of(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text.as_ref()),
        DeValue::Integer(number) => json!(number.as_str().parse::<f64>().unwrap()),
        DeValue::Float(number) => json!(number.as_str().parse::<f64>().unwrap()),
        DeValue::Boolean(truth) => json!(truth),
        DeValue::Datetime(time) => json!(time.to_string()),
        DeValue::Array(array) => array.iter().map(|v| json_of(v.get_ref())).collect(),
        DeValue::Table(table) => json_of_table(table),
    }
}

fn json_of_table(table: &DeTable<'_>) -> Value {
    let entries = table
        .iter()
        .map(|(key, value)| (key.get_ref().to_string(), json_of(value.get_ref())));
    Value::Object(entries.collect::<Map<_, _>>())
}

/// As much of JSON schema as ours uses.
fn accepts(schema: &Value, value: &Value) -> bool {
    let list = |key: &str| schema[key].as_array().cloned().unwrap_or_default();
    let kind = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        other => panic!("{other}"),
    };
    let kinds = match &schema["type"] {
        Value::Null => true,
        Value::String(name) => kind(name),
        names => names
            .as_array()
            .unwrap()
            .iter()
            .any(|n| kind(n.as_str().unwrap())),
    };
    let words = schema["enum"].is_null() || list("enum").contains(value);
    let constant = schema["const"].is_null() || schema["const"] == *value;
    let one = schema["oneOf"].is_null()
        || list("oneOf").iter().filter(|s| accepts(s, value)).count() == 1;
    let any = schema["anyOf"].is_null() || list("anyOf").iter().any(|s| accepts(s, value));
    let required = value.is_object() || list("required").is_empty();
    let required = required
        && list("required")
            .iter()
            .all(|key| value.get(key.as_str().unwrap()).is_some());
    let members = value.as_object().is_none_or(|object| {
        object.iter().all(|(key, member)| {
            if let Some(inner) = schema["properties"].get(key) {
                return accepts(inner, member);
            }
            let named = schema["patternProperties"]
                .as_object()
                .and_then(|p| p.values().next());
            match named {
                Some(inner) => accepts(inner, member),
                None => schema["additionalProperties"].is_null(),
            }
        })
    });
    let elements = value.as_array().is_none_or(|array| {
        let length = array.len() as u64;
        schema["minItems"].as_u64().is_none_or(|n| n <= length)
            && schema["maxItems"].as_u64().is_none_or(|n| length <= n)
            && (schema["items"].is_null() || array.iter().all(|v| accepts(&schema["items"], v)))
    });
    kinds && words && constant && one && any && required && members && elements
}

fn accepts_text(text: &str) -> bool {
    let (table, errors) = DeTable::parse_recoverable(text);
    errors.is_empty() && accepts(&schema(), &json_of_table(table.get_ref()))
}

#[test]
fn good_specs_fit_the_schema() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../generated/mechanisms");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        assert!(
            accepts_text(&std::fs::read_to_string(&path).unwrap()),
            "{}",
            path.display()
        );
    }
    assert!(accepts_text(&starter("fresh").unwrap()));
}

#[test]
fn bad_structure_does_not_fit_the_schema() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_specs");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        // What a schema can see; units and names are beyond it.
        let structural = [
            "unknown-section",
            "unknown-key",
            "unknown-key.other-kind",
            "missing-section",
            "missing-key",
            "missing-key.way",
            "missing-key.kind",
            "conflicting-keys",
            "wrong-type",
            "wrong-type.length",
            "unknown-word",
            "unknown-word.axis",
        ];
        let name = path.file_stem().unwrap().to_str().unwrap();
        if structural.contains(&name) {
            assert!(!accepts_text(&text), "{name}");
        }
    }
}

/// Every key that the schema lists, with the path of tables around it.
fn keys(schema: &Value, path: &str, found: &mut Vec<(String, String)>) {
    if let Some(properties) = schema["properties"].as_object() {
        for (key, inner) in properties {
            found.push((path.to_owned(), key.clone()));
            keys(inner, &format!("{path}.{key}"), found);
        }
    }
    for branch in ["oneOf", "anyOf"] {
        for inner in schema[branch].as_array().into_iter().flatten() {
            let kind = inner["properties"]["kind"]["const"].as_str();
            let path = kind.map_or_else(|| path.to_owned(), |k| format!("{path}:{k}"));
            keys(inner, &path, found);
        }
    }
    if let Some(items) = schema["patternProperties"].as_object() {
        for inner in items.values() {
            keys(inner, &format!("{path}.item"), found);
        }
    }
    if schema["items"].is_object() {
        keys(&schema["items"], path, found);
    }
}

#[test]
fn every_key_of_the_schema_is_known_to_the_parser_and_no_other() {
    let mut found = Vec::new();
    keys(&schema(), "", &mut found);
    assert!(found.len() > 80, "{}", found.len());
    for (path, key) in found {
        let is_known = |key: &str| {
            let mut text = match path.split_once(':') {
                // The kind decides on the keys.
                Some((table, kind)) => {
                    let (kind, rest) = match kind.split_once('.') {
                        Some((kind, inner)) => (kind, format!("{inner} = [{{ {key} = 0 }}]")),
                        None => (kind, format!("{key} = 0")),
                    };
                    format!("{} = {{ kind = \"{kind}\", {rest} }}", &table[1..])
                }
                None if path.is_empty() => format!("{key} = 0"),
                None if path.rsplit('.').next() == Some("turns") => {
                    format!("{} = [{{ {key} = 0 }}]", &path[1..])
                }
                None => format!("{} = {{ {key} = 0 }}", &path[1..]),
            };
            text.push('\n');
            let (_, findings) = parse::parse(&text);
            !findings
                .iter()
                .any(|f| matches!(f.code, Code::UnknownKey | Code::UnknownSection))
        };
        assert!(key == "kind" || is_known(&key), "{path} {key}");
        assert!(!is_known("colour"), "{path}");
    }
    assert!(load("empty.toml", "").is_err());
}
