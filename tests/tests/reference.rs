//! Every execution reproduces the reference vectors.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_models::unicycle;
use appell_runtime::Dual;
use appell_runtime::model::{Model, ModelInfo};
use appell_test_kit::Random;
use appell_tests::engine::{Engine, Evaluation, assert_close, engines};
use appell_tests::formula::{Scope, definitions};
use appell_tests::point::Point;
use appell_tests::reference::{cases, number, numbers};
use serde_json::Value;

/// Rounding of a hundred operations on doubles, relative to the largest entry.
const REFERENCE: f64 = 1e-12;
/// The equilibria are rounded to doubles, which moves the Jacobians by their condition.
const EQUILIBRIA: f64 = 1e-11;
/// The same operations on dual numbers round differently.
const DUALS: f64 = 1e-11;

/// States of the files, under the names of the spec.
const STATES: &[(&str, &str)] = &[
    ("w1", "omega_1"),
    ("w2", "omega_2"),
    ("w3", "omega_3"),
    ("xG", "x_G"),
    ("yG", "y_G"),
];
const PARAMETERS: &[(&str, &str)] = &[
    ("m0", "m_0"),
    ("mw", "m_w"),
    ("J0", "J_0"),
    ("Jw", "J_w"),
    ("h0", "h_0"),
    ("l0", "l_0"),
];
const WHEEL_ORDER: &[&str] = &["w1", "w2", "w3", "theta", "psi", "phi", "xG", "yG"];
const UNICYCLE_ORDER: &[&str] = &[
    "w1", "w2", "w3", "theta", "sigma", "r", "psi", "phi", "xG", "yG",
];

fn in_spec<'a>(names: &[(&'a str, &'a str)], name: &'a str) -> &'a str {
    names
        .iter()
        .find(|(other, _)| *other == name)
        .map_or(name, |(_, spec)| spec)
}

/// A point with the parameters of a case and everything else zero.
fn point(info: &ModelInfo, case: &Value) -> Point {
    let mut p = info.default_parameters();
    let mut given = 0;
    for (name, value) in case["params"].as_object().unwrap() {
        let index = info
            .parameter_index(name)
            .or_else(|| info.parameter_index(in_spec(PARAMETERS, name)));
        if let Some(index) = index {
            p[index] = number(value);
            given += 1;
        }
    }
    assert_eq!(given, p.len(), "every parameter is given");
    Point {
        t: 0.0,
        x: vec![0.0; info.state_len()],
        u: vec![0.0; info.input_len()],
        p,
    }
}

/// Places of the file's states in the model's.
fn places(info: &ModelInfo, order: &[&str]) -> Vec<usize> {
    order
        .iter()
        .map(|name| info.state_index(in_spec(STATES, name)).unwrap())
        .collect()
}

/// A point of a wheel or a unicycle.
fn steering_point(info: &ModelInfo, case: &Value, order: &[&str]) -> Point {
    let mut point = point(info, case);
    for (place, x) in places(info, order).into_iter().zip(numbers(&case["x"])) {
        point.x[place] = x;
    }
    if let Some(u) = case.get("u") {
        point.u[0] = number(u);
    }
    point
}

/// Rows and columns of a state matrix in the order of the file.
fn reordered(matrix: &[f64], places: &[usize]) -> Vec<f64> {
    let n = places.len();
    places
        .iter()
        .flat_map(|&row| places.iter().map(move |&column| matrix[row * n + column]))
        .collect()
}

fn picked(vector: &[f64], places: &[usize]) -> Vec<f64> {
    places.iter().map(|&place| vector[place]).collect()
}

/// Calls `check` with every case of a file and every execution of a mechanism.
fn every_case(file: &str, mechanism: &str, check: impl Fn(&str, &dyn Model, &Value)) {
    let cases = cases(file);
    assert!(cases.len() >= 20, "{file} has {} cases", cases.len());
    for Engine { name, model } in engines(mechanism) {
        for (number, case) in cases.iter().enumerate() {
            check(&format!("{file} case {number}, {name}"), model, case);
        }
    }
}

#[test]
fn rolling_wheel() {
    every_case(
        "rolling_wheel.json",
        "rolling_wheel",
        |place, model, case| {
            let info = model.info();
            let places = places(info, WHEEL_ORDER);
            let e = Evaluation::of(model, steering_point(info, case, WHEEL_ORDER).at());
            for (name, got) in [
                ("xdot", picked(&e.rates, &places)),
                ("A_dfdx", reordered(&e.a, &places)),
                ("mass_matrix_dS_dwdot", e.mass_matrix),
                ("bias_dS_dwdot_at_zero_accel", e.bias),
                ("Pi", e.forces),
            ] {
                assert_close(
                    &format!("{place}, {name}"),
                    &got,
                    &numbers(&case[name]),
                    REFERENCE,
                    0.0,
                );
            }
        },
    );
}

#[test]
fn unicycle_rates() {
    every_case("unicycle_xdot.json", "unicycle", |place, model, case| {
        let info = model.info();
        let e = Evaluation::of(model, steering_point(info, case, UNICYCLE_ORDER).at());
        let got = picked(&e.rates, &places(info, UNICYCLE_ORDER));
        assert_close(place, &got, &numbers(&case["xdot"]), REFERENCE, 0.0);
    });
}

#[test]
fn unicycle_mass_matrix_bias_and_forces() {
    every_case(
        "unicycle_mass_matrix.json",
        "unicycle",
        |place, model, case| {
            let e = Evaluation::of(
                model,
                steering_point(model.info(), case, UNICYCLE_ORDER).at(),
            );
            for (name, got) in [
                ("mass_matrix", e.mass_matrix),
                ("bias", e.bias),
                ("Pi", e.forces),
                ("accel_w1_w2_w3_sigma", e.rates[..4].to_vec()),
            ] {
                assert_close(
                    &format!("{place}, {name}"),
                    &got,
                    &numbers(&case[name]),
                    REFERENCE,
                    0.0,
                );
            }
        },
    );
}

#[test]
fn unicycle_jacobians() {
    every_case(
        "unicycle_jacobians.json",
        "unicycle",
        |place, model, case| {
            let info = model.info();
            let places = places(info, UNICYCLE_ORDER);
            let e = Evaluation::of(model, steering_point(info, case, UNICYCLE_ORDER).at());
            let a = reordered(&e.a, &places);
            assert_close(
                &format!("{place}, A"),
                &a,
                &numbers(&case["A_dfdx"]),
                REFERENCE,
                0.0,
            );
            let b = picked(&e.b, &places);
            assert_close(
                &format!("{place}, B"),
                &b,
                &numbers(&case["B_dfdu"]),
                REFERENCE,
                0.0,
            );
        },
    );
}

#[test]
fn unicycle_turning_equilibria() {
    every_case(
        "unicycle_turning_equilibria.json",
        "unicycle",
        |place, model, case| {
            let info = model.info();
            let mut point = point(info, case);
            let [theta, yaw, r, pitch] =
                ["theta", "psidot", "r_star", "phidot_star"].map(|name| number(&case[name]));
            for (name, value) in [
                ("theta", theta),
                ("r", r),
                ("omega_2", yaw * theta.sin() + pitch),
                ("omega_3", yaw * theta.cos()),
            ] {
                point.x[info.state_index(name).unwrap()] = value;
            }
            let e = Evaluation::of(model, point.at());
            let essential = places(info, &UNICYCLE_ORDER[..6]);
            let n = info.state_len();
            let a: Vec<f64> = essential
                .iter()
                .flat_map(|&i| essential.iter().map(move |&j| (i, j)))
                .map(|(i, j)| e.a[i * n + j])
                .collect();
            assert_close(
                &format!("{place}, A"),
                &a,
                &numbers(&case["A_essential_6x6"]),
                EQUILIBRIA,
                0.0,
            );
            let scale = a
                .iter()
                .fold(1.0_f64, |scale, entry| scale.max(entry.abs()));
            let rates = picked(&e.rates, &essential);
            assert_close(
                &format!("{place}, rates"),
                &rates,
                &[0.0; 6],
                EQUILIBRIA,
                scale,
            );
        },
    );
}

/// A point of one of the two models of an electric unicycle.
fn euc_point(info: &ModelInfo, case: &Value) -> Point {
    let mut point = point(info, case);
    for (state, field) in [
        ("gamma", "gamma"),
        ("phi", "phi"),
        ("v", "dx"),
        ("gamma_dot", "dgamma"),
        ("phi_dot", "dphi"),
    ] {
        if let (Some(index), Some(value)) = (info.state_index(state), case.get(field)) {
            point.x[index] = number(value);
        }
    }
    for input in ["M_d", "M_h"] {
        if let (Some(index), Some(value)) = (info.input_index(input), case.get(input)) {
            point.u[index] = number(value);
        }
    }
    point
}

#[test]
fn euc_with_three_degrees_of_freedom() {
    every_case("euc_3dof.json", "euc_3dof", |place, model, case| {
        let info = model.info();
        let point = euc_point(info, case);
        let e = Evaluation::of(model, point.at());
        for (name, got) in [
            ("M", e.mass_matrix),
            ("h_vec", e.bias),
            ("Q", e.forces),
            ("qdd", e.rates[..3].to_vec()),
            ("kinetic_energy", vec![e.energies[0]]),
            ("potential_energy", vec![e.energies[1]]),
        ] {
            assert_close(
                &format!("{place}, {name}"),
                &got,
                &numbers(&case[name]),
                REFERENCE,
                0.0,
            );
        }
    });
}

#[test]
fn euc_with_two_degrees_of_freedom() {
    every_case("euc_2dof.json", "euc_2dof", |place, model, case| {
        let info = model.info();
        let point = euc_point(info, case);
        let e = Evaluation::of(model, point.at());
        let right: Vec<f64> = e
            .forces
            .iter()
            .zip(&e.bias)
            .map(|(force, bias)| force - bias)
            .collect();
        // Formulas (13) for measured accelerations, from rows of the derived equations without
        // torque.
        let mut silent = point.clone();
        silent.u.fill(0.0);
        let gravity = Evaluation::of(model, silent.at()).forces;
        let r = point.p[info.parameter_index("R").unwrap()];
        let measured = ["ddx_meas", "ddphi_meas"].map(|name| number(&case[name]));
        let m = &e.mass_matrix;
        let row = |i: usize, ddx: f64| {
            m[2 * i] * ddx + m[2 * i + 1] * measured[1] + e.bias[i] - gravity[i]
        };
        let first = r * row(0, measured[0]);
        // ẍ = (M_d/R - row 1 without ẍ)/m₁₁ put into row 2.
        let second = (m[2] / m[0] * row(0, 0.0) - row(1, 0.0)) / (1.0 + m[2] / (m[0] * r));
        for (name, got) in [
            ("M2", e.mass_matrix.clone()),
            ("rhs2", right),
            ("ddx", vec![e.rates[0]]),
            ("ddphi", vec![e.rates[1]]),
            ("Mbar_d1_of_meas", vec![first]),
            ("Mbar_d2_of_meas", vec![second]),
        ] {
            // Torques are differences of terms as large as the weight on its lever.
            let floor = if name.starts_with("Mbar") { 500.0 } else { 0.0 };
            assert_close(
                &format!("{place}, {name}"),
                &got,
                &numbers(&case[name]),
                REFERENCE,
                floor,
            );
        }
    });
}

#[test]
fn euc_driving_torque() {
    every_case(
        "euc_driving_torque.json",
        "euc_3dof",
        |place, model, case| {
            let info = model.info();
            let point = euc_point(info, case);
            let e = Evaluation::of(model, point.at());
            let mut values = vec![("R".to_owned(), point.p[info.parameter_index("R").unwrap()])];
            for (i, row) in e.mass_matrix.chunks(3).enumerate() {
                values.extend(
                    row.iter()
                        .enumerate()
                        .map(|(j, &entry)| (format!("m{}{}", i + 1, j + 1), entry)),
                );
                values.push((format!("h{}", i + 1), e.bias[i]));
                values.push((format!("G{}", i + 1), e.forces[i]));
            }
            for name in ["ddx", "ddgamma", "ddphi"] {
                values.push((name.to_owned(), number(&case[name])));
            }
            let results = evaluate(
            &values,
            "k = m12 + m13
             Md1 = R*(m11*ddx + m12*ddgamma + m13*ddphi + h1)
             Md2 = R*m11/(R*m11 + k)*(G2 + G3 - (m22 + m23)*ddgamma - (m23 + m33)*ddphi - h2 - h3 + k/m11*(m12*ddgamma + m13*ddphi + h1))",
        );
            for (name, got) in ["M_d1", "M_d2"].iter().zip(&results[1..]) {
                // Differences of terms as large as the weight on its lever.
                assert_close(
                    &format!("{place}, {name}"),
                    &[*got],
                    &numbers(&case[*name]),
                    REFERENCE,
                    500.0,
                );
            }
        },
    );
}

/// Values of definitions where names have numbers.
fn evaluate(values: &[(String, f64)], text: &str) -> Vec<f64> {
    let mut graph = appell_codegen::symbolic::Graph::new();
    let mut scope = Scope::default();
    for (name, _) in values {
        let symbol = graph.symbol(name);
        scope.define(name, symbol);
    }
    let lines = definitions(&mut graph, &mut scope, text);
    let roots: Vec<_> = lines.into_iter().map(|(_, value)| value).collect();
    let numbers: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
    appell_codegen::symbolic::evaluate(&graph, &numbers, &roots)
}

#[test]
fn parameter_jacobian_of_the_emitted_unicycle_is_that_of_its_rates_on_dual_numbers() {
    type D = Dual<f64, 4>;
    let model = &engines("unicycle")[2];
    assert_eq!(model.name, "emitted");
    let mut random = Random::of("emitted on duals");
    for number in 0..20 {
        let point = Point::random(model.model.info(), &mut random);
        let parameters: [f64; 4] = point.p.clone().try_into().unwrap();
        let fixed = |values: &[f64]| values.iter().map(|&v| D::fixed(v)).collect::<Vec<_>>();
        let state: [D; 10] = fixed(&point.x).try_into().unwrap();
        let inputs: [D; 1] = fixed(&point.u).try_into().unwrap();
        let rates: [D; 10] = unicycle::rates(
            &D::variables(parameters).into(),
            &state.into(),
            &inputs.into(),
        )
        .into();
        let duals: Vec<f64> = rates.iter().flat_map(|rate| rate.partials).collect();
        let derived = Evaluation::of(model.model, point.at());
        assert_close(
            &format!("P at point {number}"),
            &derived.p,
            &duals,
            DUALS,
            0.0,
        );
    }
}
