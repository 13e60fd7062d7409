//! The shipped mechanisms, found by their files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, OnceLock, PoisonError};

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::mechanics::assemble;
use appell_codegen::mechanics::{self, Derivation};
use appell_codegen::program::{FunctionKind, Program};
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
    ALL.keys().cloned().collect()
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

/// What is made of a shipped mechanism: each part once in a process, where it is first asked for.
struct Made {
    text: String,
    mechanism: Mechanism,
    derivation: OnceLock<Mutex<Derivation>>,
    standard: OnceLock<Executed<InterpretedModel>>,
    complete: OnceLock<Executed<JitModel>>,
}

/// A program and what executes it.
struct Executed<M> {
    program: Program,
    model: M,
}

static ALL: LazyLock<BTreeMap<String, Made>> = LazyLock::new(|| {
    let specs = specs("generated/mechanisms").into_iter();
    let made = |path: PathBuf| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).unwrap();
        let made = Made {
            mechanism: read(&format!("{name}.toml"), &text),
            text,
            derivation: OnceLock::new(),
            standard: OnceLock::new(),
            complete: OnceLock::new(),
        };
        (name, made)
    };
    specs.map(made).collect()
});

fn made(name: &str) -> &'static Made {
    ALL.get(name)
        .unwrap_or_else(|| panic!("`{name}` is not shipped"))
}

impl Made {
    fn standard(&self) -> &Executed<InterpretedModel> {
        self.standard.get_or_init(|| {
            let program = standard_program(&self.mechanism);
            let model = InterpretedModel::new(program.clone());
            Executed { program, model }
        })
    }

    fn complete(&self) -> &Executed<JitModel> {
        self.complete.get_or_init(|| {
            let program = program_of(&self.mechanism, &FunctionKind::ALL);
            let model = JitModel::new(&program).unwrap();
            Executed { program, model }
        })
    }
}

/// Text of a shipped spec.
pub fn text(name: &str) -> String {
    made(name).text.clone()
}

/// A shipped mechanism.
pub fn mechanism(name: &str) -> &'static Mechanism {
    &made(name).mechanism
}

/// The derivation of a shipped mechanism, to read and to add expressions to.
pub fn derivation(name: &str) -> MutexGuard<'static, Derivation> {
    let made = made(name);
    let shared = made
        .derivation
        .get_or_init(|| Mutex::new(derive(&made.mechanism)));
    // A test that failed while it held the lock has not changed what was derived.
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The functions of a shipped mechanism that every model has.
pub fn program(name: &str) -> &'static Program {
    &made(name).standard().program
}

/// The same functions, interpreted.
pub fn model(name: &str) -> &'static InterpretedModel {
    &made(name).standard().model
}

/// All functions of a shipped mechanism, with the adjoints.
pub fn complete_program(name: &str) -> &'static Program {
    &made(name).complete().program
}

/// The same functions as machine code.
pub fn complete_model(name: &str) -> &'static JitModel {
    &made(name).complete().model
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

/// The functions of any mechanism that every model has.
pub fn standard_program(mechanism: &Mechanism) -> Program {
    program_of(mechanism, &FunctionKind::STANDARD)
}

/// Some functions of a mechanism.
pub fn program_of(mechanism: &Mechanism, kinds: &[FunctionKind]) -> Program {
    assemble::program(derive(mechanism), mechanism, kinds)
        .unwrap_or_else(|findings| panic!("{}: {findings:?}", mechanism.file))
}
