//! Adjoints of rates and outputs, which reverse accumulation writes, against differences of the
//! Jacobians, which forward differentiation writes.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::program::FunctionKind;
use appell_runtime::differences;
use appell_runtime::model::{At, Gradient, Model};
use appell_test_kit::Random;
use appell_tests::engine::{assert_close, in_process};
use appell_tests::point::Point;
use appell_tests::shipped;

/// Differences keep nine digits of ten.
const DIFFERENCES: f64 = 1e-7;

/// x, u and p of a gradient.
fn gradient(model: &dyn Model, write: impl FnOnce(Gradient<'_>)) -> [Vec<f64>; 3] {
    let info = model.info();
    let lengths = [info.state_len(), info.input_len(), info.parameter_len()];
    let mut all = lengths.map(|len| vec![f64::NAN; len]);
    let [x, u, p] = &mut all;
    write(Gradient { x, u, p });
    all
}

fn weights(len: usize, random: &mut Random) -> Vec<f64> {
    (0..len).map(|_| random.between(-1.0, 1.0)).collect()
}

fn assert_adjoints(what: &str, model: &dyn Model, at: At<'_>, random: &mut Random) {
    assert!(model.has_adjoint(), "{what}");
    let info = model.info();
    let (n, m, l, s) = (
        info.state_len(),
        info.input_len(),
        info.output_len(),
        info.speeds,
    );
    let weights_of_rates = weights(n + n * n + n * m + s * s, random);
    let got = gradient(model, |by| model.adjoint(at, &weights_of_rates, by));
    let wanted = gradient(model, |by| {
        differences::adjoint(model, at, &weights_of_rates, by);
    });
    for (got, wanted) in got.iter().zip(&wanted) {
        assert_close(what, got, wanted, DIFFERENCES, 1.0);
    }

    let fill = |len| vec![f64::NAN; len];
    let [mut y, mut c, mut d] = [fill(l), fill(l * n), fill(l * m)];
    model.output_jacobians(at, &mut y, &mut c, &mut d);
    let [mut y_wanted, mut c_wanted, mut d_wanted] = [fill(l), fill(l * n), fill(l * m)];
    let wanted = [&mut y_wanted[..], &mut c_wanted, &mut d_wanted];
    differences::output_jacobians(model, at, wanted);
    assert_close(what, &y, &y_wanted, 1e-15, 1.0);
    assert_close(what, &c, &c_wanted, DIFFERENCES, 1.0);
    assert_close(what, &d, &d_wanted, DIFFERENCES, 1.0);

    let weights_of_outputs = weights(l + l * n + l * m, random);
    let got = gradient(model, |by| {
        model.output_adjoint(at, &weights_of_outputs, by);
    });
    let wanted = gradient(model, |by| {
        differences::output_adjoint(model, at, &weights_of_outputs, by);
    });
    for (got, wanted) in got.iter().zip(&wanted) {
        assert_close(what, got, wanted, DIFFERENCES, 1.0);
    }
}

#[test]
fn adjoints_are_gradients_of_weighted_jacobians() {
    for name in shipped::WITH_ADJOINTS {
        let program = shipped::complete_program(name);
        let mut random = Random::of(name);
        let point = Point::random(&program.info, &mut random);
        for engine in in_process(program.clone()) {
            let what = format!("{name}, {}", engine.name);
            assert_adjoints(&what, engine.model, point.at(), &mut random);
        }
    }
}

#[test]
fn an_adjoint_costs_a_few_times_what_it_differentiates() {
    use appell_codegen::schedule::schedule;
    use appell_codegen::tape::OperationCount;
    let program = shipped::complete_program("double_pendulum");
    let operations = |kind| {
        let function = program.function(kind).unwrap();
        OperationCount::of(&schedule(program, function)).total()
    };
    let (forward, backward) = (
        operations(FunctionKind::Jacobians),
        operations(FunctionKind::Adjoint),
    );
    // Five is what reverse accumulation promises; sums with weights come on top.
    assert!(
        backward <= 6 * forward,
        "{backward} operations against {forward}"
    );
}
