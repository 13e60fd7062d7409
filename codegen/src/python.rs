//! Equations as Python functions over an array namespace: the same code runs on arrays of `numpy` and
//! `jax.numpy` and on symbols of `casadi` and `sympy`.

use std::fmt::Write as _;

use appell_runtime::model::Quantity;
use appell_spec::foreign::sentence;

use crate::infix::{Dialect, Infix, math_name, shape};
use crate::program::{Function, FunctionKind, Own, Program};
use crate::schedule::names::ArgumentNames;
use crate::schedule::pi::parts_of_pi;
use crate::schedule::{Argument, Schedule, Step, Tree, schedule};
use crate::symbolic::{self, Rational, Relation};

/// Adapts the names of namespaces; see the class `_Namespace`.
const PRELUDE: &str = include_str!("python/prelude.py");

/// Keywords of Python, and names that the functions use.
const KEYWORDS: &[&str] = &[
    "False", "None", "True", "and", "as", "assert", "async", "await", "break", "class", "continue",
    "def", "del", "elif", "else", "except", "finally", "for", "from", "global", "if", "import",
    "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise", "return", "try", "while",
    "with", "yield", "xp",
];

struct Python;

impl Dialect for Python {
    fn name(&self, name: &str) -> String {
        if KEYWORDS.contains(&name) {
            format!("{name}_")
        } else {
            name.to_owned()
        }
    }

    fn function(&self, function: symbolic::Function, of: &str) -> String {
        format!("_f.{}({of})", math_name(function))
    }

    fn atan2(&self, y: &str, x: &str) -> String {
        format!("_f.atan2({y}, {x})")
    }

    fn power(&self, base: &str, exponent: &str) -> String {
        format!("_f.power({base}, {exponent})")
    }

    fn choice(&self, relation: Relation, [a, b, then, otherwise]: [String; 4]) -> String {
        let sign = match relation {
            Relation::Less => "<",
            Relation::LessOrEqual => "<=",
        };
        format!("_f.where({a} {sign} {b}, {then}, {otherwise})")
    }
}

/// The module of a program: names, units and values of the spec, and a function for each of the functions
/// `kinds` that the program has.
pub fn module(program: &Program, kinds: &[FunctionKind]) -> String {
    let info = &program.info;
    let mut text = format!(
        "\"\"\"{}\n\nEquations of motion by the Gibbs-Appell method, emitted from {}.\n\n\
         Each function takes a namespace `xp` (`numpy`, `jax.numpy`, `casadi`, `sympy`), the time t, and sequences\n\
         x (STATES), u (INPUTS) and p (PARAMETERS), all in SI. Entries may be arrays that broadcast.\n\"\"\"\n\n",
        docstring(&info.title),
        docstring(&program.file),
    );
    text.push_str(PRELUDE);
    text.push('\n');
    let lists = [
        ("STATES", &*info.states),
        ("INPUTS", &*info.inputs),
        ("PARAMETERS", &*info.parameters),
        ("OUTPUTS", &*info.outputs),
    ];
    for (name, quantities) in lists {
        text.push('\n');
        names(&mut text, name, quantities);
    }
    let values = [
        ("INITIAL_STATE", info.initial_state()),
        ("DEFAULT_PARAMETERS", info.default_parameters()),
    ];
    for (name, values) in values {
        let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
        let _ = writeln!(text, "{name} = [{}]", values.join(", "));
    }
    let arguments = ArgumentNames::of(program);
    let wanted = program
        .functions
        .iter()
        .filter(|function| kinds.contains(&function.kind));
    for function in wanted {
        let schedule = schedule(program, function);
        text.push_str("\n\n");
        definition(&mut text, program, function, &schedule, &arguments);
    }
    text
}

/// Names with their units and sentences.
fn names(text: &mut String, list: &str, quantities: &[Quantity]) {
    let _ = writeln!(text, "{list} = (");
    for quantity in quantities {
        let _ = writeln!(
            text,
            "    {},  # {} [{}]",
            quoted(&quantity.name),
            sentence(&quantity.about),
            sentence(&quantity.unit)
        );
    }
    text.push_str(")\n");
}

fn definition(
    text: &mut String,
    program: &Program,
    function: &Function,
    schedule: &Schedule,
    arguments: &ArgumentNames,
) {
    let infix = Infix {
        dialect: &Python,
        schedule,
        names: arguments,
    };
    let own = function.kind.takes().map_or("", Own::name);
    let [t, x, u, p, own] = ["t", "x", "u", "p", own].map(|name| {
        if name == "t" {
            Python.name(&arguments.time)
        } else {
            infix.free(name)
        }
    });
    let last = match function.kind.takes() {
        Some(_) => format!(", {own}"),
        None => String::new(),
    };
    let _ = writeln!(
        text,
        "def {}(xp, {t}, {x}, {u}, {p}{last}):",
        function.kind.name()
    );
    let about = function.kind.about().replace(['[', ']', '`'], "");
    let _ = writeln!(text, "    \"\"\"{}\n\n    Returns:", docstring(&about));
    for array in &function.results {
        let shape = shape(program, array.layout);
        let shape: Vec<String> = shape.iter().map(ToString::to_string).collect();
        let shape = if shape.is_empty() {
            "a number".to_owned()
        } else {
            shape.join(" by ")
        };
        let _ = writeln!(
            text,
            "        {}: {} ({shape})",
            docstring(&array.name),
            docstring(&array.about)
        );
    }
    text.push_str("    \"\"\"\n    _f = _namespace(xp)\n");
    for &argument in &schedule.arguments {
        let name = Python.name(arguments.get(argument));
        let (of, index) = match argument {
            Argument::Time => continue,
            Argument::State(i) => (&x, i),
            Argument::Input(i) => (&u, i),
            Argument::Parameter(i) => (&p, i),
            Argument::Weight(i) | Argument::OutputWeight(i) | Argument::Acceleration(i) => {
                (&own, i)
            }
        };
        let _ = writeln!(text, "    {name} = {of}[{index}]");
    }
    for value in infix.constants() {
        let name = Python.name(&arguments.constant(&value));
        let _ = writeln!(text, "    {name} = {}", constant(&value));
    }
    for step in &schedule.steps {
        statement(text, &infix, step);
    }
    let results: Vec<String> = (function.results.iter().zip(&schedule.results))
        .map(|(array, result)| nested(&infix, &shape(program, array.layout), &result.entries))
        .collect();
    let _ = match results.as_slice() {
        [one] => writeln!(text, "    return {one}"),
        all => writeln!(
            text,
            "    return (\n        {},\n    )",
            all.join(",\n        ")
        ),
    };
}

fn statement(text: &mut String, infix: &Infix<'_, Python>, step: &Step) {
    let _ = match step {
        Step::Let { value, tree } => {
            writeln!(text, "    {} = {}", infix.value(*value), infix.tree(tree))
        }
        Step::SinCos { sin, cos, angle } => {
            let (sin, cos, angle) = (infix.value(*sin), infix.value(*cos), infix.tree(angle));
            writeln!(text, "    {sin}, {cos} = _f.sin({angle}), _f.cos({angle})")
        }
        Step::Factor {
            factorisation,
            size,
            matrix,
        } => {
            let rows: Vec<String> = matrix
                .chunks(*size)
                .map(|row| format!("[{}]", infix.list(row)))
                .collect();
            writeln!(text, "    _matrix_{factorisation} = [{}]", rows.join(", "))
        }
        Step::Solve {
            factorisation,
            values,
            right,
        } => {
            let values: Vec<String> = values.iter().map(|value| infix.value(*value)).collect();
            let right = infix.list(right);
            writeln!(
                text,
                "    {}, = _f.solve(_matrix_{factorisation}, [{right}])",
                values.join(", ")
            )
        }
        Step::Paragraph { title } if title.is_empty() => writeln!(text),
        Step::Paragraph { title } => writeln!(text, "\n    # {}", sentence(title)),
    };
}

/// Nested lists of an array's shape.
fn nested(infix: &Infix<'_, Python>, shape: &[usize], entries: &[Tree]) -> String {
    match shape {
        [] => entries
            .first()
            .map_or_else(|| "0.0".to_owned(), |entry| infix.tree(entry)),
        [_] => format!("[{}]", infix.list(entries)),
        [rows, columns, ..] => {
            let row =
                |row: usize| format!("[{}]", infix.list(&entries[row * columns..][..*columns]));
            let rows: Vec<String> = (0..*rows).map(row).collect();
            format!("[{}]", rows.join(", "))
        }
    }
}

/// A numeric constant: exact if the namespace has exact numbers.
fn constant(value: &Rational) -> String {
    if let Some((numerator, denominator)) = parts_of_pi(value) {
        return format!("_f.number({numerator}, {denominator}) * _f.pi");
    }
    match value.as_small() {
        Some((whole, 1)) => format!("{whole}"),
        Some((numerator, denominator)) => format!("_f.number({numerator}, {denominator})"),
        None => number(value.to_f64()),
    }
}

fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{value:?}")
    } else {
        format!("float(\"{value}\")")
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", docstring(text))
}

/// A text that may occur in a triple-quoted string.
fn docstring(text: &str) -> String {
    sentence(text).replace('"', "'")
}
