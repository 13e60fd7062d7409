//! What is published about a text, and when.

use serde_json::json;

use crate::editor::{CART, Editor, range};

#[test]
fn a_sound_spec_has_no_findings() {
    let mut editor = Editor::with(CART);
    assert!(editor.findings().is_empty());
    // Once more after the derivation.
    assert!(editor.findings().is_empty());
}

#[test]
fn an_error_is_told_at_its_place_with_its_code_and_help() {
    let text = CART.replace("𝛂\" }", "𝛂\", odd = 1 }");
    let mut editor = Editor::with(&text);
    let findings = editor.findings();
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!(findings[0]["code"], "unknown-key");
    assert_eq!(findings[0]["severity"], 1);
    assert_eq!(findings[0]["range"], range(&text, "odd"));
    let message = findings[0]["message"].as_str().expect("a message");
    assert!(message.contains("help: the keys are"), "{message}");
}

#[test]
fn further_places_of_a_finding_are_related_information() {
    let text = CART.replace("[inputs]\nu =", "[inputs]\nx = { unit = \"N\" }\nu =");
    let mut editor = Editor::with(&text);
    let findings = editor.findings();
    let related = &findings[0]["relatedInformation"][0];
    assert_eq!(related["message"], "first here");
    assert_eq!(
        related["location"]["range"],
        range(&text, "x   ")["start"]
            .clone()
            .as_object()
            .map_or(json!(null), |start| {
                json!({ "start": start, "end": { "line": start["line"], "character": 1 } })
            })
    );
}

#[test]
fn warnings_and_notes_of_the_equations_follow_the_derivation() {
    let text = CART.replace("stiffness = \"k\"", "stiffness = \"k + 0*g*M/l\"");
    let extra = "\n[inputs]\nidle = { unit = \"N\" }\n";
    let text = text.replace("\n[inputs]\n", extra);
    let mut editor = Editor::with(&text);
    assert_eq!(editor.codes(), ["unused-name"]);
    assert_eq!(editor.codes(), ["unused-name"]);
    let nothing = CART.replace(
        "vector = [\"u - 2[N*s/m]*velocity(B, x, rod)\", 0, 0]",
        "vector = [0, \"u\", 0]",
    );
    editor.change(&json!([{ "text": nothing }]));
    assert!(editor.findings().is_empty());
    let told = editor.findings();
    assert_eq!(told[0]["code"], "no-work");
    assert_eq!(told[0]["severity"], 2);
}

#[test]
fn parts_of_a_text_are_replaced_after_astral_letters() {
    let mut editor = Editor::with(CART);
    assert!(editor.findings().is_empty() && editor.findings().is_empty());
    // Two changes of one message, both behind `𝛂`.
    let mut place = range(CART, "\" }\nk =");
    place["end"] = place["start"].clone();
    editor.change(
        &json!([{ "range": place, "text": " and 𝛂" }, { "range": place, "text": "\" , oops = \"" }]),
    );
    assert_eq!(editor.codes(), ["unknown-key"]);
    let all =
        json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 9999, "character": 0 } });
    editor.change(&json!([{ "range": all, "text": CART }]));
    assert!(editor.findings().is_empty() && editor.findings().is_empty());
}

#[test]
fn other_files_have_no_findings() {
    for text in [
        "[package]\nname = \"a\"\n[dependencies]\n",
        "[effect]\nname = \"a\"\n[parameters]\nq = 1\n",
        "",
        "nothing = [",
    ] {
        let mut editor = Editor::with(text);
        assert!(editor.findings().is_empty(), "{text}");
    }
    let mut editor = Editor::with("[parametres]\n[coordinates]\n");
    assert!(editor.codes().contains(&"unknown-section".to_owned()));
}

#[test]
fn a_closed_file_has_no_findings() {
    let mut editor = Editor::with("[coordinates]\n");
    assert!(!editor.findings().is_empty());
    let document = json!({ "textDocument": { "uri": crate::editor::URI } });
    editor.tell("textDocument/didClose", document);
    assert!(editor.findings().is_empty());
}

#[test]
fn what_the_derivation_refuses_is_told() {
    let text = CART.replace(
        "omega = { value = \"dot(phi)\", unit = \"rad/s\", about = \"rate of the rod\" }",
        "",
    );
    let mut editor = Editor::with(&text);
    assert!(editor.findings().is_empty());
    assert_eq!(editor.codes(), ["missing-pseudo-velocities"]);
}
