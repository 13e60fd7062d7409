//! Position constraints against the same mechanism in coordinates that satisfy them by themselves.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::Simulation;
use appell_runtime::linearise::{Linearisation, Undetermined};
use appell_runtime::model::{At, Model};
use appell_runtime::simulate::SimulationError;
use appell_runtime::trajectory::Trajectory;
use appell_tests::formulations::assert_one_answer;
use appell_tests::shipped;

/// Two integrations at tolerances of 1e-12 over seconds.
const MOTION: f64 = 1e-9;

/// A bob on a rod whose upper end moves up and down, in Cartesian coordinates.
const ROD: &str = r#"
[mechanism]
name = "rod"
title = "Pendulum with a moving pivot, by its rod"
[parameters]
m = { value = 2, unit = "kg" }
l = { value = 0.5, unit = "m" }
a = { value = 0.1, unit = "m" }
rate = { value = 7, unit = "rad/s" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
x = { unit = "m", initial = 0.3 }
z = { unit = "m", initial = -0.4 }
[points]
G = { from = "O", in = "ground", at = ["x", 0, "z"] }
[bodies]
bob = { centre = "G", mass = "m" }
[constraints]
length = { kind = "position", zero = "x^2 + (z - a*sin(rate*t))^2 - l^2" }
[pseudo_velocities]
v = { value = "(x*dot(z) - z*dot(x))/l", unit = "m/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
"#;

/// The same by its angle.
const ANGLE: &str = r#"
[mechanism]
name = "angle"
title = "Pendulum with a moving pivot, by its angle"
[parameters]
m = { value = 2, unit = "kg" }
l = { value = 0.5, unit = "m" }
a = { value = 0.1, unit = "m" }
rate = { value = 7, unit = "rad/s" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
theta = { unit = "rad" }
[points]
G = { from = "O", in = "ground", at = ["l*sin(theta)", 0, "a*sin(rate*t) - l*cos(theta)"] }
[bodies]
bob = { centre = "G", mass = "m" }
[pseudo_velocities]
w = { value = "dot(theta)", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
[outputs]
x = { value = "l*sin(theta)", unit = "m" }
z = { value = "a*sin(rate*t) - l*cos(theta)", unit = "m" }
"#;

fn model(text: &str) -> InterpretedModel {
    let program = appell_codegen::compile("positions.toml", text, &FunctionKind::STANDARD);
    InterpretedModel::new(program.unwrap_or_else(|report| panic!("{}", report.plain())))
}

fn run(model: &dyn Model, x: &[f64]) -> Result<Trajectory, SimulationError> {
    let mut simulation = Simulation::new(model);
    simulation.initial_state = x.to_vec();
    simulation.span = [0.0, 3.0];
    simulation.options.rtol = 1e-12;
    simulation.options.atol = 1e-12;
    simulation.run()
}

/// About hanging still: x = 0, z = -l, with a pivot that does not move.
fn hanging(model: &dyn Model) -> Result<Linearisation, Undetermined> {
    let info = model.info();
    let mut p = info.default_parameters();
    p[info.parameter_index("a").unwrap()] = 0.0;
    let mut x = vec![0.0; info.states.len()];
    x[info.state_index("z").unwrap()] = -0.5;
    let u = Vec::new();
    let at = At {
        t: 0.0,
        x: &x,
        u: &u,
        p: &p,
    };
    Linearisation::about(model, at)
}

#[test]
fn a_multiplier_has_the_unit_of_power_over_the_constrained_rate() {
    let model = model(ROD);
    let reaction = &model.info().reactions[0];
    // The constraint is an area: W over m²/s.
    assert_eq!((&*reaction.name, &*reaction.unit), ("length", "N/m"));
}

#[test]
fn a_hanging_pendulum_is_linearised_in_the_coordinate_that_is_free() {
    let text = ROD.replace("- l^2\"", "- l^2\", dependent = \"z\"");
    let model = model(&text);
    let linear = hanging(&model).unwrap();
    let [v, x] = ["v", "x"].map(|name| model.info().state_index(name).unwrap());
    assert_eq!(linear.states, [v, x]);
    let wanted = [0.0, -9.81 / 0.5, 1.0, 0.0];
    for (found, wanted) in linear.a.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-12, "{linear:?}");
    }
    assert_eq!(linear.dependence, [0.0, 0.0]);
}

#[test]
fn where_the_declared_coordinate_does_not_follow_another_one_does() {
    let declared = |q: &str| ROD.replace("- l^2\"", &format!("- l^2\", dependent = \"{q}\""));
    let [by_x, by_z] = ["x", "z"].map(|q| hanging(&model(&declared(q))).unwrap());
    assert_eq!(by_x, by_z);
}

#[test]
fn a_rod_with_a_moving_end_swings_like_a_pendulum() {
    let (rod, angle) = (model(ROD), model(ANGLE));
    let theta = 0.3_f64.atan2(0.4);
    // The pivot starts upward at a·rate, so w = 0 is v = x·a·rate/l.
    let start = 0.3 * 0.1 * 7.0 / 0.5;
    let by_rod = run(&rod, &[start, 0.3, -0.4]).unwrap();
    let by_angle = run(&angle, &[0.0, theta]).unwrap();
    let end = by_angle.last_state()[1];
    let wanted = [0.5 * end.sin(), 0.1 * 21.0_f64.sin() - 0.5 * end.cos()];
    let found = &by_rod.last_state()[1..];
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() < MOTION, "{found} against {wanted}");
    }
    for row in 0..by_rod.len() {
        let [_, x, z] = by_rod.state(row) else {
            panic!()
        };
        let pivot = 0.1 * (7.0 * by_rod.times()[row]).sin();
        let off = (x.hypot(z - pivot) - 0.5).abs();
        assert!(off < 1e-14, "the rod is off by {off:e} m");
    }
}

#[test]
fn the_rod_moves_as_kane_and_lagrange_say() {
    assert_one_answer(&shipped::read("rod", ROD));
    assert_one_answer(&shipped::read("angle", ANGLE));
}

#[test]
fn a_guess_becomes_a_consistent_start() {
    let rod = model(ROD);
    assert_eq!(rod.dependent_coordinates(), [0]);
    let motion = run(&rod, &[0.0, 0.2, -0.4]).unwrap();
    let start = motion.state(0);
    assert!((start[1] - 0.3).abs() < 1e-15, "x becomes {}", start[1]);
    assert!((start[2] + 0.4).abs() < f64::EPSILON, "z stays");
}

/// The motion stays the same where a constraint is stated twice, or as its derivative.
#[test]
fn a_repeated_constraint_is_left_out() {
    let alone = run(&model(ROD), &[0.0, 0.2, -0.4]).unwrap();
    for again in [
        r#"again = { kind = "position", zero = "2*l^2 - 2*x^2 - 2*(z - a*sin(rate*t))^2" }"#,
        r#"again = { kind = "velocity", zero = "x*dot(x) + (z - a*sin(rate*t))*dot(z)", equals = "(z - a*sin(rate*t))*a*rate*cos(rate*t)" }"#,
    ] {
        for place in ["length = {", "[pseudo_velocities]"] {
            let text = ROD.replace(place, &format!("{again}\n{place}"));
            let twice = model(&text);
            assert_eq!(twice.dependent_coordinates().len(), 1, "{text}");
            let motion = run(&twice, &[0.0, 0.2, -0.4]).unwrap();
            let (one, other) = (alone.state(alone.len() - 1), motion.state(motion.len() - 1));
            for (one, other) in one.iter().zip(other) {
                assert!((one - other).abs() < MOTION, "{one}, {other}: {text}");
            }
        }
    }
}

#[test]
fn a_start_that_nothing_makes_consistent_is_refused() {
    let refused = run(&model(ROD), &[0.0, 0.1, -2.0]).unwrap_err();
    assert!(
        matches!(refused, SimulationError::Inconsistent { .. }),
        "{refused}"
    );
    assert!(
        refused
            .to_string()
            .contains("no value of `x` near its initial one satisfies the position constraint"),
        "{refused}"
    );
}

#[test]
fn a_constraint_that_does_not_determine_the_named_coordinate_is_told() {
    let text = ROD.replace(
        "length = { kind = \"position\",",
        "length = { kind = \"position\", dependent = \"y\",",
    );
    let text = text.replace(
        "x = { unit = \"m\", initial = 0.3 }",
        "x = { unit = \"m\" }\ny = { unit = \"m\" }",
    );
    let Err(report) = appell_codegen::compile("y.toml", &text, &FunctionKind::STANDARD) else {
        panic!("accepted");
    };
    let text = report.plain();
    assert!(text.contains("`length` does not determine `y`"), "{text}");
}
