//! The numbers of a model in C: sizes, values of the spec, signals, coefficients of the integrator.

use std::fmt::Write as _;

use appell_runtime::Signal;
use appell_runtime::integrate::Dop853;
use appell_runtime::model::Interpolation;

use super::inputs::InputsOfStep;
use super::variables::Variables;
use crate::c::adapters;
use crate::program::Program;

/// Default tolerance of a co-simulation.
pub(super) const DEFAULT_TOLERANCE: f64 = 1e-10;
/// The smallest tolerance that rounding permits.
const LEAST_TOLERANCE: f64 = 1e-13;
/// Placeholder of the instantiation token, which is a hash of the surrounding texts.
pub(super) const TOKEN: &str = "@TOKEN@";

/// `fmi-equations.h`.
pub(super) fn tables(
    program: &Program,
    variables: &Variables,
    name: &str,
    inputs: InputsOfStep,
) -> String {
    let info = &program.info;
    let mut text = format!(
        "/* What a model is made of, and its functions behind plain arrays. */\n\
         #ifndef FMI_EQUATIONS_H_\n#define FMI_EQUATIONS_H_\n\n#include \"{name}.h\"\n\n#include <string.h>\n\n\
         /* An array has an entry at least. */\n#define ROOM(n) ((n) > 0 ? (n) : 1)\n\n"
    );
    for (name, value) in [
        ("STATES", info.states.len()),
        ("SPEEDS", info.speeds),
        ("INPUTS", info.declared_inputs),
        ("ALL_INPUTS", info.inputs.len()),
        ("PARAMETERS", info.parameters.len()),
        ("OUTPUTS", info.outputs.len()),
        ("SWITCHES", program.switch_len()),
        ("DEPENDENT", program.dependent.len()),
        ("SIGNALS", info.signals.len()),
        (
            "INPUTS_ARE_LINES",
            usize::from(inputs == InputsOfStep::Lines),
        ),
    ] {
        let _ = writeln!(text, "#define {name} {value}");
    }
    let _ = write!(
        text,
        "\n#define INSTANTIATION_TOKEN \"{TOKEN}\"\n#define DEFAULT_TOLERANCE {DEFAULT_TOLERANCE:?}\n\
         #define LEAST_TOLERANCE {LEAST_TOLERANCE:?}\n\n"
    );
    numbers(&mut text, "initial_state", &info.initial_state());
    numbers(&mut text, "default_parameters", &info.default_parameters());
    let fixed = variables.fixed.iter().map(|&fixed| usize::from(fixed));
    integers(&mut text, "parameter_is_fixed", fixed);
    let dependent = program.dependent.iter().copied();
    integers(&mut text, "dependent_coordinates", dependent);
    signals(&mut text, program);
    coefficients(&mut text);
    text + &adapters(program) + "#endif\n"
}

fn signals(text: &mut String, program: &Program) {
    let info = &program.info;
    let _ = writeln!(text, "#define SIGNAL_HELD 0");
    let kinds = info.signals.iter().map(|table| match table.interpolation {
        Interpolation::Hold => 0,
        Interpolation::Linear | Interpolation::Cubic => 1,
    });
    integers(text, "signal_kinds", kinds);
    let ends = info.signals.iter().scan(0, |end, table| {
        *end += table.times.len();
        Some(*end)
    });
    integers(text, "signal_first", std::iter::once(0).chain(ends));
    let concatenated = |of: fn(&Signal) -> &[f64], tables: &[Signal]| -> Vec<f64> {
        tables
            .iter()
            .flat_map(|signal| of(signal).to_vec())
            .collect()
    };
    // The tables of a checked spec are functions of time.
    let tables: Vec<Signal> = (info.signals.iter())
        .filter_map(|table| Signal::new(table).ok())
        .collect();
    numbers(text, "signal_times", &concatenated(Signal::knots, &tables));
    numbers(
        text,
        "signal_values",
        &concatenated(Signal::values, &tables),
    );
    let curvatures = concatenated(Signal::curvatures, &tables);
    numbers(text, "signal_curvatures", &curvatures);
    let inputs = || info.signal_inputs.iter();
    integers(text, "signal_of_input", inputs().map(|(signal, _)| *signal));
    let orders = inputs().map(|(_, order)| usize::from(*order));
    integers(text, "order_of_input", orders);
}

/// The method of order 8(5,3): rows of the stages, of the new state, of both errors.
fn coefficients(text: &mut String) {
    let method = Dop853::coefficients();
    let rows = (method.stages.iter())
        .chain([&method.weights])
        .chain(method.errors);
    let rows: Vec<_> = rows.collect();
    let stages = method.nodes.len() + 1;
    let _ = write!(
        text,
        "#define STAGES {stages}\n#define ERROR_5 {stages}\n#define ERROR_3 {}\n",
        stages + 1
    );
    numbers(text, "stage_nodes", method.nodes);
    let ends = rows.iter().scan(0, |end, row| {
        *end += row.len();
        Some(*end)
    });
    integers(text, "row_first", std::iter::once(0).chain(ends));
    let terms = || rows.iter().flat_map(|row| row.iter());
    integers(text, "row_stages", terms().map(|(stage, _)| *stage));
    let weights: Vec<f64> = terms().map(|(_, weight)| *weight).collect();
    numbers(text, "row_weights", &weights);
    text.push('\n');
}

fn numbers(text: &mut String, name: &str, values: &[f64]) {
    let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    array(text, "double", name, &values);
}

fn integers(text: &mut String, name: &str, values: impl Iterator<Item = usize>) {
    let values: Vec<String> = values.map(|value| value.to_string()).collect();
    array(text, "int", name, &values);
}

/// An array with as many entries per line as fit; a single zero if it is empty.
fn array(text: &mut String, kind: &str, name: &str, values: &[String]) {
    let _ = write!(text, "static const {kind} {name}[] = {{");
    let mut width = usize::MAX;
    for value in values {
        if width > 100 {
            text.push_str("\n   ");
            width = 0;
        }
        let _ = write!(text, " {value},");
        width = width.saturating_add(value.len() + 2);
    }
    text.push_str(if values.is_empty() { "0};\n" } else { "\n};\n" });
}
