//! Logs as people have them: times without a column, columns by patterns, counts of encoders, episodes, jumps.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;

use appell_recordings::{DataSet, FindingKind};

use crate::common::{Folder, SWING, pendulum, swing};

const ROUNDING: f64 = 1e-9;

/// A run with the same columns under other names, and other numbers in them.
fn mapped(header: &str, map: impl Fn(usize, [f64; 3]) -> Vec<String>) -> String {
    let mut text = header.to_owned() + "\n";
    for (row, line) in swing(300, 1, 1e-3).lines().skip(1).enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        writeln!(
            text,
            "{}",
            map(row, [cells[0], cells[1], cells[2]]).join(",")
        )
        .unwrap();
    }
    text
}

fn rig(channels: &str, run: &str) -> Folder {
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(channels, &["a.csv"], &[]));
    folder.write("a.csv", run);
    folder
}

/// Holds a data set against the same motion with plain columns.
fn assert_same(set: &DataSet, rounding: f64) {
    let plain = rig(SWING, &swing(300, 1, 1e-3)).read().unwrap();
    let (run, expected) = (&set.runs[0], &plain.runs[0]);
    assert_eq!(run.times.len(), expected.times.len());
    for (t, own) in run.times.iter().zip(&expected.times) {
        assert!((t - run.times[0] - own).abs() < 1e-6, "{t} {own}");
    }
    for (values, expected) in run.values.iter().zip(&expected.values) {
        let far = |(a, b): (&f64, &f64)| (a - b).abs() > rounding;
        assert!(!values.iter().zip(expected).any(far));
    }
}

/// Adds a line before the sections.
fn with_line(folder: &Folder, line: &str) {
    let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
    folder.write("recording.toml", format!("{line}\n{text}"));
}

#[test]
fn a_rate_replaces_the_column_of_the_times() {
    let run = mapped("theta,tau", |_, [_, theta, tau]| {
        vec![theta.to_string(), tau.to_string()]
    });
    let folder = rig(SWING, &run);
    let message = folder.refused();
    assert!(message.contains("rate = 100"), "{message}");
    with_line(&folder, "rate = 100");
    assert_same(&folder.read().unwrap(), ROUNDING);
    for (wrong, expected) in [
        ("rate = 0", "rows per second"),
        ("rate = \"fast\"", "a number"),
    ] {
        let folder = rig(SWING, &run);
        with_line(&folder, wrong);
        let message = folder.refused();
        assert!(message.contains(expected), "{message}");
    }
    let folder = rig(
        &format!("t = {{ unit = \"s\" }}\n{SWING}"),
        &swing(300, 1, 1e-3),
    );
    with_line(&folder, "rate = 100");
    assert!(folder.refused().contains("`rate` states the times"));
}

#[test]
fn stamps_in_seconds_and_nanoseconds_are_one_time() {
    for (parts, line) in [
        (["header.stamp.sec", "header.stamp.nanosec"], ""),
        (["timestamp_sec", "timestamp_nanosec"], ""),
        (["began.secs", "began.nsecs"], "began = { time = true }\n"),
    ] {
        let run = mapped(
            &format!("{},theta,tau", parts.join(",")),
            |row, [_, theta, tau]| {
                let nanoseconds = 990_000_000 + 10_000_000 * row as u64;
                let seconds = 1_700_000_000 + nanoseconds / 1_000_000_000;
                let rest = nanoseconds % 1_000_000_000;
                vec![
                    seconds.to_string(),
                    rest.to_string(),
                    theta.to_string(),
                    tau.to_string(),
                ]
            },
        );
        let set = rig(&format!("{line}{SWING}"), &run).read().unwrap();
        assert_same(&set, ROUNDING);
    }
    // A stamp in ns is the clock where no column has a better name.
    let run = mapped("stamp_ns,theta,tau", |row, [_, theta, tau]| {
        vec![
            (10_000_000 * row).to_string(),
            theta.to_string(),
            tau.to_string(),
        ]
    });
    assert_same(&rig(SWING, &run).read().unwrap(), ROUNDING);
}

#[test]
fn a_pattern_describes_columns_by_names_and_by_numbers() {
    let run = swing(300, 1, 1e-3).replace("t,theta,tau", "t,q_theta,state[7]");
    let by_name = "\"q_*\" = { measures = \"*\", unit = \"rad\" }\n\
                   \"state[*]\" = { input = [\"tau\"], unit = \"N m\" }";
    assert_same(&rig(by_name, &run).read().unwrap(), ROUNDING);
    for (channels, expected) in [
        (
            "\"p_*\" = { measures = \"*\" }",
            "no column fits the pattern `p_*`",
        ),
        ("\"q_*\" = { measures = \"no_*\" }", "none names a quantity"),
        (
            "\"state[*]\" = { input = [\"tau\", \"theta\"] }",
            "the list has 2 names, but 1 numbered columns",
        ),
        ("q_theta = { measures = [\"theta\"] }", "expected a string"),
    ] {
        let message = rig(channels, &run).refused();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn counts_of_an_encoder_with_gear_zero_and_sign_are_angles() {
    let per_rad = 4096.0 * 9.0 / std::f64::consts::TAU;
    let run = mapped("t,theta,tau", |_, [t, theta, tau]| {
        let counts = (2048.0 - per_rad * theta).round();
        vec![t.to_string(), counts.to_string(), (-0.5 * tau).to_string()]
    });
    let channels = "theta = { measures = \"theta\", counts_per_turn = 4096, gear = 9, zero = 2048, scale = -1 }\n\
                    tau = { input = \"tau\", unit = \"N m\", scale = -2 }";
    let set = rig(channels, &run).read().unwrap();
    assert_same(&set, 0.51 / per_rad);
    assert_eq!(set.channels[0].unit.text, "counts");
    for (line, expected) in [
        (
            "theta = { measures = \"theta\", unit = \"deg\", counts_per_turn = 9 }",
            "no other unit",
        ),
        (
            "theta = { measures = \"theta\", counts_per_turn = -9 }",
            "is positive",
        ),
        ("theta = { measures = \"theta\", scale = 0 }", "is not zero"),
        (
            "tau = { input = \"tau\", counts_per_turn = 9 }",
            "have turns",
        ),
        ("theta = { measures = \"theta\", scale = 1e300 }", "in SI"),
    ] {
        let message = rig(line, &run).refused();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn an_encoder_of_the_motor_that_starts_anew_is_counted_on() {
    // Three turns of a motor behind a gear of nine, seen by an encoder of one turn.
    let run = mapped("t,theta,tau", |_, [t, theta, tau]| {
        let turns = 9.0 * theta / std::f64::consts::TAU;
        let counts = (4096.0 * turns + 2048.0).floor().rem_euclid(4096.0);
        vec![t.to_string(), counts.to_string(), tau.to_string()]
    });
    let channels = "theta = { measures = \"theta\", counts_per_turn = 4096, gear = 9, zero = 2048 }\n\
                    tau = { input = \"tau\", unit = \"N m\" }";
    let set = rig(channels, &run).read().unwrap();
    assert_same(&set, 2e-4);
    let found = set
        .findings
        .iter()
        .find(|own| own.kind == FindingKind::Unwrapped)
        .unwrap();
    assert_eq!(found.channel.as_deref(), Some("theta"));
    assert!(found.message.contains("first in row "), "{}", found.message);
    assert!(!set.findings.iter().any(|own| own.kind == FindingKind::Jump));
}

#[test]
fn a_jump_that_is_no_turn_is_reported_with_row_and_column() {
    // A potentiometer of 300 degrees beyond whose end the angle goes on at the other end.
    let run = mapped("t,theta,tau", |row, [t, _, tau]| {
        let angle = (1.2 * row as f64).rem_euclid(300.0);
        vec![t.to_string(), angle.to_string(), tau.to_string()]
    });
    let channels = "theta = { measures = \"theta\", unit = \"deg\" }\n\
                    tau = { input = \"tau\", unit = \"N m\" }";
    let set = rig(channels, &run).read().unwrap();
    let found = set
        .findings
        .iter()
        .find(|own| own.kind == FindingKind::Jump)
        .unwrap();
    assert_eq!(found.channel.as_deref(), Some("theta"));
    assert!(
        found.message.contains("in row 251 (t = 2.500 s)"),
        "{}",
        found.message
    );
    let smooth = rig(SWING, &swing(300, 1, 1e-3)).read().unwrap();
    assert!(
        !smooth
            .findings
            .iter()
            .any(|own| own.kind == FindingKind::Jump)
    );
}

#[test]
fn episodes_of_one_file_are_runs() {
    let mut text = "episode_index,t,theta,tau\n".to_owned();
    for episode in 0..3 {
        for line in swing(300, 1 + episode, 1e-3).lines().skip(1) {
            writeln!(text, "{episode},{line}").unwrap();
        }
    }
    let folder = Folder::new();
    folder.write("all.csv", &text);
    folder.write(
        "recording.toml",
        pendulum(SWING, &["all.csv#0-1"], &["all.csv#2"]),
    );
    let set = folder.read().unwrap();
    let names: Vec<&str> = set.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["all.csv#0", "all.csv#1", "all.csv#2"]);
    assert!(set.runs.iter().all(|run| run.times.len() == 300));
    assert_same(&set, ROUNDING);
    for (run, expected) in [
        ("all.csv#3", "0 rows"),
        ("all.csv#0-4000000000", "at most 1024 runs"),
        ("all.csv", "the time goes back"),
        ("all.csv#x", "all.csv#x"),
    ] {
        folder.write("recording.toml", pendulum(SWING, &[run], &[]));
        let message = folder.refused();
        assert!(message.contains(expected), "{message}");
    }
    folder.write("plain.csv", swing(300, 1, 1e-3));
    folder.write("recording.toml", pendulum(SWING, &["plain.csv#0"], &[]));
    assert!(folder.refused().contains("no column `episode_index`"));
}
