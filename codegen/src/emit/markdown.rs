//! The page about a model, and its spec as a constant.

use std::fmt::Write;

use appell_runtime::model::Quantity;
use appell_spec::foreign::is_seen;

use super::layout::{code, escaped};
use super::types::Types;
use crate::program::FunctionKind;
use crate::tape::OperationCount;

/// Description of a model: title, source, tables of all quantities, costs.
pub(super) fn page(types: &Types<'_>, costs: &[(FunctionKind, OperationCount)]) -> String {
    let info = &types.program.info;
    let mut page = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(page, "{}\n", escaped(&info.title));
    if !info.source.is_empty() {
        let _ = writeln!(page, "Source: {}\n", escaped(&info.source));
    }
    let _ = writeln!(page, "Spec: {}.", code(&types.program.file));
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
    let (column, rule) = if value.is_empty() {
        (String::new(), "")
    } else {
        (format!(" {value} |"), "---|")
    };
    let _ = writeln!(
        page,
        "\n# {title}\n\n| name | meaning | unit |{column}\n|---|---|---|{rule}"
    );
    for quantity in quantities {
        let name = code(&quantity.name);
        let (about, unit) = (escaped(&quantity.about), escaped(&quantity.unit));
        let _ = write!(page, "| {name} | {about} | {unit} |");
        if !value.is_empty() {
            let _ = write!(page, " {} |", quantity.to_unit(quantity.value));
        }
        page.push('\n');
    }
}

/// Maximum number of `#` around a raw string in Rust.
const MOST_GUARDS: usize = 255;

/// The spec as a raw string, or as an escaped one if a raw string cannot contain it.
pub(super) fn spec_constant(spec: &str) -> String {
    const ABOUT: &str = "/// The spec this module is made from.\npub const SPEC: &str = ";
    let mut guard = "#".to_owned();
    while spec.contains(&format!("\"{guard}")) && guard.len() <= MOST_GUARDS {
        guard.push('#');
    }
    if guard.len() > MOST_GUARDS || !is_seen(spec) {
        return format!("{ABOUT}{spec:?};\n\n");
    }
    format!("{ABOUT}r{guard}\"{spec}\"{guard};\n\n")
}
