//! Play in a gear is found beside an exact simulation of one.

use appell_test_kit::is_full;
use serde_json::json;

use crate::rig::{self, geared, geared_behind_its_encoder};
use crate::support::{self, number};

const SHARE: f64 = 0.2;
const HALF_GAP: f64 = 6e-3;
/// Recordings tell how far the joint lags, the product of both, to some 4 %; four times as much is an event
/// of 1 in 16 000.
const NEAR: f64 = 0.16;

#[test]
fn play_is_found_with_its_size_and_its_spec_has_no_gap() {
    let folder = geared(SHARE, HALF_GAP);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    assert_eq!(top["effects"], json!(["backlash@x"]), "{report:#}");
    let value = |place: usize, name: &str| {
        let found = &top["parameters"][place];
        assert_eq!(found["name"], format!("backlash@x.{name}"));
        number(found, "value")
    };
    let lag = value(0, "half_gap") * value(1, "share");
    assert!((lag / (SHARE * HALF_GAP) - 1.0).abs() < NEAR, "{lag} m");
    assert_eq!(report["where"]["domain"], "constraint");
    assert_eq!(report["where"]["equations"][0]["name"], "v");
    let closed = number(&report, "how_far/closed_vs_refitted");
    assert!(closed > 0.9, "{closed}");
    if !is_full() {
        return;
    }

    let spec = support::repository("generated/mechanisms/carriage.toml");
    let spec = std::fs::read_to_string(spec).expect("a shipped spec");
    folder.write("rig.toml", &spec);
    let apply = [
        "apply",
        "rig.toml",
        "--report",
        "report.json",
        "-o",
        "new.toml",
    ];
    folder.done(&apply);
    let checked = folder.done(&["check", "new.toml"]);
    assert!(!checked.stderr.contains("warning"), "{}", checked.stderr);
    rig::closed(&folder, "new.toml");
}

#[test]
fn play_behind_the_encoder_is_found_and_what_the_encoder_shows_is_told() {
    let folder = geared_behind_its_encoder(SHARE, HALF_GAP);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    assert_eq!(top["effects"], json!(["backlash@x"]), "{report:#}");
    for (place, size) in [HALF_GAP, SHARE].into_iter().enumerate() {
        let found = &top["parameters"][place];
        let (value, std) = (number(found, "value"), number(found, "std"));
        // Teeth of the law are softer than those of the rig.
        assert!((value - size).abs() < 0.05 * size + 4.0 * std, "{found}");
    }
    let closed = number(&report, "how_far/closed_vs_refitted");
    assert!(closed > 0.9, "{closed}");
    let shows = &top["changes"]["beside"][0];
    assert_eq!(shows["acts"], "shows", "{top:#}");
    let output = shows["output"].as_str().expect("an output").to_owned();

    let spec = support::repository("generated/mechanisms/carriage.toml");
    let spec = std::fs::read_to_string(spec).expect("a shipped spec");
    folder.write("rig.toml", &spec);
    let apply = [
        "apply",
        "rig.toml",
        "--report",
        "report.json",
        "-o",
        "new.toml",
    ];
    let applied = folder.done(&apply);
    let told = format!("the channel x shows something else: write `measures = \"{output}\"`");
    assert!(applied.stdout.contains(&told), "{}", applied.stdout);
    let checked = folder.done(&["check", "new.toml"]);
    assert!(!checked.stderr.contains("warning"), "{}", checked.stderr);
}

#[test]
fn play_that_nobody_sees_is_none() {
    let folder = geared(SHARE, 1e-5);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    assert_eq!(folder.json("report.json")["verdict"], "no_gap");
}
