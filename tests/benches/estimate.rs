//! What a fit pays per step: a log-likelihood, and one with its gradient in everything.
//!
//! `cargo bench -p appell-tests --bench estimate`

use appell_codegen::compile;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_estimate::{Estimation, Measured, Recording, Setup, Unknown};
use criterion::{Criterion, criterion_group, criterion_main};

/// Samples of the recording.
const ROWS: usize = 5000;
const SPEC: &str = include_str!("../../generated/mechanisms/cart_pole.toml");

fn recording() -> Recording {
    let times: Vec<f64> = (0..ROWS).map(|row| 0.01 * row as f64).collect();
    let inputs = times.iter().map(|t| 2.0 * (1.7 * t).sin()).collect();
    let seen = |t: &f64| [0.3 * (1.1 * t).sin(), 0.2 * (2.0 * t).cos()];
    let measurements = times.iter().flat_map(seen).collect();
    Recording::new(times, inputs, measurements).expect("times increase")
}

fn estimate(criterion: &mut Criterion) {
    let program =
        compile("cart_pole.toml", SPEC, &FunctionKind::ALL).expect("shipped specs are right");
    let model = JitModel::new(&program).expect("this processor can be compiled for");
    let (setup, recordings) = (
        Setup::new(&model, &[Measured::State(2), Measured::State(3)]),
        [recording()],
    );
    let estimation = Estimation::new(&setup, &recordings).expect("they belong together");
    let (mut values, layout) = (estimation.nominal(), estimation.layout());
    let mut set = |unknown, value| {
        values[layout.place(unknown).expect("the model has it")] = value;
    };
    for i in 0..2 {
        set(Unknown::Disturbance(i), 0.3);
        set(Unknown::Noise(i), 0.01);
    }
    for state in 0..4 {
        set(Unknown::Spread { run: 0, state }, 0.1);
    }
    let mut group = criterion.benchmark_group("4 states, 5000 samples");
    group.sample_size(20);
    group.bench_function("log-likelihood", |bencher| {
        bencher.iter(|| estimation.log_likelihood(&values).expect("the filter runs"));
    });
    group.bench_function("log-likelihood with its gradient", |bencher| {
        bencher.iter(|| estimation.gradient(&values).expect("the filter runs"));
    });
}

criterion_group!(benches, estimate);
criterion_main!(benches);
