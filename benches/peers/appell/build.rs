//! Emits the functions that are measured, and times spec text -> Rust text.

use std::fmt::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use appell_codegen::emit::emit_functions;
use appell_codegen::program::FunctionKind as Kind;

/// Name of a kernel, its spec, its functions.
const KERNELS: &[(&str, &str, &[Kind])] = &[
    ("unicycle_rates", "unicycle", &[Kind::Rates]),
    ("unicycle_jacobians", "unicycle", &[Kind::Jacobians]),
    ("euc_rates", "euc_3dof", &[Kind::Rates]),
    ("euc_jacobians", "euc_3dof", &[Kind::Jacobians]),
    ("bicycle_equations", "bicycle", &[Kind::MassMatrixAndBias]),
    ("bicycle_state", "bicycle", &[Kind::Jacobians]),
    (
        "bicycle_parameters",
        "bicycle",
        &[Kind::Jacobians, Kind::ParameterJacobian],
    ),
];
/// The fastest of so many derivations counts.
const REPETITIONS: usize = 3;

fn main() {
    let out = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    // Every run of the comparison times the generation anew.
    println!("cargo::rerun-if-env-changed=PEERS_RUN");
    let mut told = String::new();
    for (name, spec, kinds) in KERNELS {
        let file = format!("../../../generated/mechanisms/{spec}.toml");
        println!("cargo::rerun-if-changed={file}");
        let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
        let mut best = Duration::MAX;
        let mut source = String::new();
        for _ in 0..REPETITIONS {
            let start = Instant::now();
            let program = appell_codegen::compile(&file, &text, kinds);
            let program = program.unwrap_or_else(|report| panic!("{}", report.plain()));
            let emitted = emit_functions(&program, kinds);
            source = emitted
                .unwrap_or_else(|error| panic!("{file}: {error}"))
                .source;
            best = best.min(start.elapsed());
        }
        let counts = source
            .lines()
            .filter_map(|line| line.strip_prefix("/// Operations: "));
        let counts: Vec<&str> = counts.collect();
        writeln!(
            told,
            "{name}\t{}\t{}",
            best.as_secs_f64(),
            counts.join(" + ")
        )
        .expect("a string");
        std::fs::write(Path::new(&out).join(format!("{name}.rs")), source)
            .expect("OUT_DIR is there");
    }
    std::fs::write(Path::new(&out).join("told.tsv"), told).expect("OUT_DIR is there");
}
