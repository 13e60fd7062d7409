//! Robots are diagnosed by the forces of recorded motions.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::Folder;
use appell_codegen::derived;
use appell_codegen::jit::JitModel;
use appell_gap::diagnose::{GapVerdict, Options, Report, against, diagnose};
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;

/// An arm with three joints and a load on its last link.
const ARM: &str = r#"
[mechanism]
name = "arm"
title = "arm with three joints"

[parameters]
m_1 = { value = 4, unit = "kg" }
m_2 = { value = 2, unit = "kg" }

[coordinates]
q1 = { unit = "rad" }
q2 = { unit = "rad" }
q3 = { unit = "rad" }

[inputs]
tau1 = { unit = "N*m" }
tau2 = { unit = "N*m" }
tau3 = { unit = "N*m" }

[frames]
turret = { parent = "ground", about_axis = "z", by = "q1" }
upper  = { parent = "turret", about_axis = "y", by = "q2" }
fore   = { parent = "upper", about_axis = "y", by = "q3" }

[points]
elbow = { from = "O", in = "upper", at = ["0.5 [m]", 0, 0] }
G_1   = { from = "O", in = "upper", at = ["0.2 [m]", 0, 0] }
G_2   = { from = "elbow", in = "fore", at = ["0.2 [m]", 0, 0] }

[bodies]
turret = { frame = "turret", centre = "O", mass = "1 [kg]", inertia = { in = "turret", diagonal = ["0.1 [kg*m^2]", "0.1 [kg*m^2]", "0.2 [kg*m^2]"] } }
upper  = { frame = "upper", centre = "G_1", mass = "m_1", inertia = { in = "upper", diagonal = ["0.02 [kg*m^2]", "0.1 [kg*m^2]", "0.1 [kg*m^2]"] } }
fore   = { frame = "fore", centre = "G_2", mass = "m_2", inertia = { in = "fore", diagonal = ["0.01 [kg*m^2]", "0.05 [kg*m^2]", "0.05 [kg*m^2]"] } }

[pseudo_velocities]
w1 = { value = "dot(q1)", unit = "rad/s" }
w2 = { value = "dot(q2)", unit = "rad/s" }
w3 = { value = "dot(q3)", unit = "rad/s" }

[loads]
weight  = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
drive_1 = { kind = "generalized", coordinate = "q1", force = "tau1" }
drive_2 = { kind = "generalized", coordinate = "q2", force = "tau2" }
drive_3 = { kind = "generalized", coordinate = "q3", force = "tau3" }
"#;

const RECORDED: &str = r#"
mechanism = "arm.toml"
[parameters]
m_1 = { value = 4, unit = "kg", std = 0.2 }
m_2 = { value = 2, unit = "kg", std = 0.1 }
[channels]
q1   = { measures = "q1", unit = "rad" }
q2   = { measures = "q2", unit = "rad" }
q3   = { measures = "q3", unit = "rad" }
tau1 = { input = "tau1", unit = "N m", interpolation = "linear" }
tau2 = { input = "tau2", unit = "N m", interpolation = "linear" }
tau3 = { input = "tau3", unit = "N m", interpolation = "linear" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

/// A frequency in rad/s of each joint's motion, and others that have no ratio to it.
const FREQUENCIES: [f64; 3] = [1.1, 1.7, 2.3];

/// Position, rate and acceleration of a joint.
fn joint(t: f64, joint: usize, phase: f64) -> [f64; 3] {
    let mut motion = [0.0; 3];
    for (harmonic, size) in [(1.0, 0.6), (2.2, 0.25), (3.7, 0.08)] {
        let frequency = FREQUENCIES[joint] * harmonic;
        let (sin, cos) = (frequency * t + phase * harmonic).sin_cos();
        motion[0] += size * sin;
        motion[1] += size * frequency * cos;
        motion[2] -= size * frequency * frequency * sin;
    }
    motion
}

/// The inputs of an arm with this spec.
fn run(spec: &str, phase: f64) -> String {
    let derived = derived("rig.toml", spec).unwrap();
    let model = JitModel::new(derived.functions()).unwrap();
    let p: Vec<f64> = model
        .info()
        .parameters
        .iter()
        .map(|one| one.value)
        .collect();
    let mut dice = Random::new(phase.to_bits());
    let mut table = "t,q1,q2,q3,tau1,tau2,tau3\n".to_owned();
    for row in 0..2000 {
        let t = f64::from(row) * 0.01;
        let joints = [0, 1, 2].map(|one| joint(t, one, phase));
        let mut x = joints.map(|[_, rate, _]| rate).to_vec();
        x.extend(joints.map(|[position, ..]| position));
        let accelerations = joints.map(|[.., acceleration]| acceleration);
        let demand = |u: [f64; 3]| {
            let mut demand = vec![0.0; 3];
            let at = At {
                t,
                x: &x,
                u: &u,
                p: &p,
            };
            model.inverse_dynamics(at, &accelerations, &mut demand);
            demand
        };
        let without = demand([0.0; 3]);
        // Each input drives its own joint.
        let with = demand([1.0; 3]);
        let tau = without.iter().zip(&with);
        let tau = tau.map(|(without, with)| without / (without - with));
        write!(table, "{t:.2}").unwrap();
        for [position, ..] in joints {
            write!(table, ",{:.7}", position + 5e-5 * dice.normal()).unwrap();
        }
        for tau in tau {
            write!(table, ",{:.6}", tau + 0.05 * dice.normal()).unwrap();
        }
        table.push('\n');
    }
    table
}

/// Recordings of a rig, beside the spec of the arm as it should be.
fn recorded(rig: &str, phases: [f64; 3]) -> Folder {
    let folder = Folder::new();
    folder
        .write("arm.toml", ARM)
        .write("recording.toml", RECORDED);
    for (name, phase) in ["a.csv", "b.csv", "c.csv"].into_iter().zip(phases) {
        folder.write(name, run(rig, phase));
    }
    folder
}

/// Of an arm whose spec has these items more.
fn report(items: &str) -> Report {
    let folder = recorded(&format!("{ARM}{items}"), [0.3, 1.9, 4.1]);
    let effects = appell_gap::effects::shipped().unwrap();
    let set = folder.read().unwrap();
    diagnose(&set, &effects, &Options::default(), |_| ()).unwrap()
}

/// Effects that make up more than a fiftieth of the gap.
fn material(report: &Report) -> Vec<&str> {
    let far = report.how_far.as_ref().unwrap();
    let effects = far
        .budget
        .iter()
        .filter(|part| part.is_effect() && part.is_material);
    effects.map(|part| part.name.as_str()).collect()
}

#[test]
fn an_arm_as_its_spec_has_no_gap() {
    let report = report("");
    assert!(report.is_by_forces);
    assert_eq!(report.verdict, GapVerdict::NoGap, "{:?}", report.which);
}

#[test]
fn friction_of_every_drive_is_one_cause_with_a_size_for_each() {
    let report = report(&friction(1.0));
    assert_eq!(report.verdict, GapVerdict::Explained);
    let mut found = material(&report);
    found.sort_unstable();
    assert_eq!(
        found,
        ["coulomb_friction@drives", "viscous_friction@drives"]
    );
    let of = |name: &str| {
        let mut values = report.which[0].parameters.iter();
        values.find(|value| value.name == name).unwrap()
    };
    for (name, true_value) in [
        ("coulomb_friction@drives.q1_force", 3.0),
        ("coulomb_friction@drives.q2_force", 4.0),
        ("coulomb_friction@drives.q3_force", 1.0),
        ("viscous_friction@drives.q1_coefficient", 1.5),
        ("viscous_friction@drives.q2_coefficient", 2.0),
        ("viscous_friction@drives.q3_coefficient", 0.5),
    ] {
        let value = of(name);
        let off = (value.value - true_value).abs();
        assert!(
            off < 3.0 * value.std && off < 0.2 * true_value,
            "{name}: {value:?}"
        );
    }
    let far = report.how_far.as_ref().unwrap();
    assert!(far.closed > 0.98, "{far:?}");
}

#[test]
fn friction_of_one_joint_is_not_that_of_all() {
    let report = report(
        "friction = { kind = \"generalized\", coordinate = \"q2\", force = \
         \"-3 [N*m]*smooth_sign(dot(q2), 0.01 [rad/s])\" }\n",
    );
    assert_eq!(report.verdict, GapVerdict::Explained, "{:?}", report.which);
    assert_eq!(material(&report), ["coulomb_friction@q2"]);
}

#[test]
fn a_drive_that_is_too_weak_has_a_gain_and_no_friction() {
    let rig = ARM.replace("force = \"tau2\"", "force = \"0.9*tau2\"");
    assert_ne!(rig, ARM);
    let folder = recorded(ARM, [0.3, 1.9, 4.1]);
    folder.write("arm.toml", &rig);
    let effects = appell_gap::effects::shipped().unwrap();
    let set = folder.read().unwrap();
    let report = diagnose(&set, &effects, &Options::default(), |_| ()).unwrap();
    assert_eq!(
        material(&report),
        ["actuator_gain@tau2"],
        "{:?}",
        report.which
    );
    let gain = &report.which[0].parameters[0];
    assert!((gain.value - 1.0 / 9.0).abs() < 0.01, "{gain:?}");
}

#[test]
fn a_payload_beside_the_centre_of_its_link_is_found_with_its_place() {
    let folder = recorded(&ARM.replace("[bodies]", TOOL), [0.3, 1.9, 4.1]);
    let effects = appell_gap::effects::shipped().unwrap();
    let set = folder.read().unwrap();
    let report = diagnose(&set, &effects, &Options::default(), |_| ()).unwrap();
    assert_eq!(material(&report), ["payload@fore"], "{:?}", report.which);
    for (name, true_value) in [
        ("payload@fore.mass", 0.5),
        ("payload@fore.x", 0.1),
        ("payload@fore.y", 0.05),
        ("payload@fore.z", -0.12),
    ] {
        let mut values = report.which[0].parameters.iter();
        let value = values.find(|value| value.name == name).unwrap();
        let off = (value.value - true_value).abs();
        assert!(
            off < 3.0 * value.std && off < 0.1 * true_value.abs().max(0.1),
            "{name}: {value:?}"
        );
    }
}

/// The tool is in the first and the third run.
#[test]
fn a_known_payload_of_some_runs_is_no_gap() {
    let folder = recorded(ARM, [0.3, 1.9, 4.1]);
    let with = ARM.replace("[bodies]", TOOL);
    folder
        .write("a.csv", run(&with, 0.3))
        .write("c.csv", run(&with, 4.1));
    let verdict = || {
        let effects = appell_gap::effects::shipped().unwrap();
        let set = folder.read().unwrap();
        diagnose(&set, &effects, &Options::default(), |_| ())
            .unwrap()
            .verdict
    };
    assert_ne!(verdict(), GapVerdict::NoGap);
    let payload = "payload = { on = \"G_2\", mass = 0.5, at = [0.1, 0.05, -0.12] }";
    let known = format!("{RECORDED}[run.\"a.csv\"]\n{payload}\n[run.\"c.csv\"]\n{payload}\n");
    folder.write("recording.toml", known);
    assert_eq!(verdict(), GapVerdict::NoGap);
}

/// A tool beside the last link.
const TOOL: &str = r#"
tool = { from = "G_2", in = "fore", at = ["0.1 [m]", "0.05 [m]", "-0.12 [m]"] }
[bodies]
tool = { centre = "tool", mass = "0.5 [kg]" }
"#;

#[test]
fn what_the_library_lacks_gets_no_name_of_it() {
    let report = report(
        "ripple = { kind = \"generalized\", coordinate = \"q2\", force = \"3 [N*m]*sin(25*q2)\" }\n",
    );
    assert_eq!(
        report.verdict,
        GapVerdict::Unexplained,
        "{:?}",
        report.which
    );
}

/// Friction of all joints, by parts of what is typical.
fn friction(size: f64) -> String {
    let of = |joint: usize, dry: f64, viscous: f64| {
        let (dry, viscous) = (size * dry, size * viscous);
        format!(
            "friction_{joint} = {{ kind = \"generalized\", coordinate = \"q{joint}\", force = \
             \"-{dry} [N*m]*smooth_sign(dot(q{joint}), 0.01 [rad/s]) - {viscous} [N*m*s/rad]*dot(q{joint})\" }}\n"
        )
    };
    [of(1, 3.0, 1.5), of(2, 4.0, 2.0), of(3, 1.0, 0.5)].concat()
}

/// A change of the arm.
struct Case {
    name: &'static str,
    /// Its spec after the change.
    now: fn(&str) -> String,
    /// Words of which effects that name it have one; none where nothing changed.
    right: &'static [&'static str],
}

const LOAD: &str = r#"
[points.tip]
from = "elbow"
in = "fore"
at = ["0.4 [m]", 0, 0]

[bodies.load]
centre = "tip"
mass = "0.5 [kg]"
"#;

const CASES: [Case; 6] = [
    Case {
        name: "nothing",
        now: str::to_owned,
        right: &[],
    },
    Case {
        name: "a load at the end",
        now: |spec| format!("{spec}{LOAD}"),
        right: &["fore", "m_2"],
    },
    Case {
        name: "a drive that got weaker",
        now: |spec| spec.replace("force = \"tau2\"", "force = \"0.8*tau2\""),
        right: &["tau2"],
    },
    Case {
        name: "a heavier link",
        now: |spec| spec.replace("m_1 = { value = 4", "m_1 = { value = 5.5"),
        right: &["m_1"],
    },
    Case {
        name: "a spring",
        now: |spec| {
            let force = "\"-2 [N*m/rad]*q3\"";
            format!(
                "{spec}spring = {{ kind = \"generalized\", coordinate = \"q3\", force = {force} }}\n"
            )
        },
        right: &["spring@q3"],
    },
    Case {
        name: "dry friction of a joint",
        now: |spec| spec.replace("-4 [N*m]", "-8 [N*m]"),
        right: &["coulomb_friction_drives_q2_force", "coulomb_friction@q2"],
    },
];

impl Case {
    /// Whether friction of all drives before and now, and this change now, are told as such.
    fn is_told(&self, first: f64) -> bool {
        let before = format!("{ARM}{}", friction(1.0));
        let phases = |first: f64| [first, first + 1.6, first + 3.8];
        let effects = appell_gap::effects::shipped().unwrap();
        let (was, is) = (phases(first), phases(first + 0.7));
        let folders = [recorded(&before, was), recorded(&(self.now)(&before), is)];
        let [before, now] = folders.map(|folder| folder.read().unwrap());
        let report = against(&before, &now, &effects, &Options::default(), |_| ()).unwrap();
        let change = report.change.as_ref().unwrap();
        let found = &report.which[0].effects;
        let is_named = |one: &String| self.right.iter().any(|word| one.contains(word));
        change.is_changed != self.right.is_empty()
            && (self.right.is_empty() || found.iter().any(is_named))
    }
}

#[test]
fn changes_of_an_arm_are_told_by_its_forces_and_another_motion_is_none() {
    // The table of docs/gap-diagnosis.md has all cases, and more motions.
    for case in &CASES[..3] {
        assert!(case.is_told(0.3), "{}", case.name);
    }
}
