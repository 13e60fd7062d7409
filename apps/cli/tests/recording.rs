//! `appell recording` tells what recordings hold, and refuses what cannot be read.

use std::fmt::Write as _;

use crate::support::{self, Folder};

const DESCRIPTION: &str = r#"
mechanism   = "pendulum"
description = "bench rig"
[parameters]
m = { value = 1.2, unit = "kg", std = 0.05 }
[channels]
theta = { measures = "theta", unit = "deg", noise_std = 0.1 }
tau   = { input = "tau", unit = "N m" }
[runs]
fit  = ["a.csv"]
test = ["b.csv"]
"#;

/// A swing in degrees, 100 Hz, seen by an encoder with steps of a tenth.
fn swing(rows: usize) -> String {
    let mut text = "t,theta,tau\n".to_owned();
    for i in 0..rows {
        let t = i as f64 / 100.0;
        let theta = (300.0 * (3.0 * t).sin()).round() / 10.0;
        let _ = writeln!(text, "{t},{theta},{}", i % 2);
    }
    text
}

#[test]
fn a_data_set_is_summed_up_for_people_and_for_programs() {
    let folder = Folder::new();
    folder.write("recording.toml", DESCRIPTION);
    folder.write("a.csv", &swing(500));
    folder.write("b.csv", &swing(300).replacen("\n0.5,", "\n0.49,", 1));
    let outcome = folder.done(&["recording", ".", "--json", "summary.json"]);
    for expected in [
        "bench rig",
        "measured theta",
        "input tau",
        "values in steps of 0.1 deg",
        "the stated noise is 0.1 deg",
        "b.csv:52: the time stands still: 1 row of 300 left out",
    ] {
        assert!(outcome.stdout.contains(expected), "{}", outcome.stdout);
    }
    let json = folder.json("summary.json");
    assert_eq!(json["runs"][0]["rows"], 500);
    assert_eq!(json["runs"][1]["part"], "test");
    let quantum = json["channels"][0]["quantum"].as_f64().expect("a step");
    assert!((quantum.to_degrees() - 0.1).abs() < 1e-3, "{quantum}");
    assert_eq!(json["parameters"][0]["std"], 0.05);
    let kinds: Vec<&str> = json["findings"]
        .as_array()
        .expect("findings")
        .iter()
        .filter_map(|finding| finding["kind"].as_str())
        .collect();
    assert_eq!(kinds, ["noise-disagrees", "quantised", "repeated-time"]);
}

#[test]
fn the_description_in_the_manual_is_one() {
    let folder = Folder::new();
    let path = support::repository("docs/command-line.md");
    let manual = std::fs::read_to_string(path).expect("the manual");
    let block = manual
        .split("```toml recording\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("a description in the manual");
    folder.write("recording.toml", block);
    let recording = swing(300)
        .replace('\n', ",290\n")
        .replace("tau,290", "tau,room");
    for name in ["run1.csv", "run2.csv", "run3.csv"] {
        folder.write(name, &recording);
    }
    let outcome = folder.done(&["recording", "."]);
    assert!(
        outcome.stdout.contains("not in the model"),
        "{}",
        outcome.stdout
    );
}

#[test]
fn csv_files_alone_need_a_model() {
    let folder = Folder::new();
    folder.write("a.csv", &swing(900));
    folder.fails(2, &["recording", "a.csv"], &["need the mechanism"]);
    let outcome = folder.done(&["recording", "a.csv", "--model", "pendulum"]);
    assert!(
        outcome.stdout.contains("held out from"),
        "{}",
        outcome.stdout
    );
    folder.fails(2, &["recording", ".", "a.csv"], &["give one data set"]);
}

#[test]
fn what_cannot_be_read_is_told_with_its_place() {
    let folder = Folder::new();
    folder.fails(3, &["recording", "."], &["holds no recording.toml"]);
    folder.write("recording.toml", &DESCRIPTION.replace("deg", "dog"));
    folder.fails(
        3,
        &["recording", "."],
        &["error[unknown-unit]", "recording.toml:7"],
    );
    folder.write("recording.toml", DESCRIPTION);
    folder.write("a.csv", &swing(100).replacen(",0\n", ",off\n", 2));
    folder.write("b.csv", "t,theta\n");
    folder.fails(
        3,
        &["recording", "."],
        &[
            "a.csv:2:",
            "`off` is not a finite number",
            "b.csv:1:1",
            "no column `tau`",
        ],
    );
}

#[test]
fn a_recorded_run_drives_a_simulation_by_the_names_and_units_of_its_description() {
    let folder = Folder::new();
    let description = DESCRIPTION
        .replace("tau   = {", "motor = {")
        .replace("unit = \"N m\"", "unit = \"N mm\"");
    folder.write("recording.toml", &description);
    let run = |torque: i32| {
        let rows = (0..200).map(|i| format!("{},0,{}", f64::from(i) / 100.0, i % 2 * torque));
        rows.collect::<Vec<_>>().join("\n") + "\n"
    };
    folder.write("a.csv", &format!("t,theta,motor\n{}", run(0)));
    folder.write("b.csv", &format!("t,theta,motor\n{}", run(500)));
    folder.write(
        "plain.csv",
        &format!("t,theta,tau\n{}", run(500)).replace(",500", ",0.5"),
    );
    let end = |inputs: &str| {
        let base = [
            "simulate",
            "pendulum",
            "--t-end-s",
            "2",
            "--json",
            "end.json",
        ];
        folder.done(&[&base[..], &["--inputs", inputs]].concat());
        folder.json("end.json")["final_state"].clone()
    };
    let moved = end("recording.toml:b.csv");
    assert_eq!(moved, end("plain.csv"));
    assert_ne!(moved, end("recording.toml:a.csv"));
    for inputs in ["recording.toml", "recording.toml:c.csv"] {
        let asked = ["simulate", "pendulum", "--inputs", inputs];
        folder.fails(2, &asked, &["append one of a.csv, b.csv"]);
    }
}

/// A pendulum that falls from two radians, 100 Hz.
fn fall(rows: usize, start: f64) -> String {
    let (mut theta, mut omega) = (start, 0.0);
    let mut text = "t,theta,omega\n".to_owned();
    for i in 0..rows {
        let _ = writeln!(text, "{},{theta:.6},{omega:.6}", i as f64 / 100.0);
        for _ in 0..100 {
            // I + m l² = 4/3 m l² of the shipped rod.
            omega -= 1e-4 * 9.81 * 0.25 / (0.25 * 0.25 * 4.0 / 3.0) * f64::sin(theta);
            theta += 1e-4 * omega;
        }
    }
    text
}

const FALL: &str = r#"
mechanism   = "pendulum"
[parameters]
m = { value = 1, unit = "kg", std = 0.02 }
l = { value = 0.25, unit = "m", std = 0 }
I = { value = 0.0208333333, unit = "kg m^2", std = 0 }
g = { value = 9.81, unit = "m/s^2", std = 0 }
[channels]
theta = { measures = "theta", unit = "rad", noise_std = 1e-4 }
omega = { measures = "omega", unit = "rad/s", noise_std = 1e-4 }
[runs]
fit  = ["a.csv"]
test = ["b.csv"]
"#;

/// The unit finding of a description.
fn doubted(folder: &Folder, description: &str) -> Vec<(String, String)> {
    folder.write("recording.toml", description);
    folder.done(&["recording", ".", "--json", "summary.json"]);
    let json = folder.json("summary.json");
    let findings = json["findings"].as_array().expect("findings").clone();
    let units = findings.iter().filter(|finding| finding["kind"] == "unit");
    let text = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    units
        .map(|finding| (text(&finding["channel"]), text(&finding["message"])))
        .collect()
}

#[test]
fn a_unit_that_the_motion_contradicts_is_told_and_refused_until_it_is_vouched_for() {
    let folder = Folder::new();
    folder.write("a.csv", &fall(600, 2.0));
    folder.write("b.csv", &fall(400, 1.5));
    assert!(doubted(&folder, FALL).is_empty());
    // Angle and rate disagree, and the equations tell which of them is wrong.
    for (right, wrong) in [("\"rad\"", "\"deg\""), ("\"rad/s\"", "\"deg/s\"")] {
        let description = FALL.replace(right, wrong);
        let units = doubted(&folder, &description);
        assert_eq!(units.len(), 1, "{units:?}");
        let place = if wrong.contains("/s") {
            "10:38"
        } else {
            "9:38"
        };
        let write = format!("write unit = {right} at ./recording.toml:{place}");
        assert!(units[0].1.contains(&write), "{units:?}");
        let place = format!("recording.toml:{place}: ");
        for command in [&["diagnose"][..], &["identify", "pendulum"][..]] {
            let command = [command, &["--data", "."]].concat();
            folder.fails(3, &command, &[&place, "unit_checked = true"]);
        }
        let checked = description.replace(", noise_std", ", unit_checked = true, noise_std");
        assert!(doubted(&folder, &checked).is_empty());
    }
}

/// A carriage whose motion follows its command after 30 ms.
fn carriage(rows: usize, phase: f64) -> String {
    let place = |t: f64| 0.3 * (3.0 * t + phase).sin();
    let mut text = "time,x,x_vel,servo\n".to_owned();
    for row in 0..rows {
        let t = row as f64 / 200.0;
        let noise = 1e-5 * ((row * row) as f64).sin();
        let rate = 0.9 * (3.0 * t + phase).cos();
        let _ = writeln!(
            text,
            "{t},{:.6},{rate:.6},{:.6}",
            place(t) + noise,
            place(t + 0.03)
        );
    }
    text
}

const ROBOT: &str = r#"<mujoco model="carriage">
  <worldbody>
    <body name="cart">
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <joint name="x" type="slide" axis="1 0 0" damping="2"/>
    </body>
  </worldbody>
  <actuator>
    <position name="servo" joint="x" kp="400" kv="40"/>
  </actuator>
</mujoco>
"#;

#[test]
fn a_description_is_drafted_once_and_accepted() {
    let folder = Folder::new();
    folder.write("robot.xml", ROBOT);
    for (name, phase) in [("a.csv", 0.0), ("b.csv", 1.0), ("c.csv", 2.0)] {
        folder.write(name, &carriage(1500, phase));
    }
    let asked = [
        "recording",
        "robot.xml",
        "a.csv",
        "b.csv",
        "c.csv",
        "--write",
        "recording.toml",
    ];
    let told = folder.done(&asked).stdout;
    assert!(told.contains("wrote recording.toml"), "{told}");
    assert!(told.contains("no questions"), "{told}");
    let text = std::fs::read_to_string(folder.path("recording.toml")).expect("the draft");
    for expected in [
        "mechanism   = \"robot.xml\"",
        "x = { measures = \"x\", unit = \"m\", noise_std = ",
        "x_vel = { measures = \"x.velocity\", unit = \"m/s\"",
        "servo = { input = \"servo\", unit = \"m\" }  # position follows after 30 ms",
        "\"*.mass\" = { std = \"3 %\" }",
        "test = [\"c.csv\"]",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    folder.done(&["recording", "."]);
    folder.done(&["identify", "--data", "."]);
    // What is there stays.
    folder.write("recording.toml", "mine");
    folder.fails(2, &asked, &["recording.toml` exists already", "--force"]);
    folder.done(&[&asked[..], &["--force"]].concat());
    folder.write("spec.toml", "mine");
    let onto = [
        "recording",
        "spec.toml",
        "a.csv",
        "--force",
        "--write",
        "spec.toml",
    ];
    folder.fails(2, &onto, &["`spec.toml` is what the draft is made from"]);
    folder.fails(
        2,
        &["recording", "robot.xml", "--write", "r.toml"],
        &["and its recordings"],
    );
    let outside = [
        "recording",
        "robot.xml",
        "a.csv",
        "--write",
        "nowhere/r.toml",
    ];
    folder.fails(2, &outside, &["there is no folder or file"]);
    let printed = folder.done(&["recording", "robot.xml", "a.csv", "--write", "-"]);
    assert!(
        printed.stdout.starts_with("# Drafted"),
        "{}",
        printed.stdout
    );
}

#[test]
fn a_description_of_a_spec_is_drafted() {
    let folder = Folder::new();
    folder.write("a.csv", &fall(600, 2.0));
    folder.write("b.csv", &fall(400, 1.5));
    let asked = [
        "recording",
        "pendulum",
        "a.csv",
        "b.csv",
        "--write",
        "recording.toml",
    ];
    let told = folder.done(&asked).stdout;
    assert!(told.contains("no column is the command `tau`"), "{told}");
    let text = std::fs::read_to_string(folder.path("recording.toml")).expect("the draft");
    assert!(
        text.contains("omega = { measures = \"omega\", unit = \"rad/s\""),
        "{text}"
    );
    folder.done(&["recording", "."]);
}
