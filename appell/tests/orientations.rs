//! Orientations by unit quaternions: against angles, conservation laws and closed forms.

use appell::setup::Assignment;
use appell::{Method, Model, Motion};

/// A body with three moments of inertia whose centre is beside its base point, in free fall or on a ball joint.
fn spec(coordinates: &str, frame: &str, base: &str, speeds: &str, weight: &str) -> String {
    format!(
        r#"
[mechanism]
name = "body"
title = "A rigid body"
[parameters]
m = {{ value = 2, unit = "kg" }}
l = {{ value = 0.1, unit = "m" }}
A = {{ value = 0.02, unit = "kg*m^2" }}
B = {{ value = 0.03, unit = "kg*m^2" }}
C = {{ value = 0.045, unit = "kg*m^2" }}
[coordinates]
{coordinates}
[frames]
body = {{ parent = "ground", {frame} }}
[points]
P = {{ from = "O", in = "ground", at = {base} }}
G = {{ from = "P", in = "body", at = ["0.3 [m]", "l", "0.1 [m]"] }}
Q = {{ from = "P", in = "body", at = [0, "1 [m]", "2 [m]"] }}
[bodies]
body = {{ frame = "body", centre = "G", mass = "m", inertia = {{ in = "body", diagonal = ["A", "B", "C"] }} }}
[pseudo_velocities]
{speeds}
w_x = {{ value = "angular_velocity(body, x, body)", unit = "rad/s", initial = 0.1 }}
w_y = {{ value = "angular_velocity(body, y, body)", unit = "rad/s", initial = 6 }}
w_z = {{ value = "angular_velocity(body, z, body)", unit = "rad/s", initial = 0.2 }}
[loads]
{weight}
[outputs]
x_Q = {{ value = "position(Q, x)" }}
y_Q = {{ value = "position(Q, y)" }}
z_Q = {{ value = "position(Q, z)" }}
v_Q = {{ value = "velocity(Q, z)" }}
a_Q = {{ value = "acceleration(Q, x)" }}
"#
    )
}

const QUATERNION: &str = r#"
e0 = { unit = "1" }
e1 = { unit = "1" }
e2 = { unit = "1" }
e3 = { unit = "1" }
"#;
const BY_QUATERNION: &str = r#"quaternion = ["e0", "e1", "e2", "e3"]"#;
const ANGLES: &str = r#"
psi   = { unit = "rad" }
theta = { unit = "rad", range = [-1.5, 1.5] }
phi   = { unit = "rad" }
"#;
const BY_ANGLES: &str = r#"turns = [{ about_axis = "z", by = "psi" }, { about_axis = "x", by = "theta" }, { about_axis = "y", by = "phi" }]"#;
const PLACE: &str = r#"
x = { unit = "m" }
y = { unit = "m" }
z = { unit = "m" }
"#;
const MOVING: &str = r#"
v_x = { value = "dot(x)", initial = 0.5 }
v_y = { value = "dot(y)", initial = -0.3 }
v_z = { value = "dot(z)", initial = 1.1 }
"#;
const WEIGHT: &str = r#"weight = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }"#;
const ON_A_JOINT: &str = "[0, 0, 0]";
const ANYWHERE: &str = r#"["x", "y", "z"]"#;

fn motion(t_end: f64, tolerance: f64) -> Motion {
    let mut motion = Motion::new(t_end);
    motion.method = Method::Dop853;
    motion.options.rtol = tolerance;
    motion.options.atol = tolerance;
    motion
}

/// Columns of a motion by their names.
fn columns(spec: &str, motion: &Motion, names: &[&str]) -> Vec<Vec<f64>> {
    let model = Model::from_spec(spec).unwrap_or_else(|error| panic!("{error}"));
    let done = model
        .simulate(motion)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(done.failure, None);
    let column = |name: &&str| done.trajectory.column(name).unwrap();
    names.iter().map(column).collect()
}

#[test]
fn quaternions_and_angles_describe_one_motion() {
    let outputs = ["x_Q", "y_Q", "z_Q", "v_Q", "a_Q"];
    let free = |coordinates: &str, frame| {
        spec(
            &format!("{PLACE}{coordinates}"),
            frame,
            ANYWHERE,
            MOVING,
            WEIGHT,
        )
    };
    let held = |coordinates: &str, frame| spec(coordinates, frame, ON_A_JOINT, "", WEIGHT);
    for [by_quaternion, by_angles] in [
        [free(QUATERNION, BY_QUATERNION), free(ANGLES, BY_ANGLES)],
        [held(QUATERNION, BY_QUATERNION), held(ANGLES, BY_ANGLES)],
    ] {
        // Until the angles come close to their pole.
        let motion = motion(0.6, 1e-12);
        let all = columns(&by_quaternion, &motion, &outputs);
        let others = columns(&by_angles, &motion, &outputs);
        for (name, (ours, theirs)) in outputs.iter().zip(all.iter().zip(&others)) {
            for (a, b) in ours.iter().zip(theirs) {
                assert!(
                    (a - b).abs() < 1e-8 * (1.0 + a.abs()),
                    "{name}: {a} and {b}"
                );
            }
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

#[test]
fn a_tumbling_body_keeps_energy_momentum_and_norm_for_a_thousand_revolutions() {
    let text = spec(QUATERNION, BY_QUATERNION, ON_A_JOINT, "", "")
        .replace("[\"0.3 [m]\", \"l\", \"0.1 [m]\"]", "[0, 0, 0]");
    let names = [
        "e0",
        "e1",
        "e2",
        "e3",
        "w_x",
        "w_y",
        "w_z",
        "kinetic_energy",
    ];
    let mut long = motion(1100.0, 1e-13);
    long.interval = Some(0.5);
    let columns = columns(&text, &long, &names);
    let at = |row: usize| -> [f64; 8] { std::array::from_fn(|column| columns[column][row]) };
    // h + 2 v × (v × h + w h) in the ground.
    let momentum = |[w, x, y, z, a, b, c, _]: [f64; 8]| {
        let (v, h) = ([x, y, z], [0.02 * a, 0.03 * b, 0.045 * c]);
        let once = cross(v, h);
        let inner: [f64; 3] = std::array::from_fn(|k| once[k] + w * h[k]);
        let twice = cross(v, inner);
        std::array::from_fn(|k| h[k] + 2.0 * twice[k])
    };
    let length = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let (first, rows) = (at(0), columns[0].len());
    let mut turned = 0.0;
    for row in 0..rows {
        let now = at(row);
        let norm: f64 = now[..4].iter().map(|e| e * e).sum();
        assert!((norm.sqrt() - 1.0).abs() < 1e-14, "{norm}");
        assert!((now[7] / first[7] - 1.0).abs() < 1e-10, "energy {}", now[7]);
        let (before, after): ([f64; 3], [f64; 3]) = (momentum(first), momentum(now));
        let off = length(std::array::from_fn(|k| after[k] - before[k])) / length(before);
        assert!(off < 1e-10, "momentum off by {off:e}");
        turned += 0.5 * length([now[4], now[5], now[6]]);
    }
    assert!(turned > 1000.0 * std::f64::consts::TAU, "{turned}");
}

#[test]
fn a_body_on_a_ball_joint_swings_through_every_attitude() {
    // Its weight and the joint let it pass the poles of all angles.
    let text = spec(QUATERNION, BY_QUATERNION, ON_A_JOINT, "", WEIGHT);
    let mut long = motion(20.0, 1e-12);
    long.initial = vec![Assignment::new("w_x", "9")];
    let columns = columns(&text, &long, &["kinetic_energy", "potential_energy", "z_Q"]);
    let total = |row: usize| columns[0][row] + columns[1][row];
    let size = columns[0].iter().fold(0.0, |a: f64, b| a.max(*b));
    for row in 0..columns[0].len() {
        assert!((total(row) - total(0)).abs() < 1e-9 * size);
    }
    let lowest = columns[2].iter().fold(f64::INFINITY, |a, b| a.min(*b));
    let highest = columns[2].iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    assert!(lowest < -1.5 && highest > 1.5, "{lowest} to {highest}");
}

#[test]
fn no_initial_value_need_be_normalised() {
    let text = spec(QUATERNION, BY_QUATERNION, ON_A_JOINT, "", "")
        .replace(
            "e1 = { unit = \"1\" }",
            "e1 = { unit = \"1\", initial = 3 }",
        )
        .replace(
            "e0 = { unit = \"1\" }",
            "e0 = { unit = \"1\", initial = -4 }",
        );
    let model = Model::from_spec(&text).unwrap();
    let setup = model.setup().unwrap();
    let place = |name: &str| model.info().state_index(name).unwrap();
    let x = &setup.initial;
    assert!((x[place("e0")] + 0.8).abs() < 1e-15 && (x[place("e1")] - 0.6).abs() < 1e-15);
}
