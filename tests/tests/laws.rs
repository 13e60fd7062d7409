//! What every mechanism must obey. Nobody names one here: a new spec is tested by existing.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::mechanics::gibbs_appell::{acceleration_energy, kinetic_energy};
use appell_codegen::symbolic::{Expr, Graph};
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::engine::{Evaluation, assert_close, assert_schedules, engines};
use appell_tests::paper::energy_rate;
use appell_tests::point::Point;
use appell_tests::{dual, shipped};
use nalgebra::DMatrix;

/// Random points per mechanism.
const POINTS: usize = 20;
/// All executions follow one schedule operation by operation; elementary functions may differ in
/// their last bits.
const EXECUTIONS: f64 = 2.0 * f64::EPSILON;
/// Rounding of some hundred operations, and the condition of M.
const JACOBIANS: f64 = 1e-11;
/// Rounding of the products of a constraint row.
const RESIDUAL: f64 = 1e-13;
/// Rounding and the error of a five-point stencil with the step of [`STENCIL`].
const ENERGY: f64 = 1e-8;
/// Largest change of a state in a step of the stencil: the fifth power of it is the rounding of the
/// energy.
const STENCIL: f64 = 0.003;
/// Rates below this one are no reason for a longer step, in SI.
const FAST: f64 = 3.0;
/// An array whose entries are all smaller is compared as if it had this size, in SI.
const FLOOR: f64 = 1e-3;

/// Calls `law` with random points of every shipped mechanism.
fn everywhere(seed: &str, mut law: impl FnMut(&str, &dyn Model, &Point)) {
    for name in shipped::names() {
        let model = shipped::model(&name);
        let mut random = Random::of(&format!("{seed} {name}"));
        for number in 0..POINTS {
            law(
                &format!("{name} at point {number}"),
                model,
                &Point::random(model.info(), &mut random),
            );
        }
    }
}

#[test]
fn the_mass_matrix_is_symmetric_and_positive_definite() {
    everywhere("mass matrix", |place, model, point| {
        let e = Evaluation::of(model, point.at());
        let s = model.info().speeds;
        let m = DMatrix::from_row_slice(s, s, &e.mass_matrix);
        assert_eq!(m, m.transpose(), "{place}");
        assert!(m.cholesky().is_some(), "{place}: {:?}", e.mass_matrix);
    });
}

#[test]
fn mass_matrix_and_bias_are_the_derivatives_of_the_acceleration_energy() {
    for name in shipped::names() {
        let d = &mut *shipped::derivation(&name);
        let accelerations = d.symbols.accelerations.clone();
        let parts: Vec<Expr> = d
            .bodies
            .clone()
            .iter()
            .map(|body| acceleration_energy(&mut d.algebra, body, &accelerations))
            .collect();
        let s = d.algebra.graph.sum(&parts);
        for (i, &acceleration) in accelerations.iter().enumerate() {
            let slope = d.algebra.derivative(s, acceleration);
            let mut parts = vec![d.gibbs.bias[i]];
            for (&entry, &other) in d.gibbs.mass_matrix[i].iter().zip(&accelerations) {
                parts.push(d.algebra.graph.mul(entry, other));
            }
            let row = d.algebra.graph.sum(&parts);
            assert!(
                d.algebra.test.are_equal(&d.algebra.graph, slope, row),
                "{name}, equation {i}"
            );
        }
    }
}

#[test]
fn the_energy_grows_by_the_power_of_the_loads_as_an_identity() {
    for name in shipped::names() {
        let d = &mut *shipped::derivation(&name);
        let mut parts: Vec<Expr> = d
            .bodies
            .clone()
            .iter()
            .map(|body| kinetic_energy(&mut d.algebra, body))
            .collect();
        parts.extend(d.loads.iter().filter_map(|load| load.potential));
        let energy = d.algebra.graph.sum(&parts);
        let growth = energy_rate(d, energy);
        let graph = &mut d.algebra.graph;
        let mut power = Graph::ZERO;
        for load in d.loads.iter().filter(|load| load.potential.is_none()) {
            let part = load.power(graph);
            power = graph.add(power, part);
        }
        let accelerations = d.motion.accelerations.clone();
        let prescribed = d.prescribed_power(&accelerations).unwrap();
        power = d.algebra.graph.add(power, prescribed);
        assert!(
            d.algebra.test.are_equal(&d.algebra.graph, growth, power),
            "{name}"
        );
    }
}

#[test]
fn the_energies_of_the_models_grow_by_their_power() {
    everywhere("energy", |place, model, point| {
        let e = Evaluation::of(model, point.at());
        let step = STENCIL / e.rates.iter().fold(FAST, |most, rate| most.max(rate.abs()));
        let moved = |steps: f64| {
            let mut there = point.clone();
            there.t += steps * step;
            for (x, rate) in there.x.iter_mut().zip(&e.rates) {
                *x += steps * step * rate;
            }
            let energies = model.energies(there.at());
            energies.kinetic + energies.potential
        };
        if model.info().signal_inputs.is_empty() {
            let growth =
                (8.0 * (moved(1.0) - moved(-1.0)) - (moved(2.0) - moved(-2.0))) / (12.0 * step);
            let scale = moved(0.0).abs() / step * 1e-3;
            assert_close(place, &[growth], &[e.energies[2]], ENERGY, scale.max(1.0));
        }
    });
}

#[test]
fn the_constraints_hold_to_rounding() {
    everywhere("constraints", |place, model, point| {
        let e = Evaluation::of(model, point.at());
        let scale = e
            .rates
            .iter()
            .fold(1.0_f64, |scale, rate| scale.max(rate.abs()));
        for residual in e.residual {
            assert!(residual.abs() <= RESIDUAL * scale, "{place}: {residual:e}");
        }
    });
}

#[test]
fn the_jacobians_are_those_of_dual_numbers() {
    for name in shipped::names() {
        let (program, model) = (shipped::program(&name), shipped::model(&name));
        let mut random = Random::of(&format!("jacobians {name}"));
        for number in 0..POINTS {
            let point = Point::random(model.info(), &mut random);
            let e = Evaluation::of(model, point.at());
            let duals = dual::jacobians(program, &point);
            for ((what, derived), dual) in [("A", &e.a), ("B", &e.b), ("P", &e.p)]
                .into_iter()
                .zip(duals)
            {
                let what = format!("{what} of {name} at point {number}");
                assert_close(&what, derived, &dual, JACOBIANS, FLOOR);
            }
        }
    }
}

#[test]
fn rates_and_jacobians_are_linear_in_the_inputs_that_enter_linearly() {
    // ẋ(u) - ẋ(0) = B u wherever B does not depend on u, which holds for forces and torques.
    everywhere("inputs", |place, model, point| {
        let e = Evaluation::of(model, point.at());
        let mut silent = point.clone();
        silent.u.fill(0.0);
        let rest = Evaluation::of(model, silent.at());
        if e.b == rest.b && !point.u.is_empty() {
            let by_b: Vec<f64> =
                e.b.chunks(point.u.len())
                    .map(|row| row.iter().zip(&point.u).map(|(b, u)| b * u).sum())
                    .collect();
            let by_rates: Vec<f64> = e
                .rates
                .iter()
                .zip(&rest.rates)
                .map(|(with, without)| with - without)
                .collect();
            let scale = e
                .rates
                .iter()
                .fold(1.0_f64, |scale, rate| scale.max(rate.abs()));
            assert_close(place, &by_rates, &by_b, JACOBIANS, scale);
        }
    });
}

#[test]
fn the_schedules_compute_what_was_derived() {
    for name in shipped::names() {
        let program = shipped::program(&name);
        let mut random = Random::of(&format!("schedules {name}"));
        let points: Vec<Point> = (0..POINTS)
            .map(|_| Point::random(&program.info, &mut random))
            .collect();
        assert_schedules(program, &points);
    }
}

#[test]
fn interpreted_emitted_and_compiled_code_give_the_same_numbers() {
    for name in shipped::names() {
        let engines = engines(&name);
        let [first, others @ ..] = engines.as_slice() else {
            panic!("no engine")
        };
        for engine in others {
            assert_eq!(
                engine.model.info(),
                first.model.info(),
                "{name}, {}",
                engine.name
            );
        }
        let mut random = Random::of(&format!("engines {name}"));
        for number in 0..POINTS {
            let point = Point::random(first.model.info(), &mut random);
            let wanted = Evaluation::of(first.model, point.at());
            for engine in others {
                let got = Evaluation::of(engine.model, point.at());
                for ((what, got), (_, wanted)) in got.arrays().into_iter().zip(wanted.arrays()) {
                    let what = format!("{what} of {name}, {}, at point {number}", engine.name);
                    assert_close(&what, got, wanted, EXECUTIONS, f64::MIN_POSITIVE);
                }
            }
        }
    }
}
