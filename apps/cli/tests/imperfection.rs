//! What a sensor lacks: what no prediction shows is no cause, and is fitted together with every hypothesis.

use serde_json::json;

use crate::rig::{dry_with_two_sensors, low_pass};
use crate::support::number;

const BIAS: f64 = 2e-3;

#[test]
fn a_bias_that_changes_no_prediction_stands_beside_every_hypothesis() {
    let folder = dry_with_two_sensors(0.3, || |v| v + BIAS);
    let shown = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let which = report["which"].as_array().expect("hypotheses");
    assert_eq!(
        which[0]["effects"],
        json!(["coulomb_friction@x"]),
        "{report:#}"
    );
    for hypothesis in which {
        let effects = hypothesis["effects"].to_string();
        assert!(!effects.contains("sensor_bias@v"), "{effects}");
    }
    let found = &report["imperfections"][0];
    assert_eq!(found["name"], "sensor_bias@v.bias", "{report:#}");
    let (value, std) = (number(found, "value"), number(found, "std"));
    assert!((value - BIAS).abs() < 4.0 * std, "{value} ± {std} m/s");
    let beside = &which[0]["changes"]["beside"][0];
    assert_eq!(beside["effect"], "sensor_bias@v", "{report:#}");
    assert!(
        shown.stdout.contains("  sensors   sensor_bias@v 0.00"),
        "{}",
        shown.stdout
    );
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
    assert_eq!(report["imperfections"], json!([]));
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
