//! What comes late by a part of a row is found, beside another effect too; names that no recording of the
//! rig tells apart are tied.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::rig::late;

const DELAY: f64 = 0.003;
/// Where the one channel shows all of the motion, a sensor or an actuator may be late; so short a lag is a
/// delay.
const NAMES: [&str; 3] = ["actuator_lag@F", "actuator_delay@F", "sensor_delay@x"];
const FRICTION: &str = "viscous_friction@x";

fn effects(hypothesis: &Value) -> BTreeSet<&str> {
    let effects = hypothesis["effects"].as_array().expect("effects");
    effects.iter().filter_map(Value::as_str).collect()
}

#[test]
fn a_short_delay_beside_friction_is_found_under_each_of_its_names() {
    let folder = late(DELAY, 0.3);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "ambiguous", "{report:#}");
    let which = report["which"].as_array().expect("hypotheses");
    for name in NAMES {
        let pair = BTreeSet::from([FRICTION, name]);
        let place = which.iter().position(|one| effects(one) == pair);
        let found = &which[place.unwrap_or_else(|| panic!("{pair:?}: {report:#}"))];
        assert!(place < Some(NAMES.len()), "{pair:?}: {report:#}");
        let parameters = found["parameters"].as_array().expect("parameters");
        let time = parameters
            .iter()
            .find(|one| one["unit"] == "s")
            .expect("a time");
        let value = |key: &str| time[key].as_f64().expect("a number");
        assert!(
            (value("value") - DELAY).abs() < 3.5 * value("std"),
            "{time}"
        );
    }
}
