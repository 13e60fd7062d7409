//! Inverse dynamics of all mechanisms, in every execution: against the rates and against differences.

use appell_codegen::mechanics::regressor;
use appell_codegen::schedule::schedule;
use appell_codegen::tape::interpret_weighted;
use appell_runtime::differences;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::engine::{assert_close, engines, some_accelerations};
use appell_tests::point::Point;
use appell_tests::shipped;

/// Equations solved and put in again.
const SOLVED: f64 = 1e-9;
/// Differences keep nine digits of ten.
const DIFFERENCES: f64 = 1e-7;

#[test]
fn a_motion_demands_nothing_beyond_its_loads() {
    for name in shipped::names() {
        let mut random = Random::of(&name);
        for engine in engines(&name) {
            let (model, info) = (engine.model, engine.model.info());
            let point = Point::random(info, &mut random);
            let s = info.speeds;
            let mut rates = vec![f64::NAN; info.state_len()];
            model.rates(point.at(), &mut rates);
            let [mut demand, mut bias, mut forces] = [(); 3].map(|()| vec![f64::NAN; s]);
            model.inverse_dynamics(point.at(), &rates[..s], &mut demand);
            model.appell(point.at(), &mut vec![0.0; s * s], &mut bias, &mut forces);
            let scale = bias
                .iter()
                .chain(&forces)
                .fold(1.0, |a: f64, b| a.max(b.abs()));
            let what = format!("{name}, {}", engine.name);
            assert_close(&what, &demand, &vec![0.0; s], SOLVED, scale);
        }
    }
}

#[test]
fn its_jacobians_are_its_slopes() {
    for name in shipped::names() {
        let mut random = Random::of(&name);
        let engine = &engines(&name)[1];
        let (model, info) = (engine.model, engine.model.info());
        let (n, m, s) = (info.state_len(), info.input_len(), info.speeds);
        let point = Point::random(info, &mut random);
        let given = some_accelerations(&point.x, s);
        let arrays = || [s, s * n, s * m, s * s].map(|len| vec![f64::NAN; len]);
        let (mut got, mut wanted) = (arrays(), arrays());
        let [demand, by_state, by_inputs, mass] = &mut got;
        model.inverse_dynamics_jacobians(point.at(), &given, demand, by_state, by_inputs, mass);
        let slices = wanted.each_mut().map(Vec::as_mut_slice);
        differences::inverse_dynamics_jacobians(model, point.at(), &given, slices);
        for (got, wanted) in got.iter().zip(&wanted) {
            assert_close(&name, got, wanted, DIFFERENCES, 1.0);
        }
        let mut by_mass = vec![f64::NAN; s];
        differences::inverse_dynamics(model, point.at(), &given, &mut by_mass);
        assert_close(&name, &got[0], &by_mass, 1e-12, 1.0);
    }
}

/// Y π + r against M ω̇ + b − Π.
#[test]
fn the_regressor_is_inverse_dynamics_as_a_linear_function() {
    for name in shipped::names() {
        let program = regressor(shipped::mechanism(&name)).expect(&name).program;
        let schedule = schedule(&program, &program.functions[0]);
        let mut random = Random::of(&name);
        let (model, info) = (shipped::model(&name), &program.info);
        for _ in 0..3 {
            let point = Point::random(info, &mut random);
            let given = some_accelerations(&point.x, info.speeds);
            let results = interpret_weighted(&schedule, point.at(), &given);
            let [y, rest, values] = results.as_slice() else {
                panic!("{name}: {} results", results.len());
            };
            assert!(!values.is_empty(), "{name}");
            let rows = y.chunks(values.len()).zip(rest);
            let rows = rows.map(|(row, rest)| {
                let terms = row.iter().zip(values).map(|(y, value)| y * value);
                terms.sum::<f64>() + rest
            });
            let mut demand = vec![f64::NAN; info.speeds];
            model.inverse_dynamics(point.at(), &given, &mut demand);
            assert_close(&name, &rows.collect::<Vec<_>>(), &demand, 1e-11, 1.0);
        }
    }
}
