//! Joints, and what is named after them.

use serde_json::{Value, json};

use crate::editor::{Editor, position};

const ARM: &str = r#"
[mechanism]
name  = "arm"
title = "two joints"

[parameters]
m = { value = 1, unit = "kg" }
l = { value = 1, unit = "m" }

[joints]
slide = { kind = "prismatic", axis = "x", speed = "v" }
arm   = { kind = "revolute", parent = "slide", at = [0, 0, "l/2"], axis = [0, "l", "l"], about = "elbow" }

[points]
G = { from = "arm", in = "arm", at = ["l", 0, 0] }

[bodies]
arm = { frame = "arm", centre = "G", mass = "m", inertia = { in = "arm", diagonal = ["m*l^2", "m*l^2", "m*l^2"] } }

[loads]
hinge = { kind = "damper", coordinate = "q_arm", damping = "1 [N*m*s] + 0*v*1 [N*s^2]" }
"#;

fn told(editor: &mut Editor, what: &str, needle: &str, letters: usize, more: Value) -> Value {
    let method = format!("textDocument/{what}");
    editor
        .ask_at(&method, (ARM, needle, letters), more)
        .expect("an answer")
}

#[test]
fn what_a_joint_makes_leads_to_it() {
    let mut editor = Editor::with(ARM);
    for (needle, letters, line) in [
        ("\"q_arm\"", 2, "arm   = {"),
        ("from = \"arm\"", 9, "arm   = {"),
        ("in = \"arm\", at", 7, "arm   = {"),
        ("0*v", 2, "v\" }\narm"),
    ] {
        let place = told(&mut editor, "definition", needle, letters, json!({}));
        let start = position(ARM, ARM.find(line).expect("a definition"));
        assert_eq!(place["range"]["start"], start, "{needle}");
    }
}

#[test]
fn what_a_joint_makes_tells_of_it() {
    let mut editor = Editor::with(ARM);
    for (needle, letters, parts) in [
        (
            "\"q_arm\"",
            2,
            [
                "**coordinate** `q_arm`, in rad, made by the",
                "**joint** `arm`, revolute",
                "elbow",
            ],
        ),
        (
            "from = \"arm\"",
            9,
            [
                "**point** `arm`, made by the",
                "**joint** `arm`",
                "parent = \"slide\"",
            ],
        ),
        (
            "0*v",
            2,
            [
                "**pseudo-velocity** `v`, in m/s",
                "**joint** `slide`, prismatic",
                "axis = \"x\"",
            ],
        ),
    ] {
        let words = told(&mut editor, "hover", needle, letters, json!({}));
        let words = words["contents"]["value"]
            .as_str()
            .unwrap_or_default()
            .to_owned();
        for part in parts {
            assert!(words.contains(part), "no `{part}` in\n{words}");
        }
    }
}

#[test]
fn what_a_joint_makes_is_offered() {
    let mut editor = Editor::with(ARM);
    let mut labels = |needle: &str, letters: usize| -> Vec<String> {
        let items = told(&mut editor, "completion", needle, letters, json!({}));
        let items = items.as_array().expect("items").iter();
        items
            .filter_map(|item| item["label"].as_str().map(str::to_owned))
            .collect()
    };
    assert_eq!(labels("coordinate = \"", 14), ["q_slide", "q_arm"]);
    assert_eq!(labels("parent = \"", 10), ["ground", "slide"]);
    assert_eq!(labels("centre = \"", 10), ["O", "G", "slide", "arm"]);
    assert!(labels("axis = \"", 8).is_empty());
    let place = labels("\"l/2\"", 1);
    let has = |wanted: &str| place.iter().any(|label| label == wanted);
    assert!(has("l") && has("q_slide") && !has("v"), "{place:?}");
    assert!(labels("\"l\", \"l\"", 1).iter().any(|label| label == "l"));
}

#[test]
fn names_after_a_joint_change_with_it() {
    let mut editor = Editor::with(ARM);
    let rename = |editor: &mut Editor, needle: &str, letters: usize| {
        let at = (ARM, needle, letters);
        editor.ask_at("textDocument/rename", at, json!({ "newName": "boom" }))
    };
    let edits = rename(&mut editor, "arm   = {", 1).expect("edits");
    let edits = edits["documentChanges"][0]["edits"]
        .as_array()
        .expect("edits");
    let words = edits
        .iter()
        .map(|edit| edit["newText"].as_str().unwrap_or_default());
    let words: Vec<&str> = words.collect();
    assert_eq!(words, ["boom", "boom", "boom", "boom", "boom", "q_boom"]);
    let told = rename(&mut editor, "\"q_arm\"", 2).expect_err("a refusal");
    assert!(told.contains("named after the joint `arm`"), "{told}");
}
