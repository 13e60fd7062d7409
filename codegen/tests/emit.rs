//! Emitted Rust compiles, reproduces the schedule bit for bit, and is identical in every run.
//!
//! The golden files are modules of this test; `emit_golden` compares them and writes them anew.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::emit::{Error, Options, emit, emit_functions};
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::tape::interpret;
use appell_runtime::Dual;
use appell_runtime::model::{At, Gradient, Model};

use crate::emit_support::{self, Numbers, SPEC, golden_options, mixture, quantity};

#[allow(non_snake_case, dead_code, unreachable_pub, clippy::pedantic)]
mod unicycle {
    include!("emit_golden/unicycle.rs");
}
#[allow(non_snake_case, dead_code, unreachable_pub, clippy::pedantic)]
mod mixture_model {
    include!("emit_golden/mixture.rs");
}

#[allow(non_snake_case, dead_code, unreachable_pub, clippy::pedantic)]
mod with_adjoints {
    include!("emit_golden/with_adjoints.rs");
}

#[allow(non_snake_case, dead_code, unreachable_pub, clippy::pedantic)]
mod block {
    include!("emit_golden/block.rs");
}

/// x, u and p of a gradient as bits.
fn gradient(model: &dyn Model, write: impl FnOnce(Gradient<'_>)) -> [Vec<u64>; 3] {
    let info = model.info();
    let lengths = [info.state_len(), info.input_len(), info.parameter_len()];
    let mut all = lengths.map(|len| vec![f64::NAN; len]);
    let [x, u, p] = &mut all;
    write(Gradient { x, u, p });
    all.map(|numbers| bits(&numbers))
}

#[test]
fn emitted_adjoints_are_those_of_the_interpreter() {
    for (program, emitted) in [
        (
            emit_support::with_adjoints(),
            &with_adjoints::Pendulum as &dyn Model,
        ),
        (emit_support::block(), &block::Block),
    ] {
        assert_adjoints(program, emitted);
    }
}

fn assert_adjoints(program: Program, emitted: &dyn Model) {
    let interpreter = InterpretedModel::new(program);
    let models: [&dyn Model; 2] = [&interpreter, emitted];
    let mut numbers = Numbers::new(11);
    let info = interpreter.info();
    let (n, m, l) = (info.state_len(), info.input_len(), info.output_len());
    let (x, u) = (numbers.list(n), numbers.list(m));
    let p = info.default_parameters();
    let at = At {
        t: 0.0,
        x: &x,
        u: &u,
        p: &p,
    };
    let weights = numbers.list(n + n * n + n * m + info.speeds * info.speeds);
    let [wanted, got] = models.map(|model| gradient(model, |by| model.adjoint(at, &weights, by)));
    assert_eq!(got, wanted);
    let weights = numbers.list(l + l * n + l * m);
    let [wanted, got] =
        models.map(|model| gradient(model, |by| model.output_adjoint(at, &weights, by)));
    assert_eq!(got, wanted);
    let [wanted, got] = models.map(|model| {
        let mut all = [vec![0.0; l], vec![0.0; l * n], vec![0.0; l * m]];
        let [y, c, d] = &mut all;
        model.output_jacobians(at, y, c, d);
        all.map(|numbers| bits(&numbers))
    });
    assert_eq!(got, wanted);
    assert!(emitted.has_adjoint());
}

#[test]
fn two_runs_emit_the_same_bytes() {
    let options = golden_options(true);
    let [first, second] = [(), ()].map(|()| emit(&emit_support::unicycle(), &options).unwrap());
    assert_eq!(first, second);
}

/// Results of the interpreter.
fn interpreted(
    program: &Program,
    kind: FunctionKind,
    t: f64,
    x: &[f64],
    u: &[f64],
    p: &[f64],
) -> Vec<Vec<f64>> {
    let function = program
        .functions
        .iter()
        .find(|function| function.kind == kind)
        .unwrap();
    interpret(&schedule(program, function), t, x, u, p)
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn emitted_code_and_interpreter_agree_bit_for_bit() {
    let program = emit_support::unicycle();
    let mut numbers = Numbers::new(7);
    for _ in 0..200 {
        let (x, u, p) = (numbers.list(10), numbers.list(1), numbers.list(4));
        let at = At {
            t: 0.0,
            x: &x,
            u: &u,
            p: &p,
        };
        let (mut rates, mut a, mut b) = ([0.0; 10], [0.0; 100], [0.0; 10]);
        unicycle::Unicycle.rates(at, &mut rates);
        let expected = interpreted(&program, FunctionKind::Rates, 0.0, &x, &u, &p);
        assert_eq!(bits(&rates), bits(&expected[0]));
        unicycle::Unicycle.jacobians(at, &mut rates, &mut a, &mut b);
        let expected = interpreted(&program, FunctionKind::Jacobians, 0.0, &x, &u, &p);
        assert_eq!(
            [bits(&rates), bits(&a), bits(&b)],
            [0, 1, 2].map(|i| bits(&expected[i]))
        );
        let mut by_parameter = [0.0; 40];
        unicycle::Unicycle.parameter_jacobian(at, &mut by_parameter);
        let expected = interpreted(&program, FunctionKind::ParameterJacobian, 0.0, &x, &u, &p);
        assert_eq!(bits(&by_parameter), bits(&expected[0]));
        let (mut mass, mut bias, mut forces) = ([0.0; 16], [0.0; 4], [0.0; 4]);
        unicycle::Unicycle.appell(at, &mut mass, &mut bias, &mut forces);
        let expected = interpreted(&program, FunctionKind::MassMatrixAndBias, 0.0, &x, &u, &p);
        assert_eq!(bits(&mass), bits(&expected[0]));
        assert_eq!(bits(&bias), bits(&expected[1]));
    }
}

#[test]
fn everything_that_is_no_polynomial_agrees_bit_for_bit() {
    let program = mixture();
    let mut numbers = Numbers::new(11);
    for _ in 0..200 {
        let (t, x, p) = (numbers.next(), numbers.list(3), numbers.list(2));
        let state = mixture_model::State::from([x[0], x[1], x[2]]);
        let parameters = mixture_model::Parameters::from([p[0], p[1]]);
        let inputs = mixture_model::Inputs {};
        let found = mixture_model::jacobians(t, &parameters, &state, &inputs);
        let expected = interpreted(&program, FunctionKind::Jacobians, t, &x, &[], &p);
        assert_eq!(bits(&<[f64; 3]>::from(found.rates)), bits(&expected[0]));
        let a = found.a.map(mixture_model::State::to_array).to_array();
        assert_eq!(bits(a.as_flattened()), bits(&expected[1]));
        let found = mixture_model::outputs(t, &parameters, &state, &inputs);
        let expected = interpreted(&program, FunctionKind::Outputs, t, &x, &[], &p);
        assert_eq!(bits(&<[f64; 3]>::from(found)), bits(&expected[0]));
    }
}

/// Emitted code is generic: on dual numbers it differentiates itself.
#[test]
fn emitted_jacobians_are_the_derivatives_of_the_emitted_rates() {
    const ROUNDING: f64 = 1e-9;
    let mut numbers = Numbers::new(3);
    let (x, u, p) = (numbers.list(10), numbers.list(1), numbers.list(4));
    let fixed =
        |list: &[f64]| -> Vec<Dual<f64, 10>> { list.iter().map(|&v| Dual::fixed(v)).collect() };
    let (du, dp) = (fixed(&u), fixed(&p));
    let x: [f64; 10] = x.try_into().unwrap();
    let rates = unicycle::rates(
        &unicycle::Parameters::from([dp[0], dp[1], dp[2], dp[3]]),
        &unicycle::State::from(Dual::variables(x)),
        &unicycle::Inputs::from([du[0]]),
    );
    let found = unicycle::jacobians(
        &unicycle::Parameters::from([p[0], p[1], p[2], p[3]]),
        &unicycle::State::from(x),
        &unicycle::Inputs::from([u[0]]),
    );
    let a = found.a.map(unicycle::State::to_array).to_array();
    for (row, rate) in rates.to_array().iter().enumerate() {
        for (column, partial) in rate.partials.iter().enumerate() {
            let error = (partial - a[row][column]).abs() / (1.0 + partial.abs());
            assert!(error < ROUNDING, "A[{row}][{column}]: {error}");
        }
    }
}

/// A step of Runge and Kutta is typed as in a textbook.
#[test]
fn states_and_rates_are_vectors() {
    let parameters = unicycle::Parameters::default();
    let inputs = unicycle::Inputs { u: 2.0 };
    let f = |x: unicycle::State<f64>| unicycle::rates(&parameters, &x, &inputs);
    let step = |x: unicycle::State<f64>, h: f64| {
        let k1 = f(x);
        let k2 = f(x + k1 * (0.5 * h));
        let k3 = f(x + k2 * (0.5 * h));
        let k4 = f(x + k3 * h);
        x + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)
    };
    let start = unicycle::State {
        omega_2: 3.0,
        theta: 0.1,
        ..unicycle::State::initial()
    };
    let [coarse, fine] = [1, 2].map(|parts| {
        let h = 0.02 / f64::from(parts);
        (0..parts).fold(start, |x, _| step(x, h))
    });
    let change = (fine - start)
        .to_array()
        .iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    let error = (fine - coarse)
        .to_array()
        .iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    assert!(change > 1e-3 && error < 1e-7, "{change} {error}");
    let named = f(start);
    let [rates, accelerations] = [
        named.coordinate_rates().to_array().to_vec(),
        named.accelerations().to_array().to_vec(),
    ]
    .map(|part| bits(&part));
    assert_eq!([accelerations, rates].concat(), bits(&named.to_array()));
}

/// The mixture has no inputs.
#[test]
fn a_vector_without_entries_needs_no_scalar() {
    assert_eq!(mixture_model::Inputs {}, mixture_model::Inputs::default());
}

/// `type` cannot name a field in Rust, and other names do not collide with its replacement.
#[test]
fn words_of_rust_stay_different_names() {
    let mut program = emit_support::unicycle();
    let states = program.info.states.to_mut();
    states[0].name = "type".into();
    states[1].name = "type_".into();
    let source = emit(&program, &golden_options(false)).unwrap().source;
    assert!(source.contains("pub type_: T") && source.contains("pub type__: T"));
}

#[test]
fn the_emitted_model_has_the_info_of_the_program() {
    assert_eq!(*unicycle::Unicycle.info(), emit_support::unicycle().info);
    assert_eq!(unicycle::SPEC, SPEC);
    assert_eq!(
        unicycle::Parameters::default().R.to_bits(),
        0.3_f64.to_bits()
    );
}

#[test]
fn lines_are_short_enough_to_read() {
    for program in [emit_support::unicycle(), mixture()] {
        let emitted = emit(&program, &golden_options(false)).unwrap();
        for line in emitted
            .source
            .lines()
            .filter(|line| line.trim_start().starts_with("let "))
        {
            assert!(line.chars().count() <= 89, "{line}");
        }
    }
}

/// Names of all items, fields and functions of a text, in order.
fn skeleton(source: &str) -> Vec<String> {
    let file = syn::parse_file(source).unwrap();
    let mut names = Vec::new();
    for item in file.items {
        match item {
            syn::Item::Fn(item) => names.push(format!("fn {}", item.sig.ident)),
            syn::Item::Struct(item) => {
                names.push(format!("struct {} {}", item.ident, item.fields.len()));
            }
            syn::Item::Static(item) => names.push(format!("static {}", item.ident)),
            syn::Item::Const(item) => names.push(format!("const {}", item.ident)),
            syn::Item::Impl(_) => names.push("impl".to_owned()),
            syn::Item::Use(_) => names.push("use".to_owned()),
            _ => names.push("something else".to_owned()),
        }
    }
    names
}

#[test]
fn hostile_texts_inject_nothing() {
    const HOSTILE: [&str; 8] = [
        "x: f64 } fn injected() {",
        "a\npub fn injected() {}\n//",
        "*/ pub fn injected() {} /*",
        "\"; pub fn injected() {} //",
        "r#\"\"# ] #![allow(x)]",
        "é\u{202e}\u{2066}hidden",
        "",
        "//%blank",
    ];
    let expected = skeleton(
        &emit(&emit_support::unicycle(), &golden_options(true))
            .unwrap()
            .source,
    );
    for (i, hostile) in HOSTILE.iter().enumerate() {
        let mut program = emit_support::unicycle();
        let info = &mut program.info;
        info.title = (*hostile).into();
        info.source = (*hostile).into();
        program.file = (*hostile).to_owned();
        for list in [&mut info.states, &mut info.inputs, &mut info.parameters] {
            for (k, entry) in list.to_mut().iter_mut().enumerate() {
                *entry = quantity(hostile, hostile, hostile, f64::NAN);
                if k % 2 == 1 {
                    entry.name = HOSTILE[(i + k) % HOSTILE.len()].into();
                }
            }
        }
        for function in &mut program.functions {
            if function.kind == FunctionKind::AccelerationEnergy {
                function.results[1].name = (*hostile).to_owned();
            }
        }
        let options = Options {
            spec: Some((*hostile).to_owned()),
            ..golden_options(true)
        };
        let emitted = emit(&program, &options).unwrap();
        assert_eq!(skeleton(&emitted.source), expected, "{hostile:?}");
        assert!(
            !emitted
                .source
                .chars()
                .any(|c| matches!(c, '\u{202e}' | '\u{2066}')),
            "{hostile:?}"
        );
    }
}

#[test]
fn what_cannot_be_emitted_is_told() {
    let program = emit_support::unicycle();
    let broken = Options {
        runtime: "no path; fn injected() {}".to_owned(),
        ..Options::default()
    };
    assert!(matches!(
        emit(&program, &broken),
        Err(Error::RuntimePath(_))
    ));
    let mut without = program.clone();
    without
        .functions
        .retain(|function| function.kind != FunctionKind::Energies);
    let missing = emit(&without, &Options::default());
    assert_eq!(missing, Err(Error::MissingFunction(FunctionKind::Energies)));
    let mut short = program;
    short.functions[0].results[0].entries.pop();
    assert!(matches!(
        emit(&short, &golden_options(false)),
        Err(Error::Shape {
            expected: 6,
            found: 5,
            ..
        })
    ));
}

#[test]
fn functions_are_emitted_alone() {
    let emitted = emit_functions(&emit_support::unicycle(), &[FunctionKind::Rates]).unwrap();
    let functions: Vec<String> = skeleton(&emitted.source)
        .into_iter()
        .filter(|name| name.starts_with("fn "))
        .collect();
    assert_eq!(functions, ["fn rates"]);
    assert!(!emitted.source.contains("std::"));
}
