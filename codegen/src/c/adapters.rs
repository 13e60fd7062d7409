//! Adapts emitted functions to plain arrays of numbers, for C code shared by all models.

use std::fmt::Write as _;

use super::types::{GROUPS, Types};
use super::{Real, is_empty};
use crate::program::{Function, FunctionKind, Layout, Program};
use crate::text::shape;

/// A function of a model that reads and fills arrays of doubles, with the names of its results. Results without
/// entries, and functions that the program lacks, are skipped.
const ADAPTED: [(FunctionKind, &[&str]); 7] = [
    (FunctionKind::Rates, &["rates"]),
    (FunctionKind::Jacobians, &["rates", "a", "b"]),
    (FunctionKind::ParameterJacobian, &["p"]),
    (FunctionKind::Outputs, &["outputs"]),
    (FunctionKind::OutputJacobians, &["outputs", "c", "d"]),
    (FunctionKind::Switches, &["switches"]),
    (FunctionKind::PositionConstraints, &["residual", "jacobian"]),
];

/// The functions with adapters.
pub(crate) fn adapted() -> [FunctionKind; 7] {
    ADAPTED.map(|(kind, _)| kind)
}

/// Static functions `NAME_of_model(t, p, x, u, results…)` that wrap the emitted functions of the same names; no
/// emitted name has this suffix.
pub(crate) fn adapters(program: &Program) -> String {
    let types = Types::new(program, Real::Double);
    let mut text = loader(&types);
    for (kind, arrays) in ADAPTED {
        let function = program.function(kind).filter(|function| {
            let mut results = function.results.iter();
            results.any(|array| !is_empty(program, array))
        });
        text.push_str(&adapter(&types, kind, arrays, function));
    }
    text
}

/// Fills the structs of arguments.
fn loader(types: &Types<'_>) -> String {
    let arguments: Vec<String> = GROUPS
        .iter()
        .map(|(space, name, array)| {
            format!("const double *{array}, {} *{name}", types.type_name(*space))
        })
        .collect();
    let mut text = format!("static void load({}) {{\n", arguments.join(", "));
    for (space, name, array) in GROUPS {
        let _ = if types.fields(space).is_empty() {
            writeln!(
                text,
                "    memset({name}, 0, sizeof *{name});\n    (void){array};"
            )
        } else {
            writeln!(text, "    memcpy({name}, {array}, sizeof *{name});")
        };
    }
    text + "}\n\n"
}

fn adapter(
    types: &Types<'_>,
    kind: FunctionKind,
    arrays: &[&str],
    function: Option<&Function>,
) -> String {
    let to: Vec<String> = arrays
        .iter()
        .map(|name| format!("double *to_{name}"))
        .collect();
    let mut text = format!(
        "static void {}_of_model(double t, const double *p, const double *x, const double *u, {}) {{\n",
        kind.name(),
        to.join(", ")
    );
    let Some(function) = function else {
        for unused in ["t", "p", "x", "u"] {
            let _ = writeln!(text, "    (void){unused};");
        }
        for name in arrays {
            let _ = writeln!(text, "    (void)to_{name};");
        }
        return text + "}\n\n";
    };
    for (space, name, _) in GROUPS {
        let _ = writeln!(text, "    {} {name};", types.type_name(space));
    }
    let (mut arguments, mut stored) = (String::new(), String::new());
    for array in &function.results {
        let name = &array.name;
        if is_empty(types.program, array) {
            let _ = writeln!(stored, "    (void)to_{name};");
            continue;
        }
        let _ = match (array.layout, shape(types.program, array.layout).as_slice()) {
            (Layout::Vector(space), _) => {
                let _ = writeln!(text, "    {} named_{name};", types.type_name(space));
                let _ = writeln!(
                    stored,
                    "    memcpy(to_{name}, &named_{name}, sizeof named_{name});"
                );
                write!(arguments, ", &named_{name}")
            }
            (_, [_, columns]) => write!(arguments, ", (double (*)[{columns}])to_{name}"),
            _ => write!(arguments, ", to_{name}"),
        };
    }
    let _ = writeln!(
        text,
        "    load(p, &parameters, x, &state, u, &inputs);\n    {}_{}(t, &parameters, &state, &inputs{arguments});",
        types.prefix,
        kind.name()
    );
    text + &stored + "}\n\n"
}
