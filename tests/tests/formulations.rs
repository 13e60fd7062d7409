//! Appell's equations, Kane's and Lagrange's with multipliers are three ways to one motion.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::formulations::{Against, Agreement, FormulationComparison, compare};
use appell_codegen::mechanics::Derivation;
use appell_tests::formulations::{assert_agreement, assert_one_answer, verdict};
use appell_tests::shipped;

/// Bound on the probability that anything here was taken for identical though it is not. It grows with
/// the degree of the equations; that of the bicycle is the highest.
const ERROR: f64 = 1e-8;

fn is_proven(verdict: &FormulationComparison) -> bool {
    let mut all = verdict.comparisons.iter();
    all.all(|c| c.agreement == Agreement::Identical) && verdict.error_bound < ERROR
}

#[test]
fn appell_kane_and_lagrange_are_proved_identical_for_every_shipped_mechanism() {
    for name in shipped::names() {
        let derivation = shipped::derivation(&name);
        let verdict = assert_agreement(shipped::mechanism(&name), &derivation);
        assert!(is_proven(&verdict), "{name}: {verdict:#?}");
    }
}

#[test]
fn reactions_that_cannot_be_told_are_not_judged() {
    for mechanism in shipped::mechanisms_in("codegen/tests/audit/right") {
        assert_one_answer(&mechanism);
    }
    // A pendulum beside the wheel: the ground holds it as well.
    let text = shipped::text("rolling_wheel")
        .replace("[coordinates]", "[coordinates]\nswing = { unit = 'rad' }")
        .replace(
            "[frames]",
            "[frames]\narm = { parent = 'ground', about_axis = 'x', by = 'swing' }",
        )
        .replace(
            "[points]",
            "[points]\nB = { from = 'O', in = 'arm', at = [0, 0, '-R'] }",
        )
        .replace(
            "[constraints]",
            "[bodies.bob]\ncentre = 'B'\nmass = 'm'\n[constraints]",
        )
        .replace(
            "[pseudo_velocities]",
            "[pseudo_velocities]\nrate = 'dot(swing)'",
        );
    assert_one_answer(&shipped::read("beside.toml", &text));
}

/// A body on a ball joint with rotors about its axes, all by `quaternion` and angles.
fn gyroscope(rotors: &[&str]) -> String {
    let each =
        |line: &dyn Fn(&str) -> String| -> String { rotors.iter().map(|k| line(k)).collect() };
    let angles = each(&|k| format!("q_{k} = {{ unit = 'rad' }}\n"));
    let frames =
        each(&|k| format!("rotor_{k} = {{ parent = 'body', about_axis = '{k}', by = 'q_{k}' }}\n"));
    let bodies = each(&|k| {
        format!(
            "[bodies.rotor_{k}]\nframe = 'rotor_{k}'\ncentre = 'G'\nmass = 'm'\ninertia = {{ in = 'rotor_{k}', diagonal = ['J', 'J', 'J'] }}\n"
        )
    });
    let speeds = each(&|k| format!("s_{k} = {{ value = 'dot(q_{k})', unit = 'rad/s' }}\n"));
    format!(
        r#"
[mechanism]
name = "gyroscope"
title = "Gyroscope on a ball joint"
[parameters]
m = {{ value = 2, unit = "kg" }}
l = {{ value = 0.1, unit = "m" }}
A = {{ value = 0.02, unit = "kg*m^2" }}
B = {{ value = 0.03, unit = "kg*m^2" }}
C = {{ value = 0.045, unit = "kg*m^2" }}
J = {{ value = 0.004, unit = "kg*m^2" }}
g = {{ value = 9.81, unit = "m/s^2" }}
[coordinates]
e0 = {{ unit = "1" }}
e1 = {{ unit = "1" }}
e2 = {{ unit = "1" }}
e3 = {{ unit = "1" }}
{angles}
[frames]
body = {{ parent = "ground", quaternion = ["e0", "e1", "e2", "e3"] }}
{frames}
[points]
G = {{ from = "O", in = "body", at = [0, "0.2*l", "l"] }}
[bodies.body]
frame = "body"
centre = "G"
mass = "m"
inertia = {{ in = "body", diagonal = ["A", "B", "C"] }}
{bodies}
[pseudo_velocities]
w_x = {{ value = "angular_velocity(body, x, body)", unit = "rad/s" }}
w_y = {{ value = "angular_velocity(body, y, body)", unit = "rad/s" }}
w_z = {{ value = "angular_velocity(body, z, body)", unit = "rad/s" }}
{speeds}
[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "g" }}
"#
    )
}

#[test]
fn bodies_on_quaternions_have_one_answer() {
    for rotors in [&[][..], &["z"], &["x", "y", "z"]] {
        let text = gyroscope(rotors);
        let verdict = assert_one_answer(&shipped::read("gyroscope.toml", &text));
        assert!(verdict.comparisons.len() > 1, "{verdict:#?}");
    }
}

#[test]
fn a_frame_on_a_quaternion_with_a_position_constraint_has_one_answer() {
    // The axis x of the body stays horizontal; its rotor spins.
    let text = gyroscope(&["z"])
        .replace("[pseudo_velocities]", "[constraints]\nlevel = { kind = 'position', zero = 'e1*e3 - e0*e2', dependent = 'e3' }\n[pseudo_velocities]")
        .replace("w_z = { value = \"angular_velocity(body, z, body)\", unit = \"rad/s\" }\n", "");
    assert_one_answer(&shipped::read("level.toml", &text));
}

/// What disagrees after a change to the derivation of the unicycle.
fn planted(change: impl FnOnce(&mut Derivation)) -> Vec<(Against, &'static str)> {
    let mechanism = shipped::mechanism("unicycle");
    let mut derivation = shipped::derive(mechanism);
    change(&mut derivation);
    let verdict = verdict(mechanism, &derivation);
    assert!(!verdict.agrees(), "{verdict:#?}");
    let differs = |agreement: &Agreement| matches!(agreement, Agreement::Different { .. });
    let differing = verdict.comparisons.iter().filter(|c| differs(&c.agreement));
    differing.map(|c| (c.against, c.quantity)).collect()
}

#[test]
fn a_wrong_sign_in_the_bias_is_found() {
    let found = planted(|d| d.gibbs.bias[0] = d.algebra.graph.neg(d.gibbs.bias[0]));
    assert_eq!(found, [(Against::Kane, "bias")]);
}

#[test]
fn a_forgotten_term_of_the_mass_matrix_is_found() {
    let found = planted(|d| {
        let mass = d.symbols.parameters[0];
        let entry = &mut d.gibbs.mass_matrix[1][2];
        *entry = d.algebra.graph.sub(*entry, mass);
    });
    assert_eq!(found, [(Against::Kane, "mass matrix")]);
}

#[test]
fn a_wrong_pseudo_force_is_found() {
    let found = planted(|d| d.forces[0] = d.algebra.graph.neg(d.forces[0]));
    assert_eq!(found, [(Against::Kane, "forces")]);
}

#[test]
fn a_wrong_acceleration_is_found_by_all_who_know_it() {
    let found = planted(|d| {
        let last = d.motion.accelerations.last_mut().unwrap();
        *last = d.algebra.graph.neg(*last);
    });
    assert_eq!(
        found,
        [
            (Against::Kane, "accelerations"),
            (Against::Lagrange, "accelerations"),
            (Against::Lagrange, "constraint forces"),
        ]
    );
}

#[test]
fn generalised_velocities_that_slip_are_found() {
    let found = planted(|d| {
        let first = &mut d.velocities.rates[0];
        *first = d.algebra.graph.neg(*first);
    });
    assert!(found.contains(&(Against::Spec, "constraints")), "{found:?}");
}

#[test]
fn an_error_of_a_millionth_is_found() {
    let found = planted(|d| {
        let nearly = d.algebra.graph.fraction(999_999, 1_000_000);
        d.gibbs.bias[2] = d.algebra.graph.mul(nearly, d.gibbs.bias[2]);
    });
    assert_eq!(found, [(Against::Kane, "bias")]);
}

/// The length of a spring on a line is a root of a square: the test cannot tell its sign.
const LINE: &str = r#"
[mechanism]
name = "line"
title = "Mass on a line between two springs"
[parameters]
m = { value = 2, unit = "kg" }
k = { value = 30, unit = "N/m" }
l = { value = 0.3, unit = "m" }
[coordinates]
x = { unit = "m", range = [0.1, 1], initial = 0.5 }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0] }
Q = { from = "O", in = "ground", at = ["2 [m]", 0, 0] }
[bodies]
mass = { centre = "P", mass = "m" }
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
[loads]
left = { kind = "spring", between = ["O", "P"], stiffness = "k", relaxed = "l" }
right = { kind = "spring", between = ["P", "Q"], stiffness = "k", relaxed = "l" }
"#;

#[test]
fn what_cannot_be_proven_is_compared_at_points() {
    let mechanism = shipped::read("line", LINE);
    let verdict = assert_one_answer(&mechanism);
    let points = |agreement: &Agreement| matches!(agreement, Agreement::AtPoints { points, .. } if *points > 8);
    assert!(
        verdict.comparisons.iter().any(|c| points(&c.agreement)),
        "{verdict:#?}"
    );
    // And an error is seen there as well.
    let mut derivation = shipped::derive(&mechanism);
    derivation.forces[0] = derivation.algebra.graph.neg(derivation.forces[0]);
    assert!(!compare(&mechanism, &derivation).unwrap().agrees());
}
