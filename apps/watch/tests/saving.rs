//! What the page is told when the spec is saved.

use serde_json::{Value, json};

use crate::client::{Served, shipped};

fn version(value: &Value) -> u64 {
    value["version"].as_u64().unwrap_or(0)
}

#[test]
fn a_spec_has_equations_drawing_and_sliders() {
    let served = Served::new(&shipped("unicycle"));
    let whole = |state: &Value| {
        ["model", "equations", "drawing"]
            .iter()
            .all(|part| !state[part].is_null())
    };
    let state = served.state(whole);
    assert_eq!(state["text"]["text"], shipped("unicycle"));
    assert_eq!(state["findings"]["broken"], false);
    assert!(
        state["drawing"]["svg"]
            .as_str()
            .expect("SVG")
            .starts_with("<svg")
    );
    let knobs = &state["model"]["knobs"];
    assert_eq!(knobs["parameters"][0]["name"], "m");
    assert_eq!(knobs["parameters"][0]["unit"], "kg");
    assert_eq!(knobs["parameters"][0]["low"], 0.0);
    let mut states = knobs["initial"].as_array().expect("states").iter();
    let tilt = states.find(|state| state["name"] == "theta");
    assert_eq!(tilt.expect("theta")["most"], 1.5);
    assert_eq!(knobs["inputs"][0]["name"], "u");
}

/// The lines of the spec that the equations depend on whose left-hand side is a letter.
fn lines_of(html: &str, left: &str) -> Vec<usize> {
    let rows = html.split("<mtr class=\"first\" data-lines=\"");
    let row = rows
        .skip(1)
        .find(|row| row.contains(left))
        .expect("an equation");
    let (lines, _) = row.split_once('"').expect("lines");
    lines
        .split(' ')
        .map(|line| line.parse().expect("a number"))
        .collect()
}

#[test]
fn an_equation_knows_the_lines_that_it_depends_on() {
    let text = shipped("unicycle");
    let served = Served::new(&text);
    let state = served.state(|state| !state["equations"].is_null());
    let motion = state["equations"]["sections"][0].as_str().expect("HTML");
    let line = |key: &str| 1 + text.lines().position(|l| l.starts_with(key)).expect(key);
    // The sliding mass: σ̇ depends on its body, its load and the input, and not on outputs.
    let found = lines_of(motion, "<mi>σ</mi>");
    for key in [
        "[bodies.slider]",
        "weight",
        "drive",
        "u =",
        "g ",
        "tilted",
        "sigma",
    ] {
        assert!(found.contains(&line(key)), "{key}: {found:?}");
    }
    assert!(!found.contains(&line("x_P")), "{found:?}");
    let wheel = line("[bodies.wheel]");
    assert_eq!(state["text"]["items"][wheel.to_string()], wheel + 5);
}

/// Every equation of the bicycle is one in letters of M, b and Π, whose entries are in the derivation.
#[test]
fn equations_in_letters_know_their_lines_as_well() {
    let text = shipped("bicycle");
    let served = Served::new(&text);
    let state = served.state(|state| !state["equations"].is_null());
    let motion = state["equations"]["sections"][0].as_str().expect("HTML");
    let rows = motion.matches("<mtr class=\"first\"").count();
    assert!(rows > 5, "{rows}");
    assert_eq!(
        motion.matches("<mtr class=\"first\" data-lines=").count(),
        rows
    );
    let line = |key: &str| 1 + text.lines().position(|l| l.starts_with(key)).expect(key);
    let found = lines_of(motion, "<mi>D</mi>");
    for key in ["m_B ", "rear_frame ", "B = "] {
        assert!(found.contains(&line(key)), "{key}: {found:?}");
    }
}

#[test]
fn the_derivation_is_written_for_whoever_reads_it() {
    let served = Served::new(&shipped("unicycle"));
    let mut events = served.events();
    let model = events.next("model", |_| true);
    assert!(served.get("state").json()["derivation"].is_null());
    assert_eq!(served.post("derivation", "").status, 202);
    let derivation = events.next("derivation", |_| true);
    assert_eq!(version(&derivation), version(&model));
    let sections = derivation["sections"].as_array().expect("sections");
    assert!(sections.len() > 8, "{}", sections.len());
    // One is enough for all windows.
    assert_eq!(served.post("derivation", "").status, 202);
    served.save(&shipped("pendulum"));
    events.next("model", |model| version(model) == 2);
    assert_eq!(version(&served.get("state").json()["derivation"]), 1);
}

#[test]
fn a_save_is_a_new_version() {
    let served = Served::new(&shipped("unicycle"));
    let mut events = served.events();
    let first = events.next("model", |_| true);
    let mut last = version(&first);
    for radius in [0.4, 0.5] {
        let changed = shipped("unicycle").replace("value = 0.3,", &format!("value = {radius},"));
        if radius < 0.45 {
            served.save(&changed);
        } else {
            served.replace(&changed);
        }
        let text = events.next("text", |text| text["text"] == changed);
        assert!(version(&text) > last);
        last = version(&text);
        let model = events.next("model", |model| version(model) == last);
        assert_eq!(model["knobs"]["parameters"][2]["value"], radius);
    }
}

#[test]
fn a_broken_spec_keeps_the_last_good_model() {
    let good = shipped("pendulum");
    let served = Served::new(&good);
    let state = served.state(|state| !state["equations"].is_null() && !state["model"].is_null());
    let kept = version(&state["model"]);
    let broken = good.replace("unit = \"kg\"", "unit = \"kq\"");
    assert_ne!(good, broken);
    served.save(&broken);
    let state = served.state(|state| state["findings"]["broken"] == true);
    assert_eq!(version(&state["model"]), kept);
    assert_eq!(version(&state["equations"]), kept);
    assert!(version(&state["text"]) > kept);
    let finding = &state["findings"]["list"][0];
    assert_eq!(finding["severity"], "error");
    assert_eq!(finding["code"], "unknown-unit");
    let line = broken
        .lines()
        .position(|line| line.contains("kq"))
        .expect("a line");
    let column = broken
        .lines()
        .nth(line)
        .expect("it")
        .find("kq")
        .expect("a column");
    let at = &finding["places"][0]["at"];
    assert_eq!(at[0][0], line + 1, "{finding}");
    assert!(
        at[0][1].as_u64().expect("a column") <= column as u64,
        "{finding}"
    );
    // Motions go on with the last good model.
    let motion = served.motion(&json!({ "window": 1, "end": 1 })).json();
    assert_eq!(version(&motion), kept);
    served.save(&good);
    let state = served.state(|state| state["findings"]["broken"] == false);
    assert!(version(&state["text"]) > kept);
}

#[test]
fn a_file_that_goes_away_is_told_and_comes_back() {
    let served = Served::new(&shipped("pendulum"));
    served.state(|state| !state["model"].is_null());
    served.save("\u{feff}\0");
    served.state(|state| state["findings"]["broken"] == true);
    served.replace(&shipped("cart_pole"));
    let text = shipped("cart_pole");
    let state =
        served.state(|state| state["findings"]["broken"] == false && state["text"]["text"] == text);
    assert!(version(&state["text"]) > 1);
}
