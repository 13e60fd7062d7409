//! A design as a feedback file.

use std::fmt::Write as _;

use appell_runtime::model::{ModelInfo, Quantity};
use appell_spec::foreign::sentence;

use super::design::{Design, DesignedGains};
use super::remedies::pole_text;
use crate::setup::Setup;

/// The text of the file: gains in SI with all digits, other values in the units of the spec.
pub(crate) fn text(design: &Design, setup: &Setup<'_>, model: &str) -> String {
    let Some(law) = &design.law else {
        return String::new();
    };
    let info = setup.info;
    let n = design.outputs.len();
    let mut text = header(design, law, setup, model);
    text += &names(design, info);
    matrix(&mut text, "gains", &law.gain.columns(0, n).into_owned());
    text += &offsets(design, info);
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
    let wanted = design.outputs.iter().filter_map(|&state| {
        let (value, rate) = (design.x[state], design.running(state));
        let text = desired(&info.states[state], value, rate);
        (value != 0.0 || rate != 0.0).then_some((state, text))
    });
    table(&mut text, "desired", info, wanted);
    let given = info.initial_state();
    #[expect(
        clippy::float_cmp,
        reason = "values equal to those of the spec are omitted"
    )]
    let moved = (0..design.x.len()).filter(|&s| design.x[s] != given[s]);
    let moved = moved.map(|s| (s, format!("{:?}", info.states[s].to_unit(design.x[s]))));
    table(&mut text, "initial", info, moved);
    text
}

/// The text of a file with a gain schedule.
pub(crate) fn schedule(
    over: &Quantity,
    designs: &[(f64, Design)],
    setup: &Setup<'_>,
    model: &str,
) -> String {
    let Some((_, first)) = designs.first() else {
        return String::new();
    };
    let info = setup.info;
    let mut text = format!(
        "# u = offset - K (y - y_steady - y_desired) with gains over {}, designed for {}.\n#\n\
         # appell simulate {}{} --feedback FILE.toml\n",
        over.name,
        sentence(&info.title),
        sentence(model),
        flags(first, info, Some(&over.name))
    );
    text += &names(first, info);
    let _ = writeln!(text, "over = \"{}\"", over.name);
    for (value, design) in designs {
        let Some(law) = &design.law else { continue };
        let _ = writeln!(text, "\n[[at]]\nvalue = {:?}", over.to_unit(*value));
        matrix(&mut text, "gains", &law.gain);
        text += &offsets(design, info);
        let steady = design.outputs.iter().map(|&state| (state, design.x[state]));
        let steady = steady
            .filter(|(_, value)| *value != 0.0)
            .map(|(state, value)| {
                let state = &info.states[state];
                format!("{} = {:?}", state.name, state.to_unit(value))
            });
        let steady: Vec<String> = steady.collect();
        if !steady.is_empty() {
            let _ = writeln!(text, "steady = {{ {} }}", steady.join(", "));
        }
    }
    text
}

/// Mechanism, inputs and states of a law.
fn names(design: &Design, info: &ModelInfo) -> String {
    let quoted = |quantity: &Quantity| format!("\"{}\"", quantity.name);
    let mut text = format!("\nmechanism = \"{}\"\n", info.name);
    let inputs = design.equations.inputs.iter();
    let inputs: Vec<String> = inputs.map(|&i| quoted(&info.inputs[i])).collect();
    let _ = match &inputs[..] {
        [one] => writeln!(text, "input = {one}"),
        all => writeln!(text, "inputs = [{}]", all.join(", ")),
    };
    let states = design
        .outputs
        .iter()
        .map(|&state| quoted(&info.states[state]));
    let states: Vec<String> = states.collect();
    let _ = writeln!(text, "states = [{}]", states.join(", "));
    text
}

/// The inputs on the steady motion, if they are not zero.
fn offsets(design: &Design, info: &ModelInfo) -> String {
    let inputs = design.equations.inputs.iter();
    let offsets: Vec<f64> = inputs
        .map(|&input| info.inputs[input].to_unit(design.u[input]))
        .collect();
    if offsets.iter().all(|offset| *offset == 0.0) {
        return String::new();
    }
    let list: Vec<String> = offsets.iter().map(|offset| format!("{offset:?}")).collect();
    format!("offset = [{}]\n", list.join(", "))
}

fn header(design: &Design, law: &DesignedGains, setup: &Setup<'_>, model: &str) -> String {
    let poles: Vec<String> = law.poles.iter().map(|pole| pole_text(*pole)).collect();
    let place = if law.sampling.is_some() { "z" } else { "1/s" };
    let mut text = format!(
        "# u = offset - K (y - y_desired), designed for {}.\n# Poles of the closed loop, {place}: {}\n",
        sentence(&setup.info.title),
        poles.join(", ")
    );
    let flags = flags(design, setup.info, None);
    let _ = writeln!(
        text,
        "#\n# appell simulate {}{flags} --feedback FILE.toml",
        sentence(model)
    );
    text
}

/// The flags with which the motion of a design is simulated, those for a quantity that varies left out.
fn flags(design: &Design, info: &ModelInfo, varied: Option<&str>) -> String {
    let others = info.parameters.iter().zip(&design.p);
    #[expect(
        clippy::float_cmp,
        reason = "values equal to those of the spec are omitted"
    )]
    let others = others.filter(|(parameter, value)| {
        parameter.value != **value && varied != Some(&*parameter.name)
    });
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
            let input = &info.inputs[input];
            let _ = write!(flags, " --input {}={:?}", input.name, input.to_unit(*value));
        }
    }
    flags
}

/// A list for one row, a list of lists for several.
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

/// The desired value of a state: its value on the motion, which may advance.
fn desired(state: &Quantity, value: f64, rate: f64) -> String {
    let [value, rate] = [value, rate].map(|si| state.to_unit(si));
    if rate == 0.0 {
        return format!("{value:?}");
    }
    let unit = match &*state.unit {
        "" => "1",
        unit => unit,
    };
    format!("\"{value:?}[{unit}] + {rate:?}[{unit}/s]*t\"")
}

fn table(
    text: &mut String,
    key: &str,
    info: &ModelInfo,
    states: impl Iterator<Item = (usize, String)>,
) {
    let lines = states.map(|(state, value)| format!("{} = {value}\n", info.states[state].name));
    let lines: String = lines.collect();
    if !lines.is_empty() {
        let _ = write!(text, "\n[{key}]\n{lines}");
    }
}
