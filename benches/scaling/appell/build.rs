//! Derives the specs of `SCALING_SPECS`, counts operations, and emits what is timed.
//!
//! `cases.tsv` in that folder has a line for each spec: its name and what is wanted of it, `all` for the time of all
//! functions, `model` for its file with everything, `kernels` for functions to link.

use std::path::{Path, PathBuf};

use appell_codegen::compile;
use appell_codegen::emit::{Options, emit, emit_functions};
use appell_codegen::program::{FunctionKind as Kind, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::tape::OperationCount;

const COUNTED: [Kind; 5] = [
    Kind::MassMatrixAndBias,
    Kind::Rates,
    Kind::Jacobians,
    Kind::InverseDynamics,
    Kind::InverseDynamicsJacobians,
];
/// What is linked and timed.
const TIMED: [Kind; 3] = [Kind::MassMatrixAndBias, Kind::Rates, Kind::Jacobians];
/// Derivations that take longer are not repeated.
const REPEATED_BELOW: f64 = 0.5;
/// The fastest of so many derivations counts.
const REPETITIONS: usize = 3;

/// As POSIX has it.
const CLOCKS_PER_SECOND: f64 = 1e6;

unsafe extern "C" {
    /// Time of the processor in this process: other work on the machine does not count.
    safe fn clock() -> std::ffi::c_long;
}

fn main() {
    let folder = PathBuf::from(std::env::var("SCALING_SPECS").expect("a folder of specs"));
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    // Every run of the comparison times the derivations anew.
    println!("cargo::rerun-if-env-changed=SCALING_RUN");
    println!("cargo::rerun-if-env-changed=SCALING_SPECS");
    let (mut told, mut modules) = (String::new(), String::new());
    for line in read(&folder.join("cases.tsv")).lines() {
        let (name, wanted) = line.split_once('\t').expect("two columns");
        let text = read(&folder.join(format!("{name}.toml")));
        for kind in COUNTED {
            told += &counted(name, &text, &[kind]);
        }
        if wanted.contains("all") {
            told += &counted(name, &text, &standard(name, &text));
        }
        if wanted.contains("model") {
            let model = emit(&program(name, &text, &standard(name, &text)), &Options::default());
            write(
                &out.join(format!("{name}_model.rs")),
                &model.expect("Rust").source,
            );
        }
        if wanted.contains("kernels") {
            modules += &kernels(name, &program(name, &text, &TIMED), &out);
        }
    }
    write(&out.join("told.tsv"), &told);
    write(&out.join("modules.rs"), &modules);
}

/// What is emitted of a spec unless more is asked for.
fn standard(name: &str, text: &str) -> Vec<Kind> {
    let spec = appell_codegen::compile::derived(name, text).expect("a spec");
    Kind::standard(spec.mechanism.parameters.len())
}

/// Derives some functions up to their schedules: name, function, seconds, operations, of them divisions, sine-cosine pairs.
fn counted(name: &str, text: &str, kinds: &[Kind]) -> String {
    let mut seconds = f64::INFINITY;
    let mut total = OperationCount::default();
    for _ in 0..REPETITIONS {
        let start = clock();
        let program = program(name, text, kinds);
        for function in &program.functions {
            total = OperationCount::of(&schedule(&program, function));
        }
        seconds = seconds.min((clock() - start) as f64 / CLOCKS_PER_SECOND);
        if seconds > REPEATED_BELOW {
            break;
        }
    }
    let function = if let [kind] = kinds {
        kind.name()
    } else {
        "all"
    };
    let OperationCount {
        divide,
        sin_cos,
        solves,
        ..
    } = total;
    assert!(
        solves == 0,
        "{name}: operations of linear systems are not counted"
    );
    format!(
        "{name}\t{function}\t{seconds}\t{}\t{divide}\t{sin_cos}\n",
        total.total()
    )
}

fn program(name: &str, text: &str, kinds: &[Kind]) -> Program {
    let program = compile::compile(&format!("{name}.toml"), text, kinds);
    program.unwrap_or_else(|report| panic!("{}", report.plain()))
}

/// Emits the functions of a robot, and writes what makes them callable from C.
fn kernels(name: &str, program: &Program, out: &Path) -> String {
    let info = &program.info;
    assert!(
        info.parameters.is_empty(),
        "{name}: numbers are not parameters"
    );
    let emitted = emit_functions(program, &COUNTED).expect("Rust");
    write(&out.join(format!("{name}.rs")), &emitted.source);
    let (n, m) = (info.states.len(), info.inputs.len());
    format!("kernels!({name}, appell_{name}_rates, appell_{name}_jacobians, {n}, {m});\n")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}
