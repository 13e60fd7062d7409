//! Controllers that the general code designs: those of the paper on steering, and others.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_models::Shipped;
use appell_runtime::control::controllability::{Controllability, output_rank};
use appell_runtime::control::operating_point::{MotionEquations, OperatingPoint};
use appell_runtime::control::placement;
use appell_runtime::control::reduction::{Subsystem, reduce};
use appell_runtime::model::Model;
use appell_tests::engine::assert_close;
use appell_tests::reference::{cases, number, numbers};
use nalgebra::Complex;

const LANE: &[&str] = &["omega_1", "theta", "sigma", "r", "psi", "y_G"];
const TURN: &[&str] = &["omega_1", "theta", "sigma", "r", "psi"];

fn model(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

/// The linear equations of straight rolling at a speed in m/s.
fn rolling(name: &str, speed: f64) -> MotionEquations {
    let model = model(name);
    let mut point = OperatingPoint::new(model);
    let info = model.info();
    point.x.fill(0.0);
    point.x[info.state_index("omega_2").unwrap()] = speed / 0.3;
    point.equations(&[0]).unwrap()
}

fn places(model: &dyn Model, equations: &MotionEquations, names: &[&str]) -> Vec<usize> {
    let place = |name: &&str| {
        let state = model.info().state_index(name).unwrap();
        equations.states.iter().position(|s| *s == state).unwrap()
    };
    names.iter().map(place).collect()
}

fn steered(speed: f64, outputs: &[&str]) -> Subsystem {
    let equations = rolling("unicycle", speed);
    let outputs = places(model("unicycle"), &equations, outputs);
    reduce(&equations.system, &outputs).unwrap()
}

/// Ten digits.
const GAINS: f64 = 1e-10;

#[test]
fn placed_gains_are_the_exact_ones_of_the_reference() {
    let Some(cases) = cases("gains.json") else {
        return;
    };
    for case in cases {
        let outputs = if case["maneuver"] == "lane_change" {
            LANE
        } else {
            TURN
        };
        let speed = number(&case["speed_m_s"]);
        let poles = vec![Complex::from(number(&case["pole"])); outputs.len()];
        let placed = placement::place(&steered(speed, outputs).system, &poles).unwrap();
        let wanted = numbers(&case["K"]);
        for (gain, wanted) in placed.gain.iter().zip(&wanted) {
            assert_close("gain", &[*gain], &[*wanted], GAINS, 0.0);
        }
    }
}

#[test]
fn a_slider_steers_six_dimensions_while_rolling_and_four_at_rest() {
    for (speed, rank) in [(5.0, 6), (1.0, 6), (0.1, 6), (0.0, 4)] {
        let equations = rolling("unicycle", speed);
        let c = Controllability::of(&equations.system).unwrap();
        assert_eq!(c.rank, rank);
        let outputs = places(model("unicycle"), &equations, LANE);
        assert_eq!(output_rank(&equations.system, &outputs), rank);
    }
}
