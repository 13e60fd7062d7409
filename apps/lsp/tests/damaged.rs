//! Damaged texts and messages: there is always an answer.

use appell_test_kit::shipped;
use serde_json::{Value, json};

use crate::editor::{CART, Editor, URI, position};

/// Bytes between two ends of a text.
const STEP: usize = 97;

#[test]
fn every_truncated_spec_is_answered() {
    let mut editor = Editor::new();
    for (_, text) in shipped() {
        for end in (0..text.len()).step_by(STEP) {
            let text = &text[..text.floor_char_boundary(end)];
            editor.open(text);
            for at in [text.len(), text.len() / 2, text.len().saturating_sub(5)] {
                let at = text.floor_char_boundary(at);
                let place = json!({
                    "textDocument": { "uri": URI }, "position": position(text, at),
                    "context": { "includeDeclaration": true, "triggerKind": 1 }, "newName": "other",
                });
                for question in ["hover", "definition", "references", "completion"] {
                    let method = format!("textDocument/{question}");
                    editor.ask(&method, place.clone()).expect("an answer");
                }
                // A refusal is an answer, but not one of a mistake in the server.
                if let Err(message) = editor.ask("textDocument/rename", place) {
                    assert!(!message.contains("language server"), "{message}\n{text}");
                }
            }
        }
    }
    assert!(!editor.has_heard("window/logMessage"));
}

#[test]
fn messages_that_make_no_sense_are_refused() {
    let mut editor = Editor::with(CART);
    assert!(
        editor
            .ask("textDocument/hover", json!({ "no": "sense" }))
            .is_err()
    );
    assert!(editor.ask("textDocument/unheardOf", Value::Null).is_err());
    editor.tell("textDocument/didChange", json!([]));
    editor
        .ask("textDocument/unheardOf", Value::Null)
        .expect_err("a method");
    assert!(editor.has_heard("window/logMessage"));
    let far = json!({ "line": 4_000_000_000_u32, "character": 4_000_000_000_u32 });
    let back = json!({ "start": far, "end": { "line": 0, "character": 0 } });
    editor.change(&json!([{ "range": back, "text": "\n" }]));
    let place = json!({ "textDocument": { "uri": URI }, "position": far });
    assert_eq!(editor.ask("textDocument/hover", place), Ok(Value::Null));
    let place = json!({ "textDocument": { "uri": "file:///other" }, "position": far });
    assert_eq!(editor.ask("textDocument/hover", place), Ok(Value::Null));
}
