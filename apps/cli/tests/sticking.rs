//! Dry friction is found beside exact simulations of what really sticks.

use serde_json::{Value, json};

use crate::rig::sticking;
use crate::support::number;

/// Most of the time it slides, or most of the time it rests; forces reach 3.5 N.
const FRICTIONS: [f64; 2] = [0.4, 1.8];

#[test]
fn friction_that_sticks_is_dry_friction() {
    for friction in FRICTIONS {
        let folder = sticking(friction);
        folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
        let report = folder.json("report.json");
        // Nothing disturbs this rig, so that an excess near rest of some percent shows: the rounded sign
        // creeps where the rig rests. Then both are told.
        let named = |one: &Value| one["effects"] == json!(["coulomb_friction@x"]);
        let hypotheses = report["which"].as_array().expect("hypotheses");
        let found = hypotheses.iter().position(named).expect("dry friction");
        let tied = report["tied"][0].as_array();
        let is_tied = tied.is_some_and(|tied| tied.contains(&json!("coulomb_friction@x")));
        assert!(found == 0 || is_tied, "{friction} N: {report:#}");
        let value = number(&hypotheses[found]["parameters"][0], "value");
        assert!(
            (value / friction - 1.0).abs() < 0.01,
            "{value} N for {friction} N"
        );
    }
}
