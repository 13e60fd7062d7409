//! What a name tells.

use serde_json::json;

use crate::editor::{CART, Editor};

/// What is told at a place.
fn told(editor: &mut Editor, needle: &str, letters: usize) -> String {
    let told = editor.ask_at("textDocument/hover", (CART, needle, letters), json!({}));
    let told = told.expect("an answer");
    told["contents"]["value"]
        .as_str()
        .unwrap_or_default()
        .to_owned()
}

#[test]
fn a_name_tells_its_kind_value_unit_sentence_and_uses() {
    let mut editor = Editor::with(CART);
    let mut holds = |needle: &str, letters: usize, parts: &[&str]| {
        let told = told(&mut editor, needle, letters);
        for part in parts {
            assert!(told.contains(part), "no `{part}` in\n{told}");
        }
    };
    let parameter = [
        "**parameter** `k` = 30 N/m",
        "stiffness of the spring",
        "`loads.spring.stiffness`",
    ];
    holds("k =", 0, &parameter);
    holds("stiffness = \"k\"", 13, &parameter);
    holds(
        "phi =",
        0,
        &[
            "**coordinate** `phi`, in rad",
            "range = [-3, 3]",
            "`initial.phi`",
        ],
    );
    holds("dot(x)", 4, &["**coordinate** `x`, in m"]);
    holds(
        "spring =",
        0,
        &["**load** `spring`, spring", "`outputs.tension.value`"],
    );
    holds(
        "v     =",
        0,
        &["**pseudo-velocity** `v`, in m/s", "value = \"dot(x)\""],
    );
    holds(
        "height",
        0,
        &["**output** `height`, in m", "bob above the rail"],
    );
    holds("[bodies.bob]", 9, &["**body** `bob`", "mass = \"m\""]);
    holds("\"ground\"", 1, &["inertial frame"]);
    holds("\"O\"", 1, &["origin of the ground", "`points.C.from`"]);
    assert_eq!(told(&mut editor, "# Umlaute", 3), "");
}

#[test]
fn a_name_tells_the_equations_that_it_is_in() {
    let mut editor = Editor::with(CART);
    editor.wait_for_equations();
    let spring = told(&mut editor, "spring =", 0);
    assert!(
        spring.contains("force appears in the equations of motion of `v`"),
        "{spring}"
    );
    assert!(!spring.contains("`omega`"), "{spring}");
    let weight = told(&mut editor, "weight", 0);
    assert!(
        weight.contains("in the equations of motion of `omega`"),
        "{weight}"
    );
    let mass = told(&mut editor, "m =", 0);
    assert!(
        mass.contains("It appears in the equations of motion of `v`, `omega`"),
        "{mass}"
    );
    let speed = told(&mut editor, "v     =", 0);
    assert!(speed.contains("`dot(x)` depend"), "{speed}");
    let cart = told(&mut editor, "[bodies.cart]", 9);
    assert!(
        cart.contains("inertia appears in the equations of motion of `v`"),
        "{cart}"
    );
}

#[test]
fn the_equations_of_the_newest_valid_text_stay_while_it_is_broken() {
    let mut editor = Editor::with(CART);
    editor.wait_for_equations();
    editor.change(&json!([{ "text": CART.replace("by = \"phi\"", "by = \"phi +\"") }]));
    let spring = told(&mut editor, "spring =", 0);
    assert!(spring.contains("equations of motion"), "{spring}");
}

#[test]
fn the_words_of_a_spec_are_no_markdown() {
    let words = "stiffness of the spring";
    let evil = "[click](https://evil.test) <b>x</b> ![i](y) `z`";
    assert!(CART.contains(words));
    let text = CART.replace(words, evil);
    let mut editor = Editor::with(&text);
    let at = (text.as_str(), "k =", 0);
    let told = editor.ask_at("textDocument/hover", at, json!({}));
    let told = told.expect("an answer")["contents"]["value"].to_string();
    for mark in ["[click](", "<b>", "![i]", " `z`"] {
        assert!(!told.contains(mark), "{told}");
    }
    assert!(told.contains("click"), "{told}");
}
