//! A JSON schema of the language, for completion and checks in editors.
//!
//! It is generated from the table that the parser uses, so that the two agree.

use serde_json::{Map, Value, json};

use crate::language::{AXES, Form, Key, Kind, Need, Presence, SECTIONS, Shape, Word};
use crate::limits::{MAX_SENTENCE, MAX_TURNS};
use crate::name;

/// The schema (draft 7) as JSON text.
pub fn json_schema() -> String {
    let mut properties = Map::new();
    for section in SECTIONS {
        let mut schema = match &section.shape {
            Shape::Table(keys) => table(keys, None),
            Shape::Items(keys, None) => items(&table(keys, None)),
            Shape::Items(keys, Some(only)) => {
                let bare = keys.iter().find(|k| k.name == *only).map(|k| form(&k.form));
                let alternatives: Vec<Value> =
                    bare.into_iter().chain([table(keys, None)]).collect();
                items(&json!({ "anyOf": alternatives }))
            }
            Shape::Kinds(kinds) => {
                let alternatives: Vec<Value> =
                    kinds.iter().map(|k| table(k.keys, Some(k))).collect();
                items(&json!({ "oneOf": alternatives }))
            }
            Shape::States => items(&json!({ "type": "number" })),
        };
        schema["description"] = json!(section.about);
        properties.insert(section.name.to_owned(), schema);
    }
    let required: Vec<&str> = SECTIONS
        .iter()
        .filter(|s| s.presence == Presence::Required)
        .map(|s| s.name)
        .collect();
    let either: Vec<Value> = SECTIONS
        .iter()
        .filter_map(|s| match s.presence {
            Presence::Unless(other) => Some(json!({
                "anyOf": [{ "required": [s.name] }, { "required": [other] }],
            })),
            Presence::Required | Presence::Optional => None,
        })
        .collect();
    let schema = json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "appell mechanism spec",
        "type": "object",
        "properties": properties,
        "required": required,
        "allOf": either,
        "additionalProperties": false,
    });
    format!("{schema:#}\n")
}

fn items(item: &Value) -> Value {
    json!({
        "type": "object",
        "patternProperties": { name::pattern(): item },
        "additionalProperties": false,
    })
}

fn table(keys: &[Key], kind: Option<&Kind>) -> Value {
    let mut properties = Map::new();
    let mut required: Vec<&str> = Vec::new();
    if let Some(kind) = kind {
        required.push("kind");
        properties.insert(
            "kind".to_owned(),
            json!({ "const": kind.word, "description": kind.about }),
        );
    }
    for key in keys {
        let mut schema = form(&key.form);
        schema["description"] = json!(key.about);
        properties.insert(key.name.to_owned(), schema);
        if key.need == Need::Always {
            required.push(key.name);
        }
    }
    let mut schema = json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    let ways: Vec<Value> = (0..3)
        .map(|n| {
            keys.iter()
                .filter(|k| k.need == Need::Way(n))
                .map(|k| k.name)
                .collect::<Vec<_>>()
        })
        .filter(|names| !names.is_empty())
        .map(|names| json!({ "required": names }))
        .collect();
    if !ways.is_empty() {
        schema["oneOf"] = json!(ways);
    }
    schema
}

fn form(form: &Form) -> Value {
    let expression = || json!({ "type": ["string", "number"] });
    let name = || json!({ "type": "string", "pattern": name::pattern() });
    let words =
        |all: &[Word]| json!({ "enum": all.iter().map(|word| word.text).collect::<Vec<_>>() });
    let list = |item: Value, length: usize| json!({ "type": "array", "items": item, "minItems": length, "maxItems": length });
    match form {
        Form::Text => json!({ "type": "string", "maxLength": MAX_SENTENCE }),
        Form::Name | Form::NewName | Form::Reference(_) => {
            json!({ "type": "string", "pattern": name::pattern() })
        }
        Form::Unit => json!({ "type": "string" }),
        Form::Number => json!({ "type": "number" }),
        Form::Numbers => json!({ "type": "array", "items": { "type": "number" } }),
        Form::Range => list(json!({ "type": "number" }), 2),
        Form::Expression => expression(),
        Form::Components => list(expression(), 3),
        Form::Matrix => list(list(expression(), 3), 3),
        Form::Two(_) => list(name(), 2),
        Form::Quaternion => list(name(), 4),
        Form::NewNames(count) => list(name(), *count),
        Form::Values(count) => list(json!({ "type": "number" }), *count),
        Form::Direction => json!({ "anyOf": [words(AXES), list(expression(), 3)] }),
        Form::Word(known) => words(known),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Inertia(keys) => json!({ "anyOf": [expression(), table(keys, None)] }),
        Form::Table(keys) => table(keys, None),
        Form::Tables(keys) => json!({
            "type": "array",
            "items": table(keys, None),
            "minItems": 1,
            "maxItems": MAX_TURNS,
        }),
    }
}
