//! Parts that a spec lacks and the library knows, each in a rig whose law is written otherwise, and the same rigs with
//! nothing lacking.

use serde_json::{Value, json};

use crate::rig::planted::{Planted, shipped};
use crate::support::{Folder, number};

/// A size may be off by so many of its deviations, beyond which lies 1 in 16 000, and by this part of itself: a filter
/// takes steps that are long for what is stiff.
const NEAR: f64 = 4.0;
const STEPS: f64 = 0.01;
/// The gap that closes at least.
const CLOSED: f64 = 0.95;

const PENDULUM: &[(&str, f64, &str)] = &[("m", 1.0, "kg"), ("l", 0.5, "m"), ("I", 0.02, "kg*m^2")];
const LINKS: &[(&str, f64, &str)] = &[
    ("m1", 1.0, "kg"),
    ("m2", 1.0, "kg"),
    ("l1", 0.4, "m"),
    ("r1", 0.2, "m"),
    ("r2", 0.2, "m"),
    ("I1", 0.015, "kg*m^2"),
    ("I2", 0.015, "kg*m^2"),
];

/// A pendulum that swings out.
fn swinging(spec: &str) -> Planted<'_> {
    Planted {
        spec,
        parameters: PENDULUM,
        coordinates: &["theta"],
        inputs: &[],
        begins: [1.2, -0.9, 1.0],
        seconds: 6,
    }
}

/// A pendulum under a torque.
fn driven(spec: &str) -> Planted<'_> {
    Planted {
        inputs: &[("tau", "N*m", 1.5)],
        begins: [0.0; 3],
        ..swinging(spec)
    }
}

/// A double pendulum with a motor at each joint.
fn arm(spec: &str) -> Planted<'_> {
    Planted {
        spec,
        parameters: LINKS,
        coordinates: &["theta1", "theta2"],
        inputs: &[("tau1", "N*m", 1.5), ("tau2", "N*m", 0.6)],
        begins: [0.0; 3],
        seconds: 5,
    }
}

/// The leading hypothesis of the rig.
fn leading(folder: &Folder) -> (Value, Value) {
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    (report["which"][0].clone(), report)
}

/// What leads is this effect with these values, and closes the gap.
fn assert_found(folder: &Folder, effect: &str, values: &[(&str, f64)]) {
    let (top, report) = leading(folder);
    assert_eq!(top["effects"], json!([effect]), "{:#}", report["which"]);
    let found = top["parameters"].as_array().expect("values");
    for (name, expected) in values {
        let name = format!("{effect}.{name}");
        let one = found.iter().find(|one| one["name"] == name);
        let one = one.unwrap_or_else(|| panic!("{name} in {top:#}"));
        let (value, std) = (number(one, "value"), number(one, "std"));
        let most = NEAR * std + STEPS * expected.abs();
        assert!((value - expected).abs() < most, "{one}");
    }
    let closed = number(&report, "how_far/closed_vs_refitted");
    assert!(closed > CLOSED, "{closed}");
}

fn assert_no_gap(folder: &Folder) {
    let (_, report) = leading(folder);
    assert_eq!(report["verdict"], "no_gap", "{:#}", report["which"]);
}

#[test]
fn dry_friction_that_differs_by_direction_is_found_with_both_forces() {
    let spec = shipped("pendulum");
    let folder = swinging(&spec).with(
        "[loads.rubbing]\nkind = \"generalized\"\ncoordinate = \"theta\"\n\
         force = \"-0.065 [N*m]*tanh(omega/(0.02 [rad/s])) - 0.025 [N*m]*tanh(omega/(0.02 [rad/s]))^2\"\n",
    );
    let effect = "directional_friction@theta";
    assert_found(&folder, effect, &[("forward", 0.09), ("backward", 0.04)]);
    // The same in both directions is plain dry friction.
    let folder = swinging(&spec).with(
        "[loads.rubbing]\nkind = \"generalized\"\ncoordinate = \"theta\"\n\
         force = \"-0.065 [N*m]*tanh(omega/(0.02 [rad/s]))\"\n",
    );
    assert_found(&folder, "coulomb_friction@theta", &[("force", 0.065)]);
    assert_no_gap(&swinging(&spec).with(""));
}

#[test]
fn a_stop_is_found_with_its_place_and_stiffness_on_the_side_where_it_is() {
    let spec = shipped("pendulum");
    let folder = driven(&spec).with(
        "[loads.end]\nkind = \"generalized\"\ncoordinate = \"theta\"\n\
         force = \"-max(theta - 0.5, 0)*(400 [N*m] + 150 [N*m*s]*omega)\"\n",
    );
    let effect = "stop@theta";
    assert_found(
        &folder,
        effect,
        &[
            ("stiffness", 400.0),
            ("place", 0.5),
            ("rate", 400.0 / 150.0),
        ],
    );
    let folder = driven(&spec).with(
        "[loads.end]\nkind = \"generalized\"\ncoordinate = \"theta\"\n\
         force = \"max(-0.4 - theta, 0)*(600 [N*m] - 200 [N*m*s]*omega)\"\n",
    );
    assert_found(&folder, effect, &[("stiffness", 600.0), ("place", -0.4)]);
    assert_no_gap(&driven(&spec).with(""));
}

#[test]
fn coordinates_that_a_belt_or_a_feedback_couples_are_found() {
    let spec = shipped("double_pendulum");
    let folder = arm(&spec).with(
        "[loads.belt_1]\nkind = \"generalized\"\ncoordinate = \"theta1\"\n\
         force = \"-0.8 [N*m]*(theta1 - theta2) - 0.02 [N*m*s]*(omega1 - omega2)\"\n\
         [loads.belt_2]\nkind = \"generalized\"\ncoordinate = \"theta2\"\n\
         force = \"0.8 [N*m]*(theta1 - theta2) + 0.02 [N*m*s]*(omega1 - omega2)\"\n",
    );
    let effect = "coupling@theta1,theta2";
    assert_found(
        &folder,
        effect,
        &[("stiffness", 0.8), ("ratio", 1.0), ("damping", 0.025)],
    );
    let folder = arm(&spec).with(
        "[loads.inner]\nkind = \"generalized\"\ncoordinate = \"theta2\"\n\
         force = \"-0.3 [N*m]*theta1\"\n",
    );
    assert_found(&folder, effect, &[("gain", 0.3)]);
    assert_no_gap(&arm(&spec).with(""));
}

#[test]
fn a_payload_is_found_with_its_mass_and_place() {
    let spec = shipped("double_pendulum");
    let folder = arm(&spec).with(
        "[points.tool]\nfrom = \"E\"\nin = \"link2\"\nat = [\"0.05 [m]\", 0, \"-0.33 [m]\"]\n\
         [bodies.tool]\ncentre = \"tool\"\nmass = \"0.25 [kg]\"\n",
    );
    let place = [("mass", 0.25), ("x", 0.05), ("z", 0.2 - 0.33)];
    assert_found(&folder, "payload@link2", &place);
}

#[test]
fn a_servo_that_is_limited_is_found_with_its_limit() {
    let servo = |force: &str| {
        shipped("pendulum")
            .replace("name   = \"pendulum\"", "name = \"servo\"")
            .replace("tau = { unit = \"N*m\"", "u = { unit = \"rad\"")
            .replace(
                "kind = \"torque\", on = \"rod\", in = \"ground\", vector = [0, \"-tau\", 0]",
                &format!("kind = \"generalized\", coordinate = \"theta\", force = \"{force}\""),
            )
            + "[parameters.kp]\nvalue = 20\nunit = \"N*m/rad\"\n\
               [parameters.kd]\nvalue = 1.2\nunit = \"N*m*s/rad\"\n"
    };
    let law = "kp*(u - theta) - kd*omega";
    let spec = servo(law);
    let parameters = [
        PENDULUM,
        &[("kp", 20.0, "N*m/rad"), ("kd", 1.2, "N*m*s/rad")],
    ]
    .concat();
    let rig = Planted {
        parameters: &parameters,
        inputs: &[("u", "rad", 0.7)],
        begins: [0.0; 3],
        ..swinging(&spec)
    };
    let folder = rig.of(&servo(&format!("min(max({law}, -3 [N*m]), 3 [N*m])")));
    assert_found(&folder, "saturation@drive", &[("limit", 3.0)]);
    assert_no_gap(&rig.with(""));
}
