//! FMUs: sources that compile without warnings, descriptions that no text of a spec breaks.

use appell_codegen::compile;
use appell_codegen::fmu::{Emitted, InputsOfStep, emit, functions};

use crate::c_code::{compiled, compilers, folder, specs};

fn fmu(file: &str, text: &str) -> Emitted {
    emit(
        &compile(file, text, &functions()).expect("a valid spec"),
        InputsOfStep::default(),
    )
}

/// Compiles sources without a warning, with a prefix to their functions as in a program of several FMUs.
fn compiles(test: &str, fmu: &Emitted, files: &[String]) {
    let folder = folder(test, &fmu.name);
    for (name, text) in &fmu.sources {
        std::fs::write(folder.join(name), text).expect("a file");
    }
    for compiler in compilers() {
        let mut arguments = vec![
            "-DFMI3_FUNCTION_PREFIX=own_",
            "-Wshadow",
            "-Wstrict-prototypes",
            "-c",
        ];
        arguments.extend(files.iter().map(String::as_str));
        compiled(compiler, &folder, &arguments);
    }
}

#[test]
fn sources_of_all_shipped_mechanisms_compile_without_a_warning() {
    for (name, text) in specs() {
        let fmu = fmu(&name, &text);
        // `c_code.rs` compiles the equations.
        compiles("fmu", &fmu, &fmu.compiled[..1]);
    }
}

#[test]
fn equal_specs_have_equal_texts_and_other_numbers_another_token() {
    let (name, text) = specs().swap_remove(0);
    let token = |fmu: &Emitted| {
        let (_, rest) = fmu
            .model_description
            .split_once("Token=\"")
            .expect("a token");
        rest.split('"').next().unwrap_or_default().to_owned()
    };
    let (one, same) = (fmu(&name, &text), fmu(&name, &text));
    assert_eq!(one, same);
    let other = fmu(&name, &text.replacen("value = ", "value = 1", 1));
    assert_ne!(token(&one), token(&other));
    let (_, equations) = one
        .sources
        .iter()
        .find(|(name, _)| name == "fmi-equations.h")
        .expect("the tables");
    assert!(equations.contains(&token(&one)));
}

#[test]
fn an_fmu_whose_equations_time_switches_says_what_it_may_pass_over() {
    let plain = include_str!("emit_support/block.toml");
    let switched = plain.replace("stiffness = \"k\"", "stiffness = \"if(t < 2 [s], k, 2*k)\"");
    assert_ne!(plain, switched);
    for (text, warns) in [(plain, false), (switched.as_str(), true)] {
        let fmu = fmu("block.toml", text);
        assert_eq!(
            fmu.model_description.contains("\"logStatusWarning\""),
            warns
        );
    }
}

/// Names of C, of FMI, of the sources and of the independent variable; texts that end attributes and comments.
#[test]
fn a_spec_breaks_neither_xml_nor_c() {
    let text = r#"
[mechanism]
name  = "fmi3"
title = "*/ \"/><x> & ' ??/"
[parameters]
time   = { value = 2, unit = "kg", about = "\"/><Float64 name='x'/> */ #error" }
STATES = { value = 1, unit = "m", at_least = 0 }
EOF    = { value = 3, unit = "deg" }
[coordinates]
ROOM = { unit = "mm", about = "]]>", range = [-5, 5] }
[inputs]
calloc = { unit = "N" }
[points]
C = { from = "O", in = "ground", at = ["ROOM", 0, "STATES*cos(EOF)"] }
[bodies]
block = { centre = "C", mass = "time" }
[pseudo_velocities]
Motion = { value = "dot(ROOM)", unit = "mm/s" }
[loads]
push = { kind = "force", on = "C", in = "ground", vector = ["calloc", 0, 0] }
"#;
    let fmu = fmu("fmi3.toml", text);
    compiles("fmu_hostile", &fmu, &fmu.compiled);
    let description = &fmu.model_description;
    for expected in [
        r#"description="*/ &quot;/&gt;&lt;x&gt; &amp; &apos; ??/""#,
        r#"name="t" valueReference="0""#,
        r#"name="time" valueReference="1" description="&quot;/&gt;&lt;Float64 name=&apos;x&apos;/&gt; */ #error""#,
        r#"name="ROOM" valueReference="6" description="]]&gt;" unit="m" displayUnit="mm" min="-0.005" max="0.005""#,
        r#"<DisplayUnit name="mm" factor="1000.0"/>"#,
    ] {
        assert!(description.contains(expected), "{expected}\n{description}");
    }
    assert_eq!(description.matches("<Float64").count(), 9);
}

/// A discontinuous rate depends on its condition, though the derivative is zero; parameters of position
/// constraints are fixed.
#[test]
fn dependencies_and_fixed_parameters_are_those_of_the_equations() {
    let text = r#"
[mechanism]
name  = "slider"
title = "Two blocks on a bar"
[parameters]
m = { value = 1, unit = "kg" }
l = { value = 2, unit = "m" }
k = { value = 3, unit = "N" }
[coordinates]
x = { unit = "m", initial = 1.2 }
y = { unit = "m", initial = 1.6 }
z = { unit = "m" }
[inputs]
F = { unit = "N" }
[points]
A = { from = "O", in = "ground", at = ["x", 0, 0] }
B = { from = "O", in = "ground", at = [0, "y", 0] }
C = { from = "O", in = "ground", at = [0, 0, "z"] }
[bodies]
a = { centre = "A", mass = "m" }
b = { centre = "B", mass = "m" }
c = { centre = "C", mass = "m" }
[constraints]
bar = { kind = "position", dependent = "y", zero = "x^2 + y^2 - l^2" }
[pseudo_velocities]
v = "dot(x)"
w = "dot(z)"
[loads]
push = { kind = "force", on = "C", in = "ground", vector = [0, 0, "F - k*sign(z) - if(t < 1[s], k, 0)"] }
"#;
    let description = fmu("slider.toml", text).model_description;
    for expected in [
        r#"name="m" valueReference="1" unit="kg" causality="parameter" variability="tunable""#,
        r#"name="l" valueReference="2" unit="m" causality="parameter" variability="fixed""#,
        r#"name="y" valueReference="8" unit="m" causality="output" variability="continuous" initial="approx""#,
        r#"<ContinuousStateDerivative valueReference="11" dependencies="0 4 9" dependenciesKind="dependent dependent dependent"/>"#,
        r#"<ContinuousStateDerivative valueReference="12" dependencies="5" dependenciesKind="constant"/>"#,
        r#"<InitialUnknown valueReference="8"/>"#,
        r#"<EventIndicator valueReference="15" dependencies="0" dependenciesKind="dependent"/>"#,
    ] {
        assert!(description.contains(expected), "{expected}\n{description}");
    }
}

#[test]
fn a_model_without_parameters_inputs_and_outputs_compiles() {
    let text = r#"
[mechanism]
name  = "bare"
title = "A mass that nothing moves"
[coordinates]
x = { unit = "m" }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0] }
[bodies]
mass = { centre = "P", mass = "2[kg]" }
[pseudo_velocities]
v = "dot(x)"
"#;
    let fmu = fmu("bare.toml", text);
    compiles("fmu_bare", &fmu, &fmu.compiled);
    assert_eq!(fmu.model_description.matches("<Float64").count(), 5);
}
