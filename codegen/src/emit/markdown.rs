//! The page about a model, and its spec as a constant.

use std::fmt::Write;

use appell_runtime::model::Quantity;

use super::layout::{escaped, one_line};
use super::types::Types;
use crate::program::FunctionKind;
use crate::schedule::OperationCount;

/// What a model is made of: title, source, tables of all quantities, costs.
pub(super) fn page(types: &Types<'_>, costs: &[(FunctionKind, OperationCount)]) -> String {
    let info = &types.program.info;
    let mut page = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(page, "{}\n", escaped(&info.title));
    if !info.source.is_empty() {
        let _ = writeln!(page, "Source: {}\n", escaped(&info.source));
    }
    let _ = writeln!(
        page,
        "Spec: `{}`.",
        one_line(&types.program.file).replace('`', "'")
    );
    let speeds = info.speed_quantities();
    table(&mut page, "Pseudo-velocities", "initial", speeds);
    table(
        &mut page,
        "Coordinates",
        "initial",
        info.coordinate_quantities(),
    );
    table(&mut page, "Inputs", "", &info.inputs);
    table(&mut page, "Parameters", "value", &info.parameters);
    table(&mut page, "Outputs", "", &info.outputs);
    if !costs.is_empty() {
        page.push_str("\n# Operations\n\n| function | operations |\n|---|---|\n");
        for (kind, cost) in costs {
            let _ = writeln!(page, "| `{}` | {cost} |", kind.name());
        }
    }
    page
}

fn table(page: &mut String, title: &str, value: &str, quantities: &[Quantity]) {
    if quantities.is_empty() {
        return;
    }
    let cell = |text: &str| escaped(text).replace('|', "\\|");
    if value.is_empty() {
        let _ = writeln!(
            page,
            "\n# {title}\n\n| name | meaning | unit |\n|---|---|---|"
        );
    } else {
        let _ = writeln!(
            page,
            "\n# {title}\n\n| name | meaning | unit | {value} |\n|---|---|---|---|"
        );
    }
    for quantity in quantities {
        let (name, about) = (cell(&quantity.name), cell(&quantity.about));
        let unit = cell(&quantity.unit);
        let _ = write!(page, "| `{name}` | {about} | {unit} |");
        if !value.is_empty() {
            let _ = write!(page, " {} |", quantity.to_unit(quantity.value));
        }
        page.push('\n');
    }
}

/// The spec as a raw string, or as an escaped one where a raw string cannot hold it.
pub(super) fn spec_constant(spec: &str) -> String {
    const ABOUT: &str = "/// The spec this module is made from.\npub const SPEC: &str = ";
    let needs_escapes = spec
        .chars()
        .any(|c| c == '\r' || one_line(&c.to_string()).is_empty() && !c.is_whitespace());
    if needs_escapes {
        return format!("{ABOUT}{spec:?};\n\n");
    }
    let mut guard = "#".to_owned();
    while spec.contains(&format!("\"{guard}")) {
        guard.push('#');
    }
    format!("{ABOUT}r{guard}\"{spec}\"{guard};\n\n")
}
