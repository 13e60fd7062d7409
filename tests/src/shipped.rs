//! The shipped mechanisms, found by their files.

use std::path::{Path, PathBuf};

use appell_codegen::mechanics::assemble;
use appell_codegen::mechanics::{self, Derivation};
use appell_codegen::program::FunctionKind;
use appell_codegen::program::Program;
use appell_spec::Mechanism;

/// Mechanisms whose adjoints are short enough to be derived in a test: one or two blocks, formulas
/// alone, velocity constraints, and pivoting with dependent speeds.
pub const WITH_ADJOINTS: [&str; 5] = [
    "cart_pole",
    "double_pendulum",
    "chaplygin_sleigh",
    "rolling_wheel",
    "four_bar",
];

/// The root of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_path_buf()
}

/// Names of all shipped mechanisms in alphabetical order.
pub fn names() -> Vec<String> {
    let specs = specs("generated/mechanisms").into_iter();
    let stem = |path: PathBuf| path.file_stem().unwrap().to_string_lossy().into_owned();
    specs.map(stem).collect()
}

/// The mechanisms whose specs stand in a folder of the workspace.
pub fn mechanisms_in(folder: &str) -> Vec<Mechanism> {
    let specs = specs(folder).into_iter();
    let mechanism = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        read(&path.to_string_lossy(), &text)
    };
    specs.map(mechanism).collect()
}

/// The specs in a folder, in alphabetical order.
fn specs(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(workspace().join(folder)).unwrap();
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "no mechanism in {folder}");
    paths
}

/// Text of a shipped spec.
pub fn text(name: &str) -> String {
    let file = workspace().join(format!("generated/mechanisms/{name}.toml"));
    std::fs::read_to_string(file).unwrap()
}

/// A shipped mechanism.
pub fn mechanism(name: &str) -> Mechanism {
    read(&format!("{name}.toml"), &text(name))
}

/// A mechanism from the text of a spec.
pub fn read(file: &str, text: &str) -> Mechanism {
    match appell_spec::load(file, text) {
        Ok(checked) => checked.mechanism,
        Err(report) => panic!("{file}: {report}"),
    }
}

/// The derivation of a mechanism that must have one.
pub fn derive(mechanism: &Mechanism) -> Derivation {
    mechanics::derive(mechanism)
        .unwrap_or_else(|findings| panic!("{}: {findings:?}", mechanism.file))
}

/// The functions of a mechanism that every model has.
pub fn program(mechanism: &Mechanism) -> Program {
    program_of(mechanism, &FunctionKind::STANDARD)
}

/// Some functions of a mechanism.
pub fn program_of(mechanism: &Mechanism, kinds: &[FunctionKind]) -> Program {
    assemble::program(derive(mechanism), mechanism, kinds)
        .unwrap_or_else(|findings| panic!("{}: {findings:?}", mechanism.file))
}
