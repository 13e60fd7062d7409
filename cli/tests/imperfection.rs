//! What a sensor lacks and no prediction shows is no cause: it is fitted beside every hypothesis.

use serde_json::json;

use crate::rig::dry_with_a_biased_sensor;
use crate::support::number;

const BIAS: f64 = 2e-3;

#[test]
fn a_bias_that_changes_no_prediction_stands_beside_every_hypothesis() {
    let folder = dry_with_a_biased_sensor(0.3, BIAS);
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
    let folder = dry_with_a_biased_sensor(0.0, 10.0 * BIAS);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(
        report["which"][0]["effects"],
        json!(["sensor_bias@v"]),
        "{report:#}"
    );
    assert_eq!(report["imperfections"], json!([]));
}
