//! Steady motions at high speeds, outside of ranges, and after whole turns.

use appell::steady::{Answer, Question};
use appell::{Error, Model};
use appell_analysis::{Stability, SteadyError, SteadyMotion};

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
    match model.steady(&question) {
        Err(Error::Steady(SteadyError::OutOfRange { outside })) => {
            assert!(outside[0].starts_with("phi = "), "{outside:?}");
            assert!(outside[0].contains("range 0.5 to 2"), "{outside:?}");
        }
        other => panic!("{:?}", other.err()),
    }
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
