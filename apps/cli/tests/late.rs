//! What comes late by a part of a row is found, beside another effect too; names that no recording of the
//! rig tells apart are tied.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fmt::Write as _;

use serde_json::Value;

use crate::rig::{Noise, late};
use crate::support::Folder;

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

const ARM: &str = r#"
[mechanism]
name = "arm"
title = "An arm that hangs, and its drive"
[parameters]
I = { value = 0.05, unit = "kg*m^2", at_least = 0 }
m = { value = 1.0, unit = "kg", at_least = 0 }
l = { value = 0.3, unit = "m" }
c = { value = 0.05, unit = "N*m*s", at_least = 0 }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
theta = { unit = "rad" }
[inputs]
tau = { unit = "N*m" }
[frames]
arm = { parent = "ground", about_axis = "-y", by = "theta" }
[points]
B = { from = "O", in = "arm", at = [0, 0, "-l"] }
[bodies]
arm = { frame = "arm", centre = "O", mass = "0.5 [kg]", inertia = { in = "arm", diagonal = [0, "I", 0] } }
load = { centre = "B", mass = "m" }
[pseudo_velocities]
omega = { value = "dot(theta)", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
drive = { kind = "torque", on = "arm", in = "ground", vector = [0, "-tau", 0] }
friction = { kind = "damper", coordinate = "theta", damping = "c" }
"#;
const OF_ARM: &str = r#"
mechanism = "arm.toml"
[parameters]
I = { value = 0.05, unit = "kg*m^2", std = 0.01 }
m = { value = 1.0, unit = "kg", std = 0.05 }
c = { value = 0.05, unit = "N*m*s", std = 0.05 }
[channels]
theta = { measures = "theta", unit = "rad", noise_std = 0.00175 }
tau = { input = "tau", unit = "N*m" }
[runs]
fit = ["0.csv", "1.csv", "2.csv"]
test = ["3.csv"]
"#;

/// An arm under a digital law at 100 Hz of its noisy readings, whose drive acts `delay` s late.
fn in_a_loop(run: u32, noise: &mut Noise, delay: f64) -> String {
    const STEP: f64 = 0.01;
    let (inertia, gravity, damping) = (0.055 + 1.03 * 0.09, 1.03 * 0.3 * 9.81, 0.08);
    let turn = |[theta, omega]: [f64; 2], torque: f64, time: f64| {
        let h = time / 8.0;
        let rate = |[theta, omega]: [f64; 2]| {
            let moment = torque - damping * omega - gravity * theta.sin();
            [omega, moment / inertia]
        };
        let along = |z: [f64; 2], k: [f64; 2], h: f64| [z[0] + h * k[0], z[1] + h * k[1]];
        let mut z = [theta, omega];
        for _ in 0..8 {
            let a = rate(z);
            let b = rate(along(z, a, 0.5 * h));
            let c = rate(along(z, b, 0.5 * h));
            let d = rate(along(z, c, h));
            let mean = |i: usize| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0;
            z = along(z, [mean(0), mean(1)], h);
        }
        z
    };
    let (mut z, mut before, mut rate, mut last) = ([0.0; 2], 0.0, 0.0, 0.0);
    let slow = 0.4 + 0.3 * f64::from(run);
    let mut text = String::from("t,theta,tau\n");
    for row in 0..1500 {
        let t = STEP * f64::from(row);
        let seen = z[0] + 0.00175 * noise.next();
        let change = if row > 0 { (seen - before) / STEP } else { 0.0 };
        rate = 0.7 * rate + 0.3 * change;
        before = seen;
        let wanted = 0.6 * (TAU * slow * t).sin() + 0.3 * (3.0 * t).sin().signum();
        let torque: f64 = (8.0 * (wanted - seen) - 0.8 * rate).clamp(-6.0, 6.0);
        writeln!(text, "{t},{seen},{torque}").expect("a row");
        z = turn(turn(z, last, delay), torque, STEP - delay);
        last = torque;
    }
    text
}

/// Readings and commands are the same functions of time where either is late, so that both are tied. A command that
/// follows the motion knows something of it, but no more than what the filter does not know: it does not explain a
/// late drive.
#[test]
fn a_late_drive_in_a_digital_loop_is_tied_with_a_late_sensor() {
    const LATE: f64 = 0.008;
    let (folder, mut noise) = (Folder::new(), Noise::seeded(11));
    folder.write("arm.toml", ARM);
    folder.write("recording.toml", OF_ARM);
    for run in 0..4 {
        let rows = in_a_loop(run, &mut noise, LATE);
        folder.write(&format!("{run}.csv"), &rows);
    }
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    let which = report["which"].as_array().expect("hypotheses");
    let leading: BTreeSet<&str> = which[..2].iter().flat_map(effects).collect();
    let names = BTreeSet::from(["actuator_delay@tau", "sensor_delay@theta"]);
    assert_eq!(leading, names, "{report:#}");
    assert_eq!(
        report["tied"].as_array().map(Vec::len),
        Some(1),
        "{report:#}"
    );
    for one in &which[..2] {
        let found = one["parameters"][0]["value"].as_f64().expect("a delay");
        assert!((found - LATE).abs() < 1e-4, "{found}");
    }
}
