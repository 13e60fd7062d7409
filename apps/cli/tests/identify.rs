//! `appell identify` finds what a simulated rig was made with, and says what it does not know.

use std::fmt::Write as _;

use appell_test_kit::Random;

use crate::support::Folder;

const DESCRIPTION: &str = r#"
mechanism   = "pendulum"
description = "simulated rig"
[parameters]
m = { value = 1.0,  unit = "kg",     std = 0 }
l = { value = 0.5,  unit = "m",      std = 0.05 }
I = { value = 0.02, unit = "kg m^2", std = 0.01 }
[channels]
theta = { measures = "theta", unit = "deg", noise_std = 0.1 }
tau   = { input = "tau", unit = "N m" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

/// The columns of a CSV file of `simulate`, by their names.
fn simulated(folder: &Folder, file: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let text = folder.read(file);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let heading: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect()
        })
        .collect();
    let column = |name: &&str| {
        let is_named = |own: &&str| own.split_whitespace().next() == Some(name);
        let index = heading.iter().position(is_named).expect("a column");
        rows.iter().map(|row| row[index]).collect()
    };
    names.iter().map(column).collect()
}

/// A pendulum of l = 0.53 m and I = 0.03 kg m², driven by held torques, seen with noise of 0.1°.
fn rig(folder: &Folder, name: &str, start: &str, noise: &mut Random) {
    let initial = format!("theta={start}");
    let mut inputs = "t,tau\n".to_owned();
    for row in 0..=800 {
        let t = f64::from(row) / 100.0;
        let _ = writeln!(inputs, "{t},{}", 0.8 * (2.0 * t).sin());
    }
    folder.write("inputs.csv", &inputs);
    let set = ["--set", "m=1", "--set", "l=0.53", "--set", "I=0.03"];
    let start = ["--initial", &initial, "--initial", "omega=0"];
    let run = [
        "--inputs",
        "inputs.csv",
        "--t-end-s",
        "8",
        "--dt-s",
        "0.01",
        "--csv",
        "exact.csv",
    ];
    folder.done(&[&["simulate", "pendulum"], &set[..], &start, &run].concat());
    let columns = simulated(folder, "exact.csv", &["t", "theta", "tau"]);
    let mut text = "t,theta,tau\n".to_owned();
    for (row, t) in columns[0].iter().enumerate() {
        let seen = columns[1][row].to_degrees() + 0.1 * noise.normal();
        let _ = writeln!(text, "{t},{seen},{}", columns[2][row]);
    }
    folder.write(name, &text);
}

fn data_set() -> Folder {
    let folder = Folder::new();
    folder.write("recording.toml", DESCRIPTION);
    let mut noise = Random::new(1);
    for (name, start) in [("a.csv", "1.2"), ("b.csv", "-0.6"), ("c.csv", "2.0")] {
        rig(&folder, name, start, &mut noise);
    }
    folder
}

#[test]
fn parameters_of_a_rig_lie_in_their_intervals_and_predict_what_was_held_out() {
    let folder = data_set();
    let outcome = folder.done(&[
        "identify",
        "pendulum",
        "--data",
        ".",
        "--json",
        "found.json",
        "--plot",
        "found.svg",
        "--html",
        "found.html",
    ]);
    for expected in ["95 % intervals", "fitted model", "free run"] {
        assert!(outcome.stdout.contains(expected), "{}", outcome.stdout);
    }
    let found = folder.json("found.json");
    for (place, name, truth, tolerance) in [(0, "l", 0.53, 0.05), (1, "I", 0.03, 0.01)] {
        let parameter = &found["parameters"][place];
        assert_eq!(parameter["name"], name);
        let number = |key: &str| parameter[key].as_f64().expect("a number");
        let (value, std) = (number("value"), number("std").max(number("robust_std")));
        assert!(
            (value - truth).abs() < 3.0 * std,
            "{name} = {value} ± {std}"
        );
        assert!(std < 0.3 * tolerance, "{name} = {value} ± {std}");
    }
    let noise = found["noise"][0]["fitted"].as_f64().expect("a level");
    assert!((noise.to_degrees() - 0.1).abs() < 0.01, "{noise}");
    let held_out = found["held_out"].as_array().expect("errors");
    let ahead = held_out
        .iter()
        .find(|error| error["horizon_s"] == 1.0 && error["channel"].is_null())
        .expect("a second ahead");
    let error = |key: &str| ahead[key].as_f64().expect("an error");
    assert!(error("fitted") < 1.5, "{ahead}");
    assert!(error("nominal") > 2.0 * error("fitted"), "{ahead}");
    assert!(folder.read("found.svg").starts_with("<svg"));
    let page = folder.read("found.html");
    assert!(page.contains("<svg") && !page.contains("http://") || page.contains("www.w3.org"));
}

#[test]
fn what_cannot_be_identified_is_refused_with_what_to_write_instead() {
    let folder = data_set();
    let outcome = folder.run(&["identify", "pendulum", "--data", ".", "--free", "length"]);
    assert_eq!(outcome.status, 2, "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("no parameter `length`"),
        "{}",
        outcome.stderr
    );
    let known = DESCRIPTION
        .replace("std = 0.05", "std = 0")
        .replace("std = 0.01", "std = 0");
    folder.write("recording.toml", &known);
    let outcome = folder.run(&["identify", "pendulum", "--data", "."]);
    assert_eq!(outcome.status, 3, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("--free"), "{}", outcome.stderr);
}

/// Rows by which the torque acts later than it was commanded.
const LATE: usize = 5;

#[test]
fn a_command_that_acts_late_is_found_where_it_is_looked_for() {
    let folder = data_set();
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(name);
        let rows: Vec<Vec<&str>> = text.lines().map(|row| row.split(',').collect()).collect();
        let mut late = "t,theta,tau\n".to_owned();
        for (now, then) in rows[1..].iter().zip(&rows[1 + LATE..]) {
            let _ = writeln!(late, "{},{},{}", now[0], now[1], then[2]);
        }
        folder.write(name, &late);
    }
    folder.done(&[
        "identify",
        "pendulum",
        "--data",
        ".",
        "--also",
        "tau.delay",
        "--json",
        "found.json",
    ]);
    let delay = &folder.json("found.json")["parameters"][2];
    assert_eq!(delay["name"], "tau.delay");
    let value = delay["value"].as_f64().expect("a number");
    assert!((value - 0.05).abs() < 0.01, "{delay}");
    let outcome = folder.run(&["identify", "pendulum", "--data", ".", "--also", "tau.late"]);
    assert_eq!(outcome.status, 2, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("tau.delay"), "{}", outcome.stderr);
}

#[test]
fn shooting_begins_where_the_rig_is_far_from_its_drawing() {
    let folder = data_set();
    let far = DESCRIPTION
        .replace(
            "0.5,  unit = \"m\",      std = 0.05",
            "0.7, unit = \"m\", std = 0.5",
        )
        .replace(
            "0.02, unit = \"kg m^2\", std = 0.01",
            "0.02, unit = \"kg m^2\", std = 0.1",
        );
    folder.write("recording.toml", &far);
    let run = [
        "identify",
        "pendulum",
        "--data",
        ".",
        "--json",
        "found.json",
    ];
    folder.done(&[&run[..], &["--start", "shooting"]].concat());
    let found = folder.json("found.json");
    for (place, truth) in [(0, 0.53), (1, 0.03)] {
        let number = |key: &str| found["parameters"][place][key].as_f64().expect("a number");
        let std = number("std").max(number("robust_std"));
        assert!((number("value") - truth).abs() < 3.0 * std, "{found}");
    }
}

#[test]
fn a_parameter_that_changes_on_the_way_is_followed() {
    let folder = data_set();
    let run = [
        "identify",
        "pendulum",
        "--data",
        ".",
        "--json",
        "found.json",
    ];
    folder.done(&[&run[..], &["--drifting", "l=0.001"]].concat());
    let found = folder.json("found.json");
    assert_eq!(found["parameters"].as_array().expect("a list").len(), 1);
    let courses = found["drifting"].as_array().expect("courses");
    assert_eq!(courses.len(), 2);
    for course in courses {
        let last = |key: &str| {
            let all = course[key].as_array().expect("numbers");
            all.last()
                .and_then(serde_json::Value::as_f64)
                .expect("a number")
        };
        let (value, std) = (last("value"), last("std"));
        assert!(
            std < 0.01 && (value - 0.53).abs() < 4.0 * std,
            "{value} ± {std}"
        );
    }
    let outcome = folder.run(&["identify", "pendulum", "--data", ".", "--drifting", "l=0"]);
    assert_eq!(outcome.status, 2, "{}", outcome.stderr);
}

/// A swing whose rate is read by a gyroscope with an offset; I and the offset are stated at several times their sizes.
const SWING: &str = r#"
[mechanism]
name  = "swing"
title = "A swing read by a rate gyroscope"
[parameters]
m = { value = 2,    unit = "kg" }
l = { value = 0.3,  unit = "m" }
I = { value = 0.18, unit = "kg m^2", at_least = 0 }
c = { value = 0.02, unit = "N m s",  at_least = 0 }
o = { value = 1.4,  unit = "rad/s" }
[coordinates]
theta = { unit = "rad", initial = 0.3 }
[frames]
fork = { parent = "ground", about_axis = "-y", by = "theta" }
[points]
G = { from = "O", in = "fork", at = [0, 0, "-l"] }
[bodies]
fork = { frame = "fork", centre = "G", mass = "m", inertia = { in = "fork", diagonal = ["I", "I", "I"] } }
[pseudo_velocities]
omega = "dot(theta)"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
air    = { kind = "damper", coordinate = "theta", damping = "c" }
[outputs]
gyro = { value = "o + omega", unit = "rad/s" }
"#;

const SWING_DESCRIPTION: &str = r#"
mechanism   = "swing.toml"
description = "free swing"
[parameters]
I = { value = 0.1, unit = "kg m^2", std = 0.1 }
c = { value = 0.001, unit = "N m s", std = 0.05 }
o = { value = 2.4, unit = "rad/s", std = 2 }
[channels]
gyro = { measures = "gyro", unit = "rad/s" }
[runs]
fit = ["a.csv"]
"#;

/// Whether all parameters lie near the truth.
fn assert_near(found: &serde_json::Value, truth: &[(&str, f64)], relative: f64) {
    for (place, (name, truth)) in truth.iter().enumerate() {
        let parameter = &found["parameters"][place];
        assert_eq!(parameter["name"], *name);
        let value = parameter["value"].as_f64().expect("a number");
        assert!(
            (value / truth - 1.0).abs() < relative,
            "{name}: {parameter}"
        );
    }
}

#[test]
fn a_swing_is_identified_by_its_rate_alone_from_a_wrong_offset() {
    let folder = Folder::new();
    folder.write("swing.toml", SWING);
    folder.write("recording.toml", SWING_DESCRIPTION);
    let run = ["--t-end-s", "12", "--dt-s", "0.01", "--csv", "exact.csv"];
    folder.done(&[&["simulate", "swing.toml"], &run[..]].concat());
    let columns = simulated(&folder, "exact.csv", &["t", "gyro"]);
    let mut noise = Random::new(4);
    let mut text = "t,gyro\n".to_owned();
    for (t, rate) in columns[0].iter().zip(&columns[1]) {
        let _ = writeln!(text, "{t},{}", rate + 0.01 * noise.normal());
    }
    folder.write("a.csv", &text);
    for start in ["nominal", "shooting"] {
        let run = [
            "identify",
            "swing.toml",
            "--data",
            ".",
            "--json",
            "found.json",
        ];
        folder.done(&[&run[..], &["--start", start]].concat());
        let found = folder.json("found.json");
        assert_eq!(found["is_optimum"], true, "{start}");
        // Some standard deviations.
        assert_near(&found, &[("I", 0.18), ("c", 0.02), ("o", 1.4)], 0.05);
    }
}

/// Time constant of a lag in s, and its steps per row.
const LAG: f64 = 0.05;
const FINE: u32 = 10;

#[test]
fn a_lag_that_begins_away_from_its_input_is_found() {
    let folder = Folder::new();
    folder.write("recording.toml", DESCRIPTION);
    let mut noise = Random::new(2);
    for (name, phase) in [("a.csv", 1.0), ("b.csv", 2.0), ("c.csv", -1.5)] {
        let command = |row: u32| 0.8 * (2.0 * f64::from(row) / 100.0 + phase).sin();
        let (mut torque, part) = (0.0, (-0.01 / (LAG * f64::from(FINE))).exp());
        let mut inputs = "t,tau\n".to_owned();
        for step in 0..=400 * FINE {
            let next = command(step / FINE) * (1.0 - part) + torque * part;
            let t = f64::from(step) / f64::from(100 * FINE);
            let _ = writeln!(inputs, "{t},{}", 0.5 * (torque + next));
            torque = next;
        }
        folder.write("inputs.csv", &inputs);
        let set = ["--set", "m=1", "--set", "l=0.53", "--set", "I=0.03"];
        let run = ["--inputs", "inputs.csv", "--t-end-s", "4", "--dt-s", "0.01"];
        let to = ["--csv", "exact.csv"];
        folder.done(&[&["simulate", "pendulum"], &set[..], &run, &to].concat());
        let mut text = "t,theta,tau\n".to_owned();
        let columns = simulated(&folder, "exact.csv", &["t", "theta"]);
        for (row, (t, theta)) in (0_u32..).zip(columns[0].iter().zip(&columns[1])) {
            let seen = theta.to_degrees() + 0.1 * noise.normal();
            let _ = writeln!(text, "{t},{seen},{}", command(row));
        }
        folder.write(name, &text);
    }
    let run = [
        "identify",
        "pendulum",
        "--data",
        ".",
        "--json",
        "found.json",
    ];
    folder.done(&[&run[..], &["--also", "tau.lag"]].concat());
    let found = folder.json("found.json");
    assert_near(&found, &[("l", 0.53), ("I", 0.03), ("tau.lag", LAG)], 0.1);
    // Nothing disturbs this rig: what noise leaves.
    let level = found["disturbances"][0]["fitted"]
        .as_f64()
        .expect("a level");
    assert!(level < 1e-3, "{level}");
}

#[test]
fn what_misses_held_out_runs_is_said_before_its_intervals() {
    let folder = data_set();
    let text = folder.read("c.csv");
    let (heading, rows) = text.split_once('\n').expect("rows");
    let mut mirrored = format!("{heading}\n");
    for row in rows.lines() {
        let cells: Vec<&str> = row.split(',').collect();
        let theta: f64 = cells[1].parse().expect("a number");
        let _ = writeln!(mirrored, "{},{},{}", cells[0], -0.3 * theta, cells[2]);
    }
    folder.write("c.csv", &mirrored);
    let outcome = folder.done(&[
        "identify",
        "pendulum",
        "--data",
        ".",
        "--html",
        "found.html",
    ]);
    for text in [outcome.stdout, folder.read("found.html")] {
        let (first, _) = text.split_once("95 % intervals").expect("intervals");
        assert!(first.contains("misses the held-out runs"), "{first}");
    }
}
