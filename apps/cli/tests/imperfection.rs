//! What a sensor lacks, and gains and scales within their tolerances.

use serde_json::json;

use crate::rig::{dry_with_two_sensors, low_pass, viscous};
use crate::support::{Folder, Outcome, number};

const BIAS: f64 = 2e-3;

#[test]
fn a_bias_that_changes_no_prediction_is_named_as_such() {
    let folder = dry_with_two_sensors(0.3, || |v| v + BIAS);
    let shown = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    let effects = top["effects"].as_array().expect("effects");
    let expected = [json!("coulomb_friction@x"), json!("sensor_bias@v")];
    assert!(
        effects.len() == 2 && expected.iter().all(|one| effects.contains(one)),
        "{report:#}"
    );
    let parameters = top["parameters"].as_array().expect("sizes");
    let found = parameters
        .iter()
        .find(|one| one["name"] == "sensor_bias@v.bias");
    let found = found.unwrap_or_else(|| panic!("{report:#}"));
    let (value, std) = (number(found, "value"), number(found, "std"));
    assert!((value - BIAS).abs() < 4.0 * std, "{value} ± {std} m/s");
    let remark = "do not change: sensor_bias@v (immaterial)";
    assert!(shown.stdout.contains(remark), "{}", shown.stdout);
}

#[test]
fn a_bias_that_is_all_of_the_gap_is_its_cause() {
    let folder = dry_with_two_sensors(0.0, || |v| v + 10.0 * BIAS);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(
        report["which"][0]["effects"],
        json!(["sensor_bias@v"]),
        "{report:#}"
    );
}

#[test]
fn a_filter_of_a_sensor_is_told_from_a_delay() {
    const TIME_CONSTANT: f64 = 0.04;
    let folder = dry_with_two_sensors(0.0, || low_pass(TIME_CONSTANT));
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    assert_eq!(top["effects"], json!(["sensor_delay@v"]), "{report:#}");
    let found = &top["parameters"][0];
    assert_eq!(found["name"], "sensor_delay@v.time_constant", "{report:#}");
    let (value, std) = (number(found, "value"), number(found, "std"));
    assert!(
        (value - TIME_CONSTANT).abs() < 4.0 * std,
        "{value} ± {std} s"
    );
    assert_eq!(top["changes"]["beside"][0]["acts"], "slow");
    let closed = number(&report, "how_far/closed_vs_refitted");
    assert!(closed > 0.95, "{closed}");
}

/// Writes the leading hypothesis to `better.toml`.
fn applied(folder: &Folder) -> Outcome {
    let files = ["--report", "report.json", "-o", "better.toml"];
    folder.done(&[&["apply", "carriage"][..], &files].concat())
}

/// A carriage with viscous friction whose logged forces are a `part` of the true ones.
fn misread(part: f64, stated: &str) -> Folder {
    let folder = viscous(0.4);
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(name);
        let (head, rows) = text.split_once('\n').expect("a head");
        let rows = rows.lines().map(|row| {
            let (before, force) = row.rsplit_once(',').expect("a force");
            let force: f64 = force.parse().expect("a number");
            format!("{before},{}\n", part * force)
        });
        folder.write(name, &format!("{head}\n{}", rows.collect::<String>()));
    }
    let description = folder.read("recording.toml");
    let input = "F = { input = \"F\"";
    folder.write(
        "recording.toml",
        &description.replace(input, &format!("{input}{stated}")),
    );
    folder
}

#[test]
fn a_gain_within_its_tolerance_is_fitted_and_no_cause() {
    let folder = misread(1.0 / 1.08, ", gain_std = 0.1");
    let shown = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    assert_eq!(top["effects"], json!(["viscous_friction@x"]), "{report:#}");
    let gain = &top["changes"]["gains"][0];
    assert_eq!(gain["name"], "actuator_gain@F.gain", "{report:#}");
    assert_eq!(
        (number(gain, "stated"), number(gain, "stated_std")),
        (0.0, 0.1)
    );
    let (value, std) = (number(gain, "value"), number(gain, "std"));
    assert!(
        (value - 0.08).abs() < 4.0 * std && std < 0.05,
        "{value} ± {std}"
    );
    assert!(
        shown.stdout.contains("viscous friction"),
        "{}",
        shown.stdout
    );
    // The spec gets both, and predicts the recordings.
    let summary = applied(&folder);
    assert!(
        summary
            .stdout
            .contains("changed   actuator_gain@F.gain = 0.0"),
        "{}",
        summary.stdout
    );
    let better = folder.read("better.toml");
    assert!(
        better.contains("actuator_gain_F_gain") && better.contains("viscous_friction"),
        "{better}"
    );
}

#[test]
fn a_gain_beyond_its_tolerance_is_the_cause() {
    let folder = misread(1.0 / 1.3, ", gain_std = \"1 %\"");
    // A known mass: the ratio of both is what the motion determines.
    let description = folder.read("recording.toml");
    folder.write(
        "recording.toml",
        &description.replace("std = 0.02", "std = 0"),
    );
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    let effects = top["effects"].to_string();
    assert!(
        effects.contains("actuator_gain@F") && effects.contains("viscous_friction@x"),
        "{report:#}"
    );
    let parameters = top["parameters"].as_array().expect("sizes");
    let gain = parameters
        .iter()
        .find(|one| one["name"] == "actuator_gain@F.gain");
    let gain = gain.unwrap_or_else(|| panic!("{report:#}"));
    let (value, std) = (number(gain, "value"), number(gain, "std"));
    assert!((value - 0.3).abs() < 4.0 * std, "{value} ± {std}");
}

#[test]
fn a_scale_within_its_tolerance_is_fitted_and_no_cause() {
    let folder = dry_with_two_sensors(0.3, || |v| 1.04 * v);
    let description = folder.read("recording.toml");
    let sensor = "v = { measures = \"v\"";
    folder.write(
        "recording.toml",
        &description.replace(sensor, &format!("{sensor}, scale_std = 0.05")),
    );
    let shown = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let top = &report["which"][0];
    assert_eq!(top["effects"], json!(["coulomb_friction@x"]), "{report:#}");
    let scale = &top["changes"]["gains"][0];
    assert_eq!(scale["name"], "sensor_scale@v.scale", "{report:#}");
    let (value, std) = (number(scale, "value"), number(scale, "std"));
    assert!(
        (value - 1.04).abs() < 4.0 * std && std < 0.02,
        "{value} ± {std}"
    );
    assert!(
        shown.stdout.contains("sensor_scale@v.scale = 1.0"),
        "{}",
        shown.stdout
    );
    let summary = applied(&folder);
    assert!(
        summary
            .stdout
            .contains("elsewhere sensor_scale@v: the sensor v reads 1.0"),
        "{}",
        summary.stdout
    );
}

#[test]
fn a_tolerance_at_the_wrong_kind_of_channel_is_an_error() {
    let folder = misread(1.0, ", scale_std = 0.1");
    folder.fails(
        3,
        &["diagnose", "--data", "."],
        &[
            "recording.toml:8:",
            "only a measured channel has a scale",
            "write `gain_std`",
        ],
    );
}
