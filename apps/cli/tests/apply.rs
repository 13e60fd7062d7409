//! `appell apply` closes the gap in the user's own spec.

use crate::rig::{self, closed};
use crate::support::{Folder, number, repository};

/// A rig with dry friction, the user's own spec of it, and the gap report.
fn diagnosed() -> Folder {
    let folder = rig::dry(0.4);
    folder.write("rig.toml", &own_spec());
    let asked = [
        "diagnose",
        "rig.toml",
        "--data",
        ".",
        "--json",
        "report.json",
    ];
    folder.done(&asked);
    folder
}

/// A spec with a comment and a layout of its own.
fn own_spec() -> String {
    let path = repository("generated/mechanisms/carriage.toml");
    let shipped = std::fs::read_to_string(path).expect("a shipped spec");
    let commented = shipped.replace("[inputs]\n", "[inputs]   # by a load cell\n");
    assert_ne!(commented, shipped);
    commented
}

#[test]
fn the_improved_spec_checks_and_has_no_gap() {
    let folder = diagnosed();
    let apply = [
        "apply",
        "rig.toml",
        "--report",
        "report.json",
        "-o",
        "new.toml",
    ];
    let told = folder.done(&apply).stdout;
    assert!(told.contains("coulomb_friction@x.force = 0.4"), "{told}");
    assert!(told.contains("changed   m = "), "{told}");
    // What is printed can stand in the description of the recordings as it is.
    let (_, block) = told.split_once("\n[parameters]\n").expect("a block");
    let value = block.strip_prefix("m = { value = ").expect("the mass");
    let value: f64 = value
        .split(',')
        .next()
        .and_then(|v| v.parse().ok())
        .expect("a number");
    assert!((value - 1.0).abs() < 0.02, "{told}");
    assert!(block.contains(", unit = \"kg\", std = 0.0"), "{told}");
    let description = folder.read("recording.toml");
    let (before, rest) = description.split_once("[parameters]\n").expect("one");
    let (_, after) = rest.split_once("[channels]").expect("another");
    let pasted = format!("{before}[parameters]\n{block}[channels]{after}");
    folder.write("recording.toml", &pasted);
    folder.done(&["recording", "."]);
    folder.write("recording.toml", &description);
    let text = folder.read("new.toml");
    let lines: Vec<&str> = text.lines().collect();
    for line in own_spec().lines() {
        // The mass is the one line that changes.
        let is_there = lines.contains(&line) || line.starts_with("m = ");
        assert!(is_there, "`{line}` is missing in\n{text}");
    }
    assert!(
        text.contains("# Found by `appell diagnose`: coulomb_friction@x"),
        "{text}"
    );
    folder.done(&["check", "new.toml"]);
    let again = closed(&folder, "new.toml");
    // The held-out error of the new spec, re-fitted or not, is that of the model with the effect.
    let before = number(&folder.json("report.json"), "how_far/with_effect");
    let after = number(&again, "how_far/nominal");
    assert!(after < 1.2 * before, "{after} after {before}");
}

#[test]
fn a_spec_that_has_the_effect_is_left_alone() {
    let folder = diagnosed();
    let apply = |model| ["apply", model, "--report", "report.json", "-o", "new.toml"];
    folder.done(&apply("rig.toml"));
    folder.fails(3, &apply("new.toml"), &["it holds this effect"]);
}

#[test]
fn a_file_of_the_user_is_not_replaced_unless_it_is_named() {
    let folder = diagnosed();
    let own = "carriage_improved.toml";
    let apply = ["apply", "rig.toml", "--report", "report.json"];
    folder.done(&apply);
    let improved = folder.read(own);
    folder.done(&apply);
    folder.write(own, &format!("{improved}# mine\n"));
    folder.fails(2, &apply, &[own, "-o"]);
    assert!(folder.read(own).ends_with("# mine\n"));
    folder.done(&[&apply[..], &["-o", own]].concat());
    assert_eq!(folder.read(own), improved);
}

#[test]
fn what_no_spec_can_hold_is_told_with_its_place() {
    let folder = Folder::new();
    let report = r#"{
        "schema": "gap-report/1", "mechanism": "carriage", "tied": [["actuator_lag@F", "actuator_delay@F"]],
        "which": [{
            "effects": ["actuator_lag@F"], "probability": 0.9,
            "parameters": [{ "name": "actuator_lag@F.time_constant", "value": 0.05, "std": 0.01, "unit": "s" }],
            "changes": { "items": "", "inputs": [], "parameters": [],
                         "beside": [{ "effect": "actuator_lag@F", "acts": "lag", "on": "F" }] }
        }, { "effects": ["unknown"], "probability": 0.1 }]
    }"#;
    folder.write("report.json", report);
    let apply = ["apply", "carriage", "--report", "report.json"];
    let told = folder.done(&apply).stdout;
    let place = "put the filter between controller and model";
    for text in [
        place,
        "0.0500000 ± 0.0100000 s",
        "tied with actuator_delay@F",
    ] {
        assert!(told.contains(text), "`{text}` is missing in\n{told}");
    }
    assert_eq!(
        folder.files(),
        ["report.json"],
        "the spec would be the same"
    );
    let second = [&apply[..], &["--hypothesis", "2"]].concat();
    folder.fails(
        2,
        &second,
        &[
            "no effect of the library explains",
            "1   90.0 %  actuator_lag@F",
        ],
    );
    let ninth = [&apply[..], &["--hypothesis", "9"]].concat();
    folder.fails(2, &ninth, &["there is no hypothesis 9: the report has 2"]);
}

#[test]
fn what_is_no_report_of_this_spec_is_bad_data() {
    let folder = Folder::new();
    let apply = |model| ["apply", model, "--report", "report.json", "-o", "-"];
    folder.write("report.json", "{}");
    folder.fails(
        3,
        &apply("carriage"),
        &["this is not a gap report", "schema"],
    );
    folder.write(
        "report.json",
        r#"{ "schema": "gap-report/9", "mechanism": "", "which": [] }"#,
    );
    folder.fails(
        3,
        &apply("carriage"),
        &["unsupported schema `gap-report/9`"],
    );
    folder.write(
        "report.json",
        r#"{ "schema": "gap-report/1", "mechanism": "pendulum", "which": [] }"#,
    );
    folder.fails(
        3,
        &apply("carriage"),
        &["about `pendulum`, but the spec describes `carriage`"],
    );
}
