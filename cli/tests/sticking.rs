//! Dry friction is found beside exact simulations of what really sticks.

mod rig;
mod support;

use rig::sticking;
use serde_json::{Value, json};
use support::number;

/// Most of the time it slides, or most of the time it rests; forces reach 3.5 N.
const FRICTIONS: [f64; 2] = [0.4, 1.8];

#[test]
fn friction_that_sticks_is_dry_friction() {
    for friction in FRICTIONS {
        let folder = sticking(friction);
        folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
        let report = folder.json("report.json");
        let dry = json!(["coulomb_friction@x"]);
        // Nothing disturbs this rig, so that an excess near rest of some percent shows: the rounded sign
        // creeps where the rig rests. Then both are told.
        let tied = report["tied"].as_array().expect("ties").iter();
        let told = tied.flat_map(|group| group.as_array().expect("a group"));
        let is_told =
            report["which"][0]["effects"] == dry || told.into_iter().any(|one| *one == dry);
        assert!(is_told, "{friction} N: {report:#}");
        let hypotheses = report["which"].as_array().expect("hypotheses").iter();
        let found = |one: &&Value| one["effects"] == dry;
        let found = hypotheses.clone().find(found).expect("dry friction");
        let value = number(&found["parameters"][0], "value");
        assert!(
            (value / friction - 1.0).abs() < 0.01,
            "{value} N for {friction} N"
        );
    }
}
