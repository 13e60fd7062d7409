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
    let exact = folder.read("exact.csv");
    let mut lines = exact.lines().filter(|line| !line.starts_with('#'));
    let heading: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let column = |name: &str| {
        let mut columns = heading.iter();
        columns
            .position(|own| own.split_whitespace().next() == Some(name))
            .expect("a column")
    };
    let (t, theta, tau) = (column("t"), column("theta"), column("tau"));
    let mut text = "t,theta,tau\n".to_owned();
    for line in lines {
        let values: Vec<f64> = line
            .split(',')
            .map(|value| value.parse().expect("a number"))
            .collect();
        let seen = values[theta].to_degrees() + 0.1 * noise.normal();
        let _ = writeln!(text, "{},{seen},{}", values[t], values[tau]);
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
