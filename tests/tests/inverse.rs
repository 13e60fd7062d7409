//! Inverse dynamics finds the inputs that made a motion, and relations that hold without them.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::inverse::{InputEquations, InverseError};
use appell_models::Shipped;
use appell_runtime::model::{At, Model};
use appell_spectra::singular::Singular;
use appell_test_kit::Random;
use appell_tests::point::Point;
use appell_tests::reference::{cases, number};
use appell_tests::shipped;

/// Twelve digits of the largest torque in the reference.
const REFERENCE: f64 = 1e-12;
/// Rounding of the equations, times the condition of M.
const ROUNDING: f64 = 1e-9;
/// Random points per mechanism.
const POINTS: usize = 5;

fn model(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

#[test]
fn inputs_of_every_mechanism_are_found_from_its_motion() {
    for name in shipped::names() {
        let model = model(&name);
        let info = model.info();
        let (s, m) = (info.speeds, info.declared_inputs);
        let mut random = Random::of(&format!("inverse {name}"));
        for number in 0..POINTS {
            let place = format!("{name} at point {number}");
            let point = Point::random(info, &mut random);
            let mut rates = vec![0.0; info.state_len()];
            model.rates(point.at(), &mut rates);
            let equations = InputEquations::at(model, point.at()).unwrap();
            let size = equations.mass.amax().max(1.0)
                * rates[..s].iter().fold(1.0, |a: f64, b| a.max(b.abs()));
            let off = equations.relations() * equations.demand(&rates[..s]).unwrap();
            let rank = Singular::of(&equations.inputs).rank(1e-9);
            assert_eq!(off.len(), s - rank, "{place}");
            assert!(
                off.iter().all(|x| x.abs() < ROUNDING * size),
                "{place}: {off}"
            );
            let accelerations: Vec<Option<f64>> = rates[..s].iter().copied().map(Some).collect();
            let rows: Vec<usize> = (0..s).collect();
            let found = equations.solve(&accelerations, &rows);
            if rank < m {
                assert!(
                    matches!(found, Err(InverseError::Undetermined { .. })),
                    "{place}"
                );
                continue;
            }
            for (found, given) in found.unwrap().iter().zip(&point.u) {
                let scale = size / equations.inputs.amax();
                assert!(
                    (found - given).abs() < ROUNDING * scale.max(1.0),
                    "{place}: {found} instead of {given}"
                );
            }
        }
    }
}

/// A case of the reference: the equations, and the measured accelerations of v, γ̇, φ̇.
fn ride(case: &serde_json::Value) -> (InputEquations, [f64; 3]) {
    let model = model("euc_3dof");
    let info = model.info();
    let mut p = info.default_parameters();
    let names = [
        ("m", "m"),
        ("m0", "m_0"),
        ("mw", "m_w"),
        ("J", "J"),
        ("J0", "J_0"),
        ("Jw", "J_w"),
        ("h", "h"),
        ("h0", "h_0"),
        ("l0", "l_0"),
        ("R", "R"),
        ("g", "g"),
    ];
    for (theirs, ours) in names {
        p[info.parameter_index(ours).unwrap()] = number(&case["params"][theirs]);
    }
    let mut x = vec![0.0; info.state_len()];
    for (theirs, ours) in [
        ("gamma", "gamma"),
        ("phi", "phi"),
        ("dgamma", "gamma_dot"),
        ("dphi", "phi_dot"),
    ] {
        x[info.state_index(ours).unwrap()] = number(&case[theirs]);
    }
    let at = At {
        t: 0.0,
        x: &x,
        u: &[0.0, 0.0],
        p: &p,
    };
    let equations = InputEquations::at(model, at).unwrap();
    (
        equations,
        ["ddx", "ddgamma", "ddphi"].map(|name| number(&case[name])),
    )
}

#[test]
fn the_driving_torque_of_the_euc_has_the_two_values_of_the_reference() {
    for case in cases("euc_driving_torque.json") {
        let (equations, [v, gamma, phi]) = ride(&case);
        // (9): from the first equation, with all accelerations measured.
        let first = equations
            .solve(&[Some(v), Some(gamma), Some(phi)], &[0, 1])
            .unwrap();
        // (10): from all three, the forward acceleration unknown.
        let second = equations
            .solve(&[None, Some(gamma), Some(phi)], &[0, 1, 2])
            .unwrap();
        for (found, name) in [(first, "M_d1"), (second, "M_d2")] {
            let expected = number(&case[name]);
            let off = (found[0] - expected).abs();
            assert!(
                off <= REFERENCE * expected.abs().max(100.0),
                "{name}: {} instead of {expected}",
                found[0]
            );
        }
    }
}

#[test]
fn the_euc_has_one_relation_without_its_torques() {
    for case in cases("euc_driving_torque.json") {
        let (equations, accelerations) = ride(&case);
        let radius = number(&case["params"]["R"]);
        let relations = equations.relations();
        assert_eq!(relations.nrows(), 1);
        // R times the first equation and the two others: the torques cancel.
        for (column, expected) in [radius, 1.0, 1.0].into_iter().enumerate() {
            let ratio = relations[(0, column)] / relations[(0, 2)];
            assert!((ratio - expected).abs() < REFERENCE);
        }
        // M_d1 − M_d2 = (R (row 1) + row 2 + row 3) R m11/(R m11 + m12 + m13).
        let m = &equations.mass;
        let share = radius * m[(0, 0)] / (radius * m[(0, 0)] + m[(0, 1)] + m[(0, 2)]);
        let off = &relations * equations.demand(&accelerations).unwrap();
        let off = off[0] / relations[(0, 2)] * share;
        let expected = number(&case["M_d1"]) - number(&case["M_d2"]);
        assert!(
            (off - expected).abs() < 10.0 * REFERENCE * expected.abs().max(100.0),
            "{off} instead of {expected}"
        );
    }
}

#[test]
fn what_the_equations_do_not_determine_is_told() {
    let model = model("euc_3dof");
    let x = model.info().initial_state();
    let p = model.info().default_parameters();
    let at = At {
        t: 0.0,
        x: &x,
        u: &[0.0, 0.0],
        p: &p,
    };
    let equations = InputEquations::at(model, at).unwrap();
    let too_many = equations.solve(&[None, None, Some(0.0)], &[0, 1, 2]);
    let (rank, unknowns) = (3, 4);
    assert_eq!(too_many, Err(InverseError::Undetermined { rank, unknowns }));
    let (found, needed) = (2, 3);
    assert_eq!(
        equations.demand(&[0.0, 0.0]),
        Err(InverseError::Lengths { found, needed })
    );
}
