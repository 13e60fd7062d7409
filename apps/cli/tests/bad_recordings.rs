//! `appell diagnose` on recordings that are wrong: a clear error with its place, or a warning.

use appell_test_kit::is_full;

use crate::rig::viscous;
use crate::support::Folder;

/// A run with changed lines, from 0 for the header.
fn changed(change: impl Fn(usize, &str) -> Option<String>) -> Folder {
    let folder = viscous(0.4);
    let lines: Vec<String> = folder
        .read("a.csv")
        .lines()
        .enumerate()
        .filter_map(|(row, line)| change(row, line))
        .collect();
    folder.write("a.csv", &(lines.join("\n") + "\n"));
    folder
}

/// All runs with other measurements.
fn measured(value: impl Fn(usize) -> &'static str) -> Folder {
    let folder = viscous(0.4);
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(name);
        let mut lines = text.lines();
        let mut changed = vec![lines.next().expect("a header").to_owned()];
        changed.extend(lines.enumerate().map(|(row, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{},{},{}", cells[0], value(row), cells[2])
        }));
        folder.write(name, &(changed.join("\n") + "\n"));
    }
    folder
}

fn refused(folder: &Folder, words: &[&str]) {
    folder.fails(
        3,
        &["diagnose", "--data", ".", "--json", "report.json"],
        words,
    );
    assert!(!folder.path("report.json").exists(), "no report is left");
}

fn without_last(line: &str) -> Option<String> {
    line.rsplit_once(',').map(|(rest, _)| rest.to_owned())
}

#[test]
fn a_missing_column_is_named_with_its_file() {
    let folder = changed(|_, line| without_last(line));
    refused(&folder, &["no column `F`", "a.csv:1:1"]);
}

#[test]
fn a_unit_of_another_dimension_is_shown() {
    let folder = viscous(0.4);
    let description = folder.read("recording.toml");
    let wrong = description.replace("unit = \"m\", noise", "unit = \"kg\", noise");
    folder.write("recording.toml", &wrong);
    refused(
        &folder,
        &["`x` is a length, `kg` is a mass", "recording.toml:"],
    );
}

#[test]
fn files_without_a_motion_are_refused() {
    refused(&changed(|_, _| None), &["a.csv", "the file"]);
    refused(
        &changed(|row, line| (row < 2).then(|| line.to_owned())),
        &["a.csv", "1 row"],
    );
    let empty = changed(|row, line| {
        let time = line.split(',').next().unwrap_or_default();
        Some(if row == 0 {
            line.to_owned()
        } else {
            format!("{time},nan,0")
        })
    });
    refused(&empty, &["a.csv", "`x` holds no value"]);
}

#[test]
fn a_time_that_goes_back_is_left_out_and_told() {
    let folder = changed(|row, line| {
        let (_, rest) = line.split_once(',')?;
        Some(if row == 300 {
            format!("0.5,{rest}")
        } else {
            line.to_owned()
        })
    });
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert!(
        report["data"].to_string().contains("goes back"),
        "{}",
        report["data"]
    );
    assert_eq!(report["which"][0]["effects"][0], "viscous_friction@x");
}

#[test]
fn a_block_without_measurements_does_not_matter() {
    let folder = changed(|row, line| {
        let cells: Vec<&str> = line.split(',').collect();
        let lost = (200..400).contains(&row);
        Some(if lost {
            format!("{},nan,{}", cells[0], cells[2])
        } else {
            line.to_owned()
        })
    });
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["which"][0]["effects"][0], "viscous_friction@x");
}

#[test]
fn a_channel_that_never_changes_is_told() {
    let folder = measured(|_| "0.25");
    let says = "the channel never changes";
    let told = folder.done(&["recording", "."]);
    assert!(told.stdout.contains(says), "{}", told.stdout);
    if !is_full() {
        return;
    }
    let told = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    assert!(told.stdout.contains(says), "{}", told.stdout);
    let data = folder.json("report.json")["data"].to_string();
    assert!(data.contains(says), "{data}");
}

#[test]
fn values_that_no_rig_measures_are_refused() {
    let folder = measured(|row| if row % 2 == 0 { "1e150" } else { "-1e150" });
    refused(&folder, &["`x` holds 1e150 at t = 0 s", "no rig measures"]);
}

#[test]
fn a_model_that_is_nothing_like_the_recordings_does_not_break_it() {
    let folder = measured(|row| if row % 2 == 0 { "1e29" } else { "-1e29" });
    // No fit comes to its end: a few rows are enough.
    for name in ["a.csv", "b.csv", "c.csv"] {
        let lines: Vec<String> = folder
            .read(name)
            .lines()
            .take(101)
            .map(str::to_owned)
            .collect();
        folder.write(name, &(lines.join("\n") + "\n"));
    }
    let outcome = folder.run(&["diagnose", "--data", ".", "--json", "report.json"]);
    assert!([0, 4].contains(&outcome.status), "{}", outcome.stderr);
    assert!(!outcome.stderr.contains("panicked"), "{}", outcome.stderr);
}

#[test]
fn times_in_milliseconds_are_told_at_once_and_may_be_stated() {
    let folder = viscous(0.4);
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(name);
        let mut lines = text.lines();
        let mut changed = vec![lines.next().expect("a header").to_owned()];
        changed.extend(lines.enumerate().map(|(row, line)| {
            let (_, rest) = line.split_once(',').expect("a time");
            format!("{},{rest}", 10 * row)
        }));
        folder.write(name, &(changed.join("\n") + "\n"));
    }
    let rows = folder.read("a.csv").lines().count() - 1;
    let lasts = format!("a.csv: t: the run lasts {}", 10 * (rows - 1));
    let told = [
        lasts.as_str(),
        "a row every 10 s",
        "`t` is read in seconds",
        "write `t = { unit = \"ms\" }` in `[channels]`",
    ];
    refused(&folder, &told);
    let identify = ["identify", "carriage", "--data", "."];
    folder.fails(3, &identify, &told);
    let looked = folder.done(&["recording", "."]).stdout;
    assert!(looked.contains("a row every 10 s"), "{looked}");
    let description = folder.read("recording.toml");
    let stated = description.replace("[channels]", "[channels]\nt = { unit = \"ms\" }");
    folder.write("recording.toml", &stated);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["which"][0]["effects"][0], "viscous_friction@x");
}
