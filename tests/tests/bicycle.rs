//! The bicycle against its published benchmark: dependent pitch, two wheels that roll.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::interpreted::InterpretedModel;
use appell_runtime::Simulation;
use appell_runtime::linearise::Linearisation;
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;
use appell_tests::engine::{Evaluation, assert_close};
use appell_tests::point::Point;
use appell_tests::reference::{document, number, numbers};
use appell_tests::{dual, shipped};
use nalgebra::{Matrix2, Matrix4};

/// Digits to which the benchmark is published.
const PUBLISHED: f64 = 1e-11;
/// Digits to which the nonlinear point is published.
const NONLINEAR: f64 = 1e-12;
/// Rounding of eigenvalues near a double root of the real part, relative to the speed.
const CRITICAL: f64 = 1e-12;

/// Rounding of derivatives of a pivoted solution, relative to the largest entry.
const JACOBIANS: f64 = 1e-11;

fn bicycle() -> &'static InterpretedModel {
    shipped::model("bicycle")
}

/// Upright riding straight at a speed in m/s.
fn upright(model: &dyn Model, v: f64) -> Vec<f64> {
    let info = model.info();
    let mut x = info.initial_state();
    let radius = info.default_parameters()[info.parameter_index("r_R").unwrap()];
    x[info.state_index("omega_R").unwrap()] = -v / radius;
    x
}

/// A of (lean rate, steer rate, lean, steer) and B of the torques, upright.
fn linearised(model: &dyn Model, v: f64) -> (Matrix4<f64>, Matrix2<f64>) {
    let info = model.info();
    let x = upright(model, v);
    let p = info.default_parameters();
    let at = At {
        t: 0.0,
        x: &x,
        u: &[0.0, 0.0],
        p: &p,
    };
    let linear = Linearisation::about(model, at).unwrap();
    assert!(linear.a.iter().chain(&linear.b).all(|v| v.is_finite()));
    let place = |name| {
        let state = info.state_index(name).unwrap();
        linear.states.iter().position(|&s| s == state).unwrap()
    };
    let places = ["omega_phi", "omega_delta", "phi", "delta"].map(place);
    let n = linear.states.len();
    // By symmetry the pitch does not follow lean and steer to first order.
    assert_eq!(linear.dependence.len(), n);
    assert!(linear.dependence.iter().all(|slope| slope.abs() < 1e-15));
    (
        Matrix4::from_fn(|i, j| linear.a[places[i] * n + places[j]]),
        Matrix2::from_fn(|i, j| linear.b[places[i] * 2 + j]),
    )
}

fn matrix(reference: &serde_json::Value, name: &str) -> Matrix2<f64> {
    Matrix2::from_row_slice(&numbers(&reference[name]))
}

#[test]
fn the_linearised_bicycle_is_the_benchmark() {
    let reference = document("meijaard.json");
    let model = bicycle();
    let g = 9.81;
    let (still, b) = linearised(model, 0.0);
    let m = b.try_inverse().unwrap();
    let close = |what: &str, found: Matrix2<f64>, wanted: Matrix2<f64>| {
        let error = (found - wanted).amax();
        assert!(
            error < PUBLISHED * wanted.amax().max(1.0),
            "{what}: {found} against {wanted}"
        );
    };
    close("M", m, matrix(&reference, "M"));
    let stiffness = |a: &Matrix4<f64>| -m * a.fixed_view::<2, 2>(0, 2);
    let k0 = stiffness(&still) / g;
    close("K0", k0, matrix(&reference, "K0"));
    for v in [1.0, 4.6, 10.0] {
        let (riding, _) = linearised(model, v);
        let c1 = -m * riding.fixed_view::<2, 2>(0, 0) / v;
        close("C1", c1, matrix(&reference, "C1"));
        close(
            "K2",
            (stiffness(&riding) - g * k0) / (v * v),
            matrix(&reference, "K2"),
        );
    }
}

/// Speed in m/s at which a function changes its sign, by bisection down to rounding.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > 0.0;
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if (f(middle) > 0.0) == rising {
            high = middle;
        } else {
            low = middle;
        }
    }
    f64::midpoint(low, high)
}

#[test]
fn the_eigenvalues_and_critical_speeds_are_the_published_ones() {
    let reference = document("meijaard.json");
    let model = bicycle();
    let mut compared = 0;
    for case in reference["eigenvalues"].as_array().unwrap() {
        if case.get("weave_re").is_none() {
            continue;
        }
        let found = linearised(model, number(&case["v"]))
            .0
            .complex_eigenvalues();
        let [capsize, castering, re, im] =
            ["capsize", "castering", "weave_re", "weave_im"].map(|key| number(&case[key]));
        for (wanted_re, wanted_im) in [(capsize, 0.0), (castering, 0.0), (re, im), (re, -im)] {
            let nearest = found
                .iter()
                .map(|z| (z.re - wanted_re).hypot(z.im - wanted_im))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < PUBLISHED, "{case}: off by {nearest:e}");
            compared += 1;
        }
    }
    assert!(compared >= 36);

    let weave = |v: f64| {
        let z = linearised(model, v).0.complex_eigenvalues();
        let oscillating = z.iter().filter(|z| z.im > 0.1);
        oscillating.map(|z| z.re).fold(f64::NEG_INFINITY, f64::max)
    };
    let capsize = |v: f64| linearised(model, v).0.determinant();
    for (name, found) in [
        ("weave_v_w", root(4.0, 5.0, weave)),
        ("capsize_v_c", root(5.0, 7.0, capsize)),
    ] {
        let wanted = number(&reference["critical_speeds"][name]);
        let error = (found / wanted - 1.0).abs();
        assert!(error < CRITICAL, "{name}: {found} against {wanted}");
    }
}

#[test]
fn the_jacobians_are_those_of_dual_numbers_in_any_motion() {
    let (program, model) = (shipped::program("bicycle"), bicycle());
    let mut random = Random::of("bicycle");
    for number in 0..12 {
        let point = Point::random(model.info(), &mut random);
        let e = Evaluation::of(model, point.at());
        let derived = [("A", &e.a), ("B", &e.b), ("P", &e.p)];
        for ((what, derived), dual) in derived.into_iter().zip(dual::jacobians(program, &point)) {
            let what = format!("{what} at point {number}");
            assert_close(&what, derived, &dual, JACOBIANS, 1e-3);
        }
    }
}

#[test]
fn the_nonlinear_accelerations_are_those_of_basu_mandal() {
    let reference = document("meijaard.json");
    let reference = &reference["basu_mandal_nonlinear"];
    let [start, published] = [
        &reference["moore_coords_input"],
        &reference["qdd_published"],
    ];
    let model = bicycle();
    let info = model.info();
    let p = info.default_parameters();
    let tilt = p[info.parameter_index("lam").unwrap()];
    let mut x = info.initial_state();
    for (name, key, offset) in [
        ("omega_phi", "u4", 0.0),
        ("omega_delta", "u7", 0.0),
        ("omega_R", "u6", 0.0),
        ("phi", "q4", 0.0),
        ("theta", "q5", tilt),
        ("delta", "q7", 0.0),
    ] {
        x[info.state_index(name).unwrap()] = number(&start[key]) - offset;
    }
    let at = At {
        t: 0.0,
        x: &x,
        u: &[0.0, 0.0],
        p: &p,
    };
    let (mut residual, mut slopes) = ([1.0], vec![0.0; x.len() - info.speeds]);
    model.position_constraints(at, &mut residual, &mut slopes);
    assert!(
        residual[0].abs() < 1e-12,
        "the front wheel is off by {:e} m",
        residual[0]
    );
    let mut rates = vec![0.0; x.len()];
    model.rates(at, &mut rates);
    // The source measures all of these angles the other way round.
    for (name, wanted) in [
        ("omega_phi", -number(&published["psi"])),
        ("omega_delta", -number(&published["psif"])),
        ("omega_R", -number(&published["betar"])),
        ("psi", number(&start["u3"])),
        ("theta", number(&start["u5"])),
        ("theta_F", number(&start["u8"])),
    ] {
        let found = rates[info.state_index(name).unwrap()];
        assert!(
            (found - wanted).abs() < NONLINEAR * wanted.abs().max(1.0),
            "{name}: {found} against {wanted}"
        );
    }
}

#[test]
fn a_lean_of_the_riding_bicycle_keeps_energy_and_the_front_wheel_on_the_ground() {
    let model = bicycle();
    let info = model.info();
    let mut simulation = Simulation::new(model);
    simulation.initial_state = upright(model, 4.6);
    simulation.initial_state[info.state_index("omega_phi").unwrap()] = 0.5;
    simulation.span = [0.0, 20.0];
    simulation.options.rtol = 1e-12;
    simulation.options.atol = 1e-12;
    let p = info.default_parameters();
    let motion = simulation.run().unwrap();
    let energy = |x: &[f64]| {
        let energies = model.energies(At {
            t: 0.0,
            x,
            u: &[0.0, 0.0],
            p: &p,
        });
        energies.kinetic + energies.potential
    };
    let start = energy(motion.state(0));
    let (mut drift, mut off) = (0.0_f64, 0.0_f64);
    for row in 0..motion.len() {
        let x = motion.state(row);
        drift = drift.max((energy(x) / start - 1.0).abs());
        let (mut residual, mut slopes) = ([0.0], vec![0.0; x.len() - info.speeds]);
        model.position_constraints(
            At {
                t: 0.0,
                x,
                u: &[0.0, 0.0],
                p: &p,
            },
            &mut residual,
            &mut slopes,
        );
        off = off.max(residual[0].abs());
    }
    assert!(drift <= 1e-9, "energy drifts by {drift:e}");
    assert!(
        off <= 1e-12,
        "the front wheel leaves the ground by {off:e} m"
    );
}
