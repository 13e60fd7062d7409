//! C code of all shipped mechanisms: it compiles without warnings and is bit-identical to the schedule.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use appell_codegen::c::{Emitted, Options, Real, emit};
use appell_codegen::compile;
use appell_codegen::program::{FunctionKind, Layout, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::tape::interpret;

const STRICT: &[&str] = &[
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-pedantic",
    "-Werror",
];

/// The shipped specs.
pub(crate) fn specs() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../generated/mechanisms");
    let entries = std::fs::read_dir(folder).expect("the shipped specs");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut specs: Vec<(String, String)> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .map(|path| {
            let text = std::fs::read_to_string(&path).expect("a spec");
            (
                path.file_stem()
                    .expect("a name")
                    .to_string_lossy()
                    .into_owned(),
                text,
            )
        })
        .collect();
    specs.sort();
    specs
}

fn program(name: &str, text: &str) -> Program {
    compile(name, text, &FunctionKind::STANDARD).expect("a valid spec")
}

fn options(real: Real) -> Options {
    Options {
        functions: FunctionKind::STANDARD.to_vec(),
        real,
        integrator: true,
    }
}

/// A folder for the files of a mechanism.
pub(crate) fn folder(test: &str, name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Writes both files to a folder of their own.
fn written(test: &str, emitted: &Emitted) -> PathBuf {
    let folder = folder(test, &emitted.name);
    let file = |end: &str, text: &str| {
        std::fs::write(folder.join(format!("{}.{end}", emitted.name)), text).expect("a file");
    };
    file("h", &emitted.header);
    file("c", &emitted.source);
    folder
}

/// The C compilers to try: the system's, and Clang where it is installed.
pub(crate) fn compilers() -> Vec<&'static str> {
    let clang = Command::new("clang").arg("--version").output();
    let clang = clang.is_ok_and(|told| told.status.success());
    if !clang {
        println!("not tried: there is no clang on the path");
    }
    [("cc", true), ("clang", clang)]
        .into_iter()
        .filter_map(|(name, is_there)| is_there.then_some(name))
        .collect()
}

/// Runs the C compiler in a folder, for files that have to compile without a warning.
pub(crate) fn compiled(compiler: &str, folder: &Path, arguments: &[&str]) {
    let told = Command::new(compiler)
        .args(STRICT)
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("a C compiler");
    let errors = String::from_utf8_lossy(&told.stderr);
    assert!(
        told.status.success(),
        "{}: {}",
        folder.display(),
        errors.lines().take(20).collect::<Vec<_>>().join("\n")
    );
}

/// A state, inputs and parameters off the spec's, the same in every run.
fn place(program: &Program) -> [Vec<f64>; 3] {
    let wave = |k: usize| 0.1 * (1.7 * k as f64 + 0.4).sin();
    let info = &program.info;
    let x = info
        .initial_state()
        .iter()
        .enumerate()
        .map(|(k, x)| x + wave(k))
        .collect();
    let u = (0..info.input_len()).map(|k| 3.0 * wave(k + 5)).collect();
    let p = info
        .default_parameters()
        .iter()
        .enumerate()
        .map(|(k, p)| p * (1.0 + wave(k)))
        .collect();
    [x, u, p]
}

/// A program that prints the bits of the rates and both Jacobians, a number a line.
fn printer(program: &Program, emitted: &Emitted, [x, u, p]: &[Vec<f64>; 3]) -> String {
    let name = &emitted.name;
    let struct_name: String = name
        .split('_')
        .map(|word| word[..1].to_ascii_uppercase() + &word[1..])
        .collect();
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        if values.is_empty() {
            "0".to_owned()
        } else {
            values.join(", ")
        }
    };
    let (n, m) = (program.info.states.len(), program.info.input_len());
    let mut text = format!(
        "#include <stdio.h>\n#include <string.h>\n#include \"{name}.h\"\n\
         static void show(const double *v, int n) {{\n    int i;\n    for (i = 0; i < n; i++) {{\n        \
         unsigned long long bits;\n        memcpy(&bits, v + i, 8);\n        printf(\"%llx\\n\", bits);\n    }}\n}}\n\
         int main(void) {{\n    {struct_name}State x = {{{}}};\n    {struct_name}Inputs u = {{{}}};\n    \
         {struct_name}Parameters p = {{{}}};\n    {struct_name}Rates rates;\n    double v[{n}], a[{n}][{n}];\n",
        list(x),
        list(u),
        list(p)
    );
    let b = if m > 0 { ", b" } else { "" };
    if m > 0 {
        let _ = writeln!(text, "    double b[{n}][{m}];");
    }
    let _ = write!(
        text,
        "    {name}_jacobians(0.3, &p, &x, &u, &rates, a{b});\n    memcpy(v, &rates, sizeof v);\n    \
         show(v, {n});\n    show(&a[0][0], {n} * {n});\n"
    );
    if m > 0 {
        let _ = writeln!(text, "    show(&b[0][0], {n} * {m});");
    }
    text + "    return 0;\n}\n"
}

#[test]
fn c_of_all_shipped_mechanisms_compiles_without_a_warning_and_gives_the_same_bits() {
    for (name, text) in specs() {
        let program = program(&name, &text);
        let emitted = emit(&program, &options(Real::Double));
        let folder = written("c_double", &emitted);
        let place = place(&program);
        std::fs::write(folder.join("main.c"), printer(&program, &emitted, &place)).expect("a file");
        let function = program
            .function(FunctionKind::Jacobians)
            .expect("Jacobians");
        let [x, u, p] = &place;
        let expected = interpret(&schedule(&program, function), 0.3, x, u, p).concat();
        let expected: Vec<u64> = expected.iter().map(|value| value.to_bits()).collect();
        let source = format!("{}.c", emitted.name);
        for compiler in compilers() {
            compiled(compiler, &folder, &[&source, "main.c", "-o", "run", "-lm"]);
            let told = Command::new(folder.join("run"))
                .output()
                .expect("the program runs");
            let bits = String::from_utf8(told.stdout).expect("text");
            let found = bits
                .lines()
                .map(|line| u64::from_str_radix(line, 16).expect("bits"));
            assert_eq!(found.collect::<Vec<_>>(), expected, "{name}, {compiler}");
        }
    }
}

#[test]
fn c_in_single_precision_compiles_without_a_warning() {
    for (name, text) in specs() {
        let program = program(&name, &text);
        let emitted = emit(&program, &options(Real::Float));
        let folder = written("c_float", &emitted);
        let source = format!("{}.c", emitted.name);
        for compiler in compilers() {
            let arguments = ["-Wdouble-promotion", "-c", &source, "-o", "run.o"];
            compiled(compiler, &folder, &arguments);
        }
        assert!(!emitted.source.contains("double "), "{name}");
    }
}

#[test]
fn texts_of_a_spec_end_no_comment_and_names_are_no_words_of_c() {
    let text = r#"
[mechanism]
name  = "int"
title = "*/ int main(void) { return 1; } /*"
[parameters]
double = { value = 2, unit = "kg", about = "*/ #error /* ??/" }
I      = { value = 1, unit = "m" }
[coordinates]
auto = { unit = "m", about = "\\" }
[points]
C = { from = "O", in = "ground", at = ["auto", 0, "I"] }
[bodies]
block = { centre = "C", mass = "double" }
[pseudo_velocities]
register = { value = "dot(auto)", unit = "m/s" }
"#;
    let program = program("int.toml", text);
    let emitted = emit(&program, &options(Real::Double));
    let folder = written("c_hostile", &emitted);
    compiled(
        "cc",
        &folder,
        &["-c", &format!("{}.c", emitted.name), "-o", "run.o"],
    );
    assert!(matches!(
        program.functions[0].results[0].layout,
        Layout::Vector(_)
    ));
}
