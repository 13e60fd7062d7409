//! The column of the times is found by its name or named by the description, in any unit.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;

use appell_recordings::{DataSet, FindingKind};

use crate::common::{Folder, SWING, pendulum, swing};

#[test]
fn times_are_in_the_unit_that_the_description_states() {
    let folder = Folder::new();
    let swing = swing(200, 1, 1e-3);
    let mut lines = swing.lines();
    let mut text = format!("{}\n", lines.next().unwrap());
    for (row, line) in lines.enumerate() {
        let (_, rest) = line.split_once(',').unwrap();
        writeln!(text, "{},{rest}", 10 * row).unwrap();
    }
    folder.write("run.csv", text);
    let read = |line: &str| {
        let channels = format!("{SWING}\n{line}");
        folder.write("recording.toml", pendulum(&channels, &["run.csv"], &[]));
        folder.read()
    };
    let slow = |set: &DataSet| {
        let mut findings = set.findings.iter();
        let found = findings.find(|finding| finding.kind == FindingKind::SlowClock);
        found.map(|finding| (finding.channel.clone(), finding.message.clone()))
    };
    let set = read("t = { unit = \"ms\" }").unwrap();
    assert!((set.runs[0].duration() - 1.99).abs() < 1e-12);
    assert_eq!(slow(&set), None);
    let set = read("").unwrap();
    assert!((set.runs[0].duration() - 1990.0).abs() < 1e-9);
    let (channel, message) = slow(&set).unwrap();
    assert_eq!(channel.as_deref(), Some("t"));
    for part in ["a row every 10 s", "t = { unit = \"ms\" }"] {
        assert!(message.contains(part), "{message}");
    }
    // Whoever says that they are seconds is believed.
    let set = read("t = { unit = \"s\" }").unwrap();
    assert_eq!(slow(&set), None);
    for (line, told) in [
        ("t = { unit = \"kg\" }", "`t` is a time, `kg` is a mass"),
        (
            "t = { measures = \"theta\" }",
            "`t` is the time, not a channel",
        ),
        ("t = \"ms\"", "expected a table such as"),
        ("t = { time = \"yes\" }", "expected true or false"),
        (
            "t = { time = true }\nu = { time = true }",
            "a second column of the times",
        ),
        (
            "u = { time = true, unit = \"s\" }",
            "no column `u` of the times",
        ),
    ] {
        let error = read(line).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn the_column_of_the_times_has_any_name_and_unit() {
    let swing = swing(200, 1, 1e-3);
    let folder = Folder::new();
    let read = |header: &str, factor: f64, line: &str| {
        let mut lines = swing.lines();
        lines.next();
        let mut text = format!("{header},theta,tau\n");
        for line in lines {
            let (t, rest) = line.split_once(',').unwrap();
            let t: f64 = t.parse().unwrap();
            writeln!(text, "{},{rest}", factor * t).unwrap();
        }
        folder.write("run.csv", text);
        let channels = format!("{SWING}\n{line}");
        folder.write("recording.toml", pendulum(&channels, &["run.csv"], &[]));
        folder.read()
    };
    for (header, factor, line) in [
        ("time", 1.0, ""),
        ("Timestamp", 1.0, "Timestamp = { unit = \"s\" }"),
        ("time [ms]", 1e3, ""),
        ("t_us", 1e6, ""),
        ("time", 1e9, "time = { unit = \"ns\" }"),
        ("clock", 1e3, "clock = { time = true, unit = \"ms\" }"),
        // What the description says counts.
        ("t [s]", 1e3, "\"t [s]\" = { time = true, unit = \"ms\" }"),
    ] {
        let set = read(header, factor, line).unwrap();
        let duration = set.runs[0].duration();
        assert!((duration - 1.99).abs() < 1e-9, "{header}: {duration}");
        assert_eq!(set.channels.len(), 2, "{header}");
        let bad = |kind| {
            let mut findings = set.findings.iter();
            findings.any(|finding| finding.kind == kind)
        };
        assert!(!bad(FindingKind::SlowClock) && !bad(FindingKind::UnknownColumn));
    }
    // A name without a unit is in seconds, and doubted as `t` is.
    let set = read("timestamp", 1e3, "").unwrap();
    let mut findings = set.findings.iter();
    let doubt = findings.find(|finding| finding.kind == FindingKind::SlowClock);
    let line = "timestamp = { time = true, unit = \"ms\" }";
    assert!(doubt.unwrap().message.contains(line));
}

#[test]
fn several_clocks_are_told_by_name() {
    let text = swing(60, 1, 1e-3).replacen("t,theta,tau", "time,theta,tau", 1);
    let doubled: Vec<String> = (text.lines().enumerate())
        .map(|(row, line)| match row {
            0 => format!("{line},timestamp [ns]"),
            _ => format!("{line},{}", 10_000_000 * (row - 1)),
        })
        .collect();
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(SWING, &["run.csv"], &[]));
    folder.write("run.csv", doubled.join("\n"));
    let message = folder.refused();
    for part in [
        "`time`, `timestamp [ns]`",
        "time = { time = true, unit = \"s\" }",
    ] {
        assert!(message.contains(part), "{message}");
    }
    let stated = format!("{SWING}\n\"timestamp [ns]\" = {{ time = true }}");
    folder.write("recording.toml", pendulum(&stated, &["run.csv"], &[]));
    let set = folder.read().unwrap();
    assert!((set.runs[0].duration() - 0.59).abs() < 1e-12);
    // A column without a role may be either of the two.
    let both = format!("{SWING}\ntime = {{}}\n\"timestamp [ns]\" = {{}}");
    folder.write("recording.toml", pendulum(&both, &["run.csv"], &[]));
    assert!(folder.refused().contains("may both be the times"));
}

#[test]
fn times_that_no_clock_shows_are_refused() {
    for scale in [1e300, 1e-300] {
        let mut text = String::from("t,theta,tau\n");
        for row in 0..60 {
            writeln!(
                text,
                "{:e},{},0",
                scale * f64::from(row),
                0.1 * f64::from(row % 7)
            )
            .unwrap();
        }
        let folder = Folder::new();
        folder.write("recording.toml", pendulum(SWING, &["run.csv"], &[]));
        folder.write("run.csv", text);
        let message = folder.refused();
        assert!(message.contains("no clock shows"), "{message}");
    }
}

#[test]
fn a_log_of_three_rows_is_read_and_told_to_be_short() {
    let folder = Folder::new();
    let angle = "angle = { measures = \"theta\", unit = \"rad\" }\ntime = { unit = \"s\" }";
    folder.write("recording.toml", pendulum(angle, &["run.csv"], &[]));
    folder.write(
        "run.csv",
        "time,angle\n0.00,0.10\n0.01,0.0999\n0.02,0.0996\n",
    );
    let set = folder.read().unwrap();
    assert_eq!(set.runs[0].times, [0.0, 0.01, 0.02]);
    let mut findings = set.findings.iter();
    assert!(findings.any(|finding| finding.kind == FindingKind::FewRows));
}

#[test]
fn stamps_of_a_calendar_count_from_the_first_row() {
    let folder = Folder::new();
    let swing = swing(200, 1, 1e-3);
    let mut lines = swing.lines();
    let mut text = format!("stamp_ms{}\n", &lines.next().unwrap()[1..]);
    for (row, line) in lines.enumerate() {
        let (_, rest) = line.split_once(',').unwrap();
        writeln!(text, "{},{rest}", 1_690_000_000_000_u64 + 4 * row as u64).unwrap();
    }
    folder.write("run.csv", text);
    let channels = format!("{SWING}\nstamp_ms = {{ time = true, unit = \"ms\" }}");
    folder.write("recording.toml", pendulum(&channels, &["run.csv"], &[]));
    let set = folder.read().unwrap();
    // In seconds since 1970 a step would be wrong by some 1e-7 s.
    let of_row = |row: usize| (set.runs[0].times[row] - 0.004 * row as f64).abs();
    assert!((0..200).all(|row| of_row(row) < 1e-12));
}
