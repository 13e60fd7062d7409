//! Steady motions by general means: the unicycle's turning motions, every digit.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_analysis::{
    Circle, Stability, SteadyError, SteadyProblem, Term, Verdict, circle, essential_matrix,
};
use appell_runtime::model::Model;
use appell_tests::reference::{cases, number, numbers};
use appell_tests::steady::{problem, shipped, term};
use serde_json::Value;

/// What the references are reproduced to.
const REFERENCE: f64 = 1e-10;

/// Essential states of the references, under the names of the spec.
const ESSENTIAL: [&str; 6] = ["omega_1", "omega_2", "omega_3", "theta", "sigma", "r"];

fn assert_close(what: &str, found: f64, wanted: f64) {
    let error = (found - wanted).abs();
    assert!(
        error <= REFERENCE * wanted.abs().max(1.0),
        "{what}: {found} against {wanted}"
    );
}

/// The turning motion of a case of the references.
fn turning<'a>(model: &'a dyn Model, case: &Value) -> SteadyProblem<'a> {
    let mut given: Vec<(&str, f64)> = Vec::new();
    for (name, value) in case["params"].as_object().unwrap() {
        given.push((name, number(value)));
    }
    given.push(("theta", number(&case["theta"])));
    given.push(("psi_dot", number(&case["psidot"])));
    problem(model, &given)
}

#[test]
fn heading_and_position_are_ignorable_and_the_rest_is_essential() {
    let model = shipped("unicycle");
    let info = model.info();
    let problem = problem(model, &[]);
    let names = |states: &[usize]| -> Vec<&str> {
        states
            .iter()
            .map(|&s| info.states[s].name.as_ref())
            .collect()
    };
    let structure = problem.structure();
    let mut essential = names(&structure.essential);
    essential.sort_unstable();
    let mut wanted = ESSENTIAL;
    wanted.sort_unstable();
    assert_eq!(essential, wanted);
    assert_eq!(names(&structure.ignorable), ["x_G", "y_G", "psi", "phi"]);
    assert_eq!(names(&structure.uniform), ["psi", "phi"]);
}

#[test]
fn the_turning_motions_of_the_unicycle_are_found_without_a_formula() {
    let cases = cases("unicycle_turning_equilibria.json");
    assert_eq!(cases.len(), 20);
    let model = shipped("unicycle");
    for case in &cases {
        let problem = turning(model, case);
        let motions = problem
            .solve_isolated(60)
            .unwrap_or_else(|e| panic!("{e} {case}"));
        assert_eq!(motions.len(), 1, "{case}");
        let point = &motions[0].point;
        let value = |name| term(model, name).value(model, point);
        assert_close("r", value("r"), number(&case["r_star"]));
        assert_close("phi_dot", value("phi_dot"), number(&case["phidot_star"]));
        assert_close("z_A", value("z_A"), number(&case["z_A"]));

        let (states, a) = essential_matrix(model, problem.structure(), point).unwrap();
        let place = |name| {
            let state = model.info().state_index(name).unwrap();
            states.iter().position(|&s| s == state).unwrap()
        };
        let places = ESSENTIAL.map(place);
        let wanted = numbers(&case["A_essential_6x6"]);
        for (k, wanted) in wanted.iter().enumerate() {
            let found = a[(places[k / 6], places[k % 6])];
            assert_close(&format!("A entry {k}"), found, *wanted);
        }

        let stability = Stability::of(model, problem.structure(), point).unwrap();
        assert_eq!(stability.zeros, 2);
        assert_eq!(stability.family, 2);
        let mut squares: Vec<_> = stability.eigenvalues().iter().map(|z| z * z).collect();
        squares.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let wanted = numbers(&case["lambda_squared_pair"]);
        for (pair, wanted) in squares.chunks(2).zip(wanted.chunks(2)) {
            for square in pair {
                assert_close("lambda squared", square.re, wanted[0]);
                assert_close("lambda squared", square.im.abs(), wanted[1].abs());
            }
        }
        let stable = case["neutrally_stable"].as_bool().unwrap();
        let verdict = if stable {
            Verdict::Neutral
        } else {
            Verdict::Unstable
        };
        assert_eq!(stability.verdict, verdict, "{case}");

        // Turning radii of the wheel's centre and of the contact.
        let (tilt, turn) = (number(&case["theta"]), number(&case["psidot"]));
        let (spin, radius) = (number(&case["phidot_star"]), number(&case["params"]["R"]));
        let path = |names: [&str; 2]| circle(model, point, names.map(|name| term(model, name)));
        let [centre, contact]: [Circle; 2] = [["x_G", "y_G"], ["x_P", "y_P"]].map(path);
        assert_close(
            "rho_G",
            centre.radius,
            (spin / turn + tilt.sin()).abs() * radius,
        );
        assert_close("rho_P", contact.radius, (spin / turn).abs() * radius);
        for circle in [centre, contact] {
            assert_close("turn rate", circle.turn_rate, turn);
            assert_close("the axis", circle.centre[0], centre.centre[0]);
            assert_close("the axis", circle.centre[1], centre.centre[1]);
        }
    }
}

#[test]
fn too_few_conditions_name_what_may_be_given_further() {
    let model = shipped("unicycle");
    let Err(SteadyError::Family { dimension, open }) =
        problem(model, &[("theta", 0.1)]).solve_isolated(5)
    else {
        panic!("one condition does not determine a turning motion");
    };
    assert_eq!(dimension, 1);
    for name in ["psi_dot", "phi_dot", "r", "speed", "z_A"] {
        assert!(
            open.iter().any(|o| o == name),
            "{name} is missing in {open:?}"
        );
    }
    assert!(
        !open.iter().any(|o| o == "theta" || o == "sigma"),
        "{open:?}"
    );
}

/// At rest families meet, whose tangents together span one dimension more than each of them has.
#[test]
fn no_more_conditions_are_asked_for_than_determine_a_motion() {
    let model = shipped("wheelbot");
    assert_eq!(problem(model, &[]).solve().unwrap().family, 3);
    let Err(SteadyError::Family { dimension, open }) = problem(model, &[]).solve_isolated(40)
    else {
        panic!("a wheel may roll at any speed");
    };
    assert_eq!(dimension, 2, "of {open:?}");
    let turning = problem(model, &[("speed", 1.0), ("psi_dot", 0.5)]);
    assert!(turning.solve_isolated(40).is_ok());
}

#[test]
fn contradictions_and_ignorable_quantities_are_reported() {
    let model = shipped("unicycle");
    let error = problem(model, &[("theta", 0.1), ("psi_dot", 0.0)]).solve_isolated(30);
    let message = error.unwrap_err().to_string();
    assert!(message.contains("no steady motion"), "{message}");
    let mut all = problem(model, &[]);
    for (name, says) in [
        ("psi", "psi_dot"),
        ("x_P", "constant"),
        ("theta_dot", "zero"),
    ] {
        let message = all.fix(term(model, name), 1.0).unwrap_err().to_string();
        assert!(message.contains(says), "{message}");
    }
    assert!(all.fix(Term::State(99), 1.0).is_err());
    assert!(all.free(term(model, "theta")).is_err());
}

#[test]
fn a_free_input_holds_a_tilted_unicycle_straight() {
    let model = shipped("unicycle");
    let mut problem = problem(model, &[("theta", 0.1), ("psi_dot", 0.0), ("speed", 2.0)]);
    problem.free(term(model, "u")).unwrap();
    let motions = problem.solve_isolated(20).unwrap();
    assert_eq!(motions.len(), 1);
    let value = |name| term(model, name).value(model, &motions[0].point);
    let p = |name| value(name);
    assert_close(
        "r",
        value("r"),
        (p("m") + p("m0")) * p("R") * 0.1_f64.tan() / p("m0"),
    );
    assert_close("u", value("u"), p("m0") * p("g") * 0.1_f64.sin());
    let path = ["x_G", "y_G"].map(|name| term(model, name));
    assert!(circle(model, &motions[0].point, path).radius.is_infinite());
}
