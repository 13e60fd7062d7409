//! From names to their definitions and uses, and other names.

use serde_json::{Value, json};

use crate::editor::{CART, Editor, position, range};

const DEFINITION: &str = "textDocument/definition";
const REFERENCES: &str = "textDocument/references";
const RENAME: &str = "textDocument/rename";

#[test]
fn a_name_in_an_expression_leads_to_its_definition() {
    let mut editor = Editor::with(CART);
    let at = (CART, "-l*cos(phi)", 7);
    let told = editor.ask_at(DEFINITION, at, json!({})).expect("a place");
    let start = position(CART, CART.find("phi =").expect("the coordinate"));
    assert_eq!(told["range"]["start"], start);
}

#[test]
fn a_reference_leads_to_the_item_of_its_kind() {
    let mut editor = Editor::with(CART);
    for (needle, letters, line) in [
        ("in = \"rod\"", 7, "rod = {"),
        ("velocity(B, x, rod)", 16, "rod = {"),
        ("velocity(B, x, rod)", 9, "B = {"),
        ("force(spring)", 7, "spring = {"),
    ] {
        let told = editor.ask_at(DEFINITION, (CART, needle, letters), json!({}));
        let start = position(CART, CART.find(line).expect("a definition"));
        assert_eq!(told.expect("a place")["range"]["start"], start, "{needle}");
    }
    let ground = editor.ask_at(DEFINITION, (CART, "\"ground\"", 2), json!({}));
    assert_eq!(ground, Ok(Value::Null));
}

#[test]
fn all_uses_of_a_name_are_found() {
    let mut editor = Editor::with(CART);
    let mut count = |with: bool| {
        let context = json!({ "context": { "includeDeclaration": with } });
        let told = editor.ask_at(REFERENCES, (CART, "phi =", 0), context);
        told.expect("places").as_array().map_or(0, Vec::len)
    };
    // `by`, `dot(phi)`, `cos(phi)` and `[initial]`.
    assert_eq!((count(false), count(true)), (4, 5));
}

/// The text with the edits of an answer, and how many there were.
fn edited(text: &str, answer: &Value) -> (String, usize) {
    let edits = answer["documentChanges"][0]["edits"]
        .as_array()
        .expect("edits");
    let offset = |place: &Value| {
        let is = |at: &usize| text.is_char_boundary(*at) && position(text, *at) == *place;
        (0..=text.len()).find(is).expect("a place of the text")
    };
    let mut whole = text.to_owned();
    for edit in edits.iter().rev() {
        let (start, end) = (
            offset(&edit["range"]["start"]),
            offset(&edit["range"]["end"]),
        );
        whole.replace_range(start..end, edit["newText"].as_str().expect("a text"));
    }
    (whole, edits.len())
}

#[test]
fn a_renamed_spec_is_valid() {
    let mut editor = Editor::with(CART);
    for (needle, letters, new, count) in [
        ("phi =", 1, "angle", 5),
        ("\"rod\"", 1, "bar", 3),
        ("centre = \"C\"", 10, "Cart", 4),
        ("[bodies.bob]", 9, "pendulum", 1),
        ("force(spring)", 7, "coil", 2),
    ] {
        let new_name = json!({ "newName": new });
        let told = editor.ask_at(RENAME, (CART, needle, letters), new_name);
        let (text, edits) = edited(CART, &told.expect("edits"));
        assert_eq!(edits, count, "{new}");
        assert!(appell_spec::load("cart.toml", &text).is_ok(), "{text}");
    }
}

#[test]
fn what_cannot_be_renamed_says_why() {
    let mut editor = Editor::with(CART);
    for (needle, new, reason) in [
        ("M =", "m", "`m` is taken"),
        ("M =", "2m", "not a valid name"),
        ("M =", "sin", "reserved"),
        ("ground", "earth", "defined by the language"),
        ("rod =", "ground", "taken"),
    ] {
        let new_name = json!({ "newName": new });
        let told = editor.ask_at(RENAME, (CART, needle, 0), new_name);
        let message = told.expect_err("it was renamed");
        assert!(message.contains(reason), "{message}");
    }
    let ground = editor.ask_at("textDocument/prepareRename", (CART, "ground", 0), json!({}));
    assert_eq!(ground, Ok(Value::Null));
    let prepared = editor.ask_at("textDocument/prepareRename", (CART, "rod =", 0), json!({}));
    let prepared = prepared.expect("a range");
    assert_eq!(prepared["placeholder"], "rod");
    assert_eq!(prepared["range"]["start"], range(CART, "rod =")["start"]);
}

#[test]
fn a_broken_spec_is_not_renamed() {
    let text = CART.replace("by = \"phi\"", "by = \"phi +\"");
    let mut editor = Editor::with(&text);
    let told = editor.ask_at(RENAME, (&text, "phi =", 0), json!({ "newName": "angle" }));
    let message = told.expect_err("it was renamed");
    assert!(message.contains("syntax error"), "{message}");
}
