//! What may stand at a place.

use serde_json::json;

use crate::editor::{CART, Editor};

/// The labels at a place of a text.
fn labels(text: &str, needle: &str, letters: usize) -> Vec<String> {
    let mut editor = Editor::with(text);
    let told = editor.ask_at(
        "textDocument/completion",
        (text, needle, letters),
        json!({}),
    );
    let told = told.expect("an answer");
    let items = told.as_array().expect("items").iter();
    let label = |item: &serde_json::Value| item["label"].as_str().map(str::to_owned);
    items.filter_map(label).collect()
}

fn has(labels: &[String], wanted: &str) -> bool {
    labels.iter().any(|label| label == wanted)
}

#[test]
fn expressions_offer_what_their_place_allows() {
    let force = labels(CART, "\"u - 2", 1);
    for name in [
        "M", "x", "v", "u", "dot", "t", "sin", "if", "velocity", "force",
    ] {
        assert!(has(&force, name), "{name}: {force:?}");
    }
    assert!(!has(&force, "acceleration") && !has(&force, "height"));
    let mass = labels(CART, "\"M\"", 1);
    assert!(has(&mass, "M") && has(&mass, "sqrt"));
    for name in ["x", "v", "u", "dot", "t", "velocity", "force"] {
        assert!(!has(&mass, name), "{name}: {mass:?}");
    }
    let angle = labels(CART, "by = \"phi\"", 6);
    assert!(has(&angle, "phi") && !has(&angle, "v") && !has(&angle, "dot"));
}

#[test]
fn arguments_offer_what_they_name() {
    let text = CART.replace("-l*cos(phi)", "-l*cos(phi) + position(B, z, rod) + dot(");
    assert_eq!(labels(&text, "dot(\"", 4), ["x", "phi"]);
    assert_eq!(labels(&text, "position(B", 9), ["O", "C", "B"]);
    assert_eq!(labels(&text, "position(B, z", 12), ["x", "y", "z"]);
    assert_eq!(labels(&text, "position(B, z, rod", 15), ["ground", "rod"]);
    assert_eq!(
        labels(CART, "force(spring", 6),
        ["weight", "spring", "push"]
    );
}

#[test]
fn references_offer_items_of_their_kind_but_not_the_item_itself() {
    assert_eq!(labels(CART, "from = \"C\"", 8), ["O", "C"]);
    assert_eq!(labels(CART, "parent = \"", 10), ["ground"]);
    assert_eq!(labels(CART, "centre = \"", 10), ["O", "C", "B"]);
    let text = CART.replace("coordinate = \"x\"", "coordinate = \"\"");
    assert_eq!(labels(&text, "coordinate = \"", 14), ["x", "phi"]);
}

#[test]
fn units_are_offered_also_where_none_can_be_read() {
    for text in [
        CART,
        &CART.replace("\"N/m\"", "\"\""),
        &CART.replace("\"N/m\"", "\"N/"),
    ] {
        let units = labels(text, "value = 30,   unit = \"", 22);
        for unit in ["kg", "rad", "kN", "m/s^2"] {
            assert!(has(&units, unit), "{unit}: {units:?}");
        }
    }
    assert!(has(&labels(CART, "2[N*s", 2), "kg"));
}

#[test]
fn nothing_is_offered_outside_of_strings() {
    assert!(labels(CART, "value = 30", 8).is_empty());
    assert!(labels(CART, "about = \"cart\"", 10).is_empty());
    assert!(labels(CART, "kind = \"spring\"", 9).is_empty());
}
