//! From the text of a spec to Rust source, warm: what `appell derive` pays per mechanism.
//!
//! `cargo bench -p appell-tests --bench generation`

use appell_codegen::emit::emit_functions;
use appell_codegen::mechanics::{assemble, derive};
use appell_codegen::program::FunctionKind;
use appell_models::Shipped;
use criterion::{Criterion, criterion_group, criterion_main};
use mimalloc::MiMalloc;

/// As in `appell`.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The mechanism of the gallery with the longest equations.
const BICYCLE: &str = include_str!("../../generated/mechanisms/bicycle.toml");

/// Parses, checks, derives, schedules and prints.
fn generate(file: &str, spec: &str, kinds: &[FunctionKind]) -> usize {
    let checked = appell_spec::load(file, spec).expect("shipped specs are right");
    let Ok(derivation) = derive(&checked.mechanism) else {
        panic!("shipped specs can be derived")
    };
    let program = assemble::program(derivation, &checked.mechanism, kinds)
        .expect("shipped specs can be assembled");
    emit_functions(&program, kinds)
        .expect("shipped specs can be emitted")
        .source
        .len()
}

fn generation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("spec text to Rust");
    for name in ["unicycle", "euc_3dof"] {
        let shipped = Shipped::find(name).expect("it is shipped");
        for (what, kinds) in [
            ("rates", [FunctionKind::Rates].as_slice()),
            // The function returns the rates and both Jacobians, from one graph.
            ("rates with Jacobians", &[FunctionKind::Jacobians]),
            (
                "rates and Jacobians",
                &[FunctionKind::Rates, FunctionKind::Jacobians],
            ),
        ] {
            group.bench_function(format!("{name}, {what}"), |bencher| {
                bencher.iter(|| generate(shipped.file, shipped.spec, kinds));
            });
        }
    }
    group.sample_size(10);
    group.bench_function("bicycle, every function", |bencher| {
        bencher.iter(|| generate("bicycle.toml", BICYCLE, &FunctionKind::STANDARD));
    });
    group.finish();
}

criterion_group!(benches, generation);
criterion_main!(benches);
