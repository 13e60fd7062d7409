//! Steady motions at high speeds, outside of ranges, and after whole turns.

use appell::Model;
use appell::steady::{Answer, Question};
use appell_analysis::{Kind, Stability, SteadyError, SteadyMotion};

fn found(model: &str, question: &Question) -> Vec<(SteadyMotion, Stability)> {
    match Model::shipped(model).unwrap().steady(question).unwrap() {
        Answer::Motions(motions) => motions,
        Answer::Branches(_) => panic!("no branches were asked for"),
    }
}

/// Eigenvalues at 12 m/s from M, C1, K0 and K2 of Meijaard et al. (2007), typed with this many digits.
const TYPED: f64 = 1e-7;

#[test]
fn straight_running_is_found_at_high_speeds_from_the_speed_alone() {
    let twelve = Question::default().fix("speed", 12);
    for question in [twelve.clone(), twelve.clone().fix("phi", 0)] {
        let motions = found("bicycle", &question);
        let values = motions[0].1.eigenvalues();
        for wanted in [-29.059_054_52, -4.689_882_11, 0.154_163_01] {
            let near = values.iter().map(|value| (value.re - wanted).abs());
            let off = near.fold(f64::INFINITY, f64::min);
            assert!(off < TYPED, "{wanted}: {values:?}");
        }
    }
    let small = Question::default()
        .fix("speed", 8)
        .set("r_R", 0.2)
        .set("r_F", 0.2);
    found("bicycle", &small);
    found("bicycle", &Question::default().fix("speed", 50));
    let straight = Question::default()
        .fix("speed", 20)
        .fix("psi_dot", 0)
        .fix("theta", 0);
    found("unicycle", &straight);
    let along = Question::default().along("speed", 12, 20);
    let branches = Model::shipped("bicycle").unwrap().steady(&along).unwrap();
    assert!(matches!(branches, Answer::Branches(branches) if !branches.is_empty()));
}

/// A bead on a hoop that turns, in equilibrium at the top, where the spec does not let it be.
const BEAD: &str = r#"
[mechanism]
name = "bead"
title = "bead"
[parameters]
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
phi = { unit = "rad", range = [RANGE], initial = 1 }
[pseudo_velocities]
w = "dot(phi)"
[points]
P = { from = "O", in = "ground", at = ["sin(phi)*(1 [m])", 0, "cos(phi)*(1 [m])"] }
[bodies]
b = { centre = "P", mass = "1 [kg]" }
[loads]
weight = { kind = "gravity", down = "z", acceleration = "g" }
push = { kind = "generalized", coordinate = "phi", force = "1 [N*m]" }
"#;

#[test]
fn a_range_that_excludes_all_motions_is_named() {
    let model = Model::from_spec(&BEAD.replace("RANGE", "0.5, 2")).unwrap();
    let question = Question::default();
    let error = model.steady(&question).err().unwrap();
    let Some(SteadyError::OutOfRange { outside }) = error.cause() else {
        panic!("{error:?}")
    };
    assert!(outside[0].starts_with("phi = "), "{outside:?}");
    assert!(outside[0].contains("range 0.5 to 2"), "{outside:?}");
    let admitted = Question {
        ignore_ranges: true,
        ..question
    };
    assert!(model.steady(&admitted).is_ok());
}

#[test]
fn angles_are_told_within_one_turn_and_equal_motions_once() {
    let model = Model::from_spec(&BEAD.replace(", range = [RANGE]", "")).unwrap();
    let Ok(Answer::Motions(motions)) = model.steady(&Question::default()) else {
        panic!("motions");
    };
    let angles: Vec<f64> = motions
        .iter()
        .map(|(motion, _)| motion.point.x[1])
        .collect();
    assert_eq!(angles.len(), 2, "{angles:?}");
    let turn = std::f64::consts::PI;
    assert!(angles.iter().all(|angle| angle.abs() <= turn), "{angles:?}");
}

/// A tractor with a trailer that is hitched behind its axle: at rest it may be at any angle.
const TRAILER: &str = r#"
[mechanism]
name = "tractor_trailer"
title = "Tractor with an off-axle trailer"
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
psi = { unit = "deg" }
phi = { unit = "deg", range = [-120, 120] }
[inputs]
F = { unit = "kN" }
M = { unit = "N*m" }
[frames]
tractor = { parent = "ground", about_axis = "z", by = "psi" }
trailer = { parent = "tractor", about_axis = "z", by = "phi" }
[points]
A = { from = "O", in = "ground", at = ["x", "y", 0] }
G = { from = "A", in = "tractor", at = ["0.9 [m]", 0, 0] }
H = { from = "A", in = "tractor", at = ["-0.6 [m]", 0, 0] }
T = { from = "H", in = "trailer", at = ["-2 [m]", 0, 0] }
Gt = { from = "H", in = "trailer", at = ["-1.6 [m]", 0, 0] }
[bodies]
tractor = { frame = "tractor", centre = "G", mass = "800 [kg]", inertia = "600 [kg*m^2]" }
trailer = { frame = "trailer", centre = "Gt", mass = "500 [kg]", inertia = "300 [kg*m^2]" }
[constraints]
axle = { kind = "fixed_velocity", point = "A", in = "tractor", direction = [0, 1, 0] }
trailing = { kind = "fixed_velocity", point = "T", in = "trailer", direction = [0, 1, 0] }
[pseudo_velocities]
v = { value = "velocity(A, x, tractor)", unit = "km/h" }
w = { value = "dot(psi)", unit = "deg/s" }
[loads]
drive = { kind = "force", on = "A", in = "tractor", vector = ["F", 0, 0] }
yaw = { kind = "torque", on = "tractor", in = "ground", vector = [0, 0, "M"] }
drag = { kind = "generalized", velocity = "velocity(T, x, trailer)", force = "-50 [N*s/m]*velocity(T, x, trailer)" }
"#;

#[test]
fn rests_at_one_speed_are_no_branch_that_turns_back() {
    let model = Model::from_spec(TRAILER).unwrap();
    let mut question = Question::default().fix("w", 0).along("v", -20, 20);
    question.free = vec!["F".to_owned()];
    let Answer::Branches(branches) = model.steady(&question).unwrap() else {
        panic!("branches were asked for");
    };
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let folds = specials.filter(|special| special.kind == Kind::Fold);
    assert_eq!(folds.count(), 0);
}
