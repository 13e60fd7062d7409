//! A design as a feedback file.

use std::fmt::Write as _;

use appell_runtime::model::Quantity;

use super::design::{Design, Law};
use super::explain::pole_text;
use crate::setup::Setup;

/// The text of the file: gains in SI with all digits, other values in the units of the spec.
pub(crate) fn text(design: &Design, setup: &Setup<'_>, model: &str) -> String {
    let Some(law) = &design.law else {
        return String::new();
    };
    let info = setup.info;
    let states: Vec<&Quantity> = design.outputs.iter().map(|&s| &info.states[s]).collect();
    let inputs = &design.equations.inputs;
    let input = |i: &usize| format!("\"{}\"", info.inputs[*i].name);
    let mut text = header(design, law, setup, model);
    let _ = writeln!(text, "\nmechanism = \"{}\"", info.name);
    if let [one] = inputs[..] {
        let _ = writeln!(text, "input = {}", input(&one));
    } else {
        let names: Vec<String> = inputs.iter().map(input).collect();
        let _ = writeln!(text, "inputs = [{}]", names.join(", "));
    }
    let names: Vec<String> = states
        .iter()
        .map(|state| format!("\"{}\"", state.name))
        .collect();
    let _ = writeln!(text, "states = [{}]", names.join(", "));
    let n = states.len();
    matrix(&mut text, "gains", &law.gain.columns(0, n).into_owned());
    let offsets: Vec<f64> = inputs
        .iter()
        .map(|&i| info.inputs[i].to_unit(design.u[i]))
        .collect();
    if offsets.iter().any(|offset| *offset != 0.0) {
        let list: Vec<String> = offsets.iter().map(|offset| format!("{offset:?}")).collect();
        let _ = writeln!(text, "offset = [{}]", list.join(", "));
    }
    if let Some(sampling) = law.sampling {
        let _ = writeln!(text, "sampled_ms = {:?}", sampling.period() * 1e3);
        let _ = writeln!(text, "delay_ms = {:?}", sampling.delay() * 1e3);
        let pending = law.gain.ncols() - n;
        if pending > 0 {
            matrix(
                &mut text,
                "pending_gains",
                &law.gain.columns(n, pending).into_owned(),
            );
        }
    }
    let wanted = design.outputs.iter().copied();
    table(
        &mut text,
        "desired",
        setup,
        &design.x,
        wanted.filter(|&s| design.x[s] != 0.0),
    );
    let given = info.initial_state();
    #[expect(
        clippy::float_cmp,
        reason = "what is as in the spec need not be written"
    )]
    let moved = (0..design.x.len()).filter(|&s| design.x[s] != given[s]);
    table(&mut text, "initial", setup, &design.x, moved);
    text
}

fn header(design: &Design, law: &Law, setup: &Setup<'_>, model: &str) -> String {
    let poles: Vec<String> = law.poles.iter().map(|pole| pole_text(*pole)).collect();
    let place = if law.sampling.is_some() { "z" } else { "1/s" };
    let mut text = format!(
        "# u = offset - K (y - y_desired), designed for {}.\n# Poles of the closed loop, {place}: {}\n",
        setup.info.title,
        poles.join(", ")
    );
    let others = setup.info.parameters.iter().zip(&design.p);
    #[expect(
        clippy::float_cmp,
        reason = "what is as in the spec need not be written"
    )]
    let others = others.filter(|(parameter, value)| parameter.value != **value);
    let mut flags = String::new();
    for (parameter, value) in others {
        let _ = write!(
            flags,
            " --set {}={:?}",
            parameter.name,
            parameter.to_unit(*value)
        );
    }
    for (input, value) in design.u.iter().enumerate() {
        if *value != 0.0 && !design.equations.inputs.contains(&input) {
            let input = &setup.info.inputs[input];
            let _ = write!(flags, " --input {}={:?}", input.name, input.to_unit(*value));
        }
    }
    let _ = writeln!(
        text,
        "#\n# appell simulate {model}{flags} --feedback FILE.toml"
    );
    text
}

/// One list for one row, a list of lists for several.
fn matrix(text: &mut String, key: &str, rows: &nalgebra::DMatrix<f64>) {
    let row = |i: usize, margin: &str| {
        let numbers = rows.row(i);
        let lines = numbers
            .iter()
            .map(|number| format!("{margin}    {number:?},\n"));
        lines.collect::<String>()
    };
    let body = if rows.nrows() == 1 {
        row(0, "")
    } else {
        let rows = (0..rows.nrows()).map(|i| format!("    [\n{}    ],\n", row(i, "    ")));
        rows.collect()
    };
    let _ = writeln!(text, "{key} = [\n{body}]");
}

fn table(
    text: &mut String,
    key: &str,
    setup: &Setup<'_>,
    x: &[f64],
    states: impl Iterator<Item = usize>,
) {
    let mut lines = String::new();
    for state in states {
        let quantity = &setup.info.states[state];
        let _ = writeln!(
            lines,
            "{} = {:?}",
            quantity.name,
            quantity.to_unit(x[state])
        );
    }
    if !lines.is_empty() {
        let _ = write!(text, "\n[{key}]\n{lines}");
    }
}
