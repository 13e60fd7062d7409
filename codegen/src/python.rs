//! Equations as Python functions over an array namespace: the same code runs on arrays of `numpy` and
//! `jax.numpy` and on symbols of `casadi` and `sympy`.

use std::fmt::Write as _;

use appell_runtime::model::Quantity;
use appell_spec::foreign::sentence;

use crate::program::{Function, FunctionKind, Own, Program};
use crate::schedule::names::ArgumentNames;
use crate::schedule::pi::parts_of_pi;
use crate::schedule::schedule;
use crate::symbolic::{self, Rational, Relation};
use crate::tape::{Argument, Tape, Value};
use crate::text::{Action, Infix, Notation, Statement, Text, math_name, shape, sign, unreserved};

/// Adapts the names of namespaces; see the class `_Namespace`.
const PRELUDE: &str = include_str!("python/prelude.py");

/// Keywords of Python, and names that the functions use.
const KEYWORDS: &str = "False None True and as assert async await break class continue def del elif else except \
    finally for from global if import in is lambda nonlocal not or pass raise return try while \
    with yield xp";

#[derive(Clone, Copy)]
struct Python;

impl Notation for Python {
    fn name(&self, name: &str) -> String {
        unreserved(name, KEYWORDS)
    }

    fn function(&self, function: symbolic::Function, of: &Infix) -> String {
        format!("_f.{}({})", math_name(function), of.text)
    }

    fn atan2(&self, y: &Infix, x: &Infix) -> String {
        format!("_f.atan2({}, {})", y.text, x.text)
    }

    fn power(&self, base: &Infix, exponent: &Infix) -> String {
        format!("_f.power({}, {})", base.text, exponent.text)
    }

    fn choice(&self, relation: Relation, operands: [Infix; 4]) -> String {
        let [a, b, then, otherwise] = operands.map(|one| one.text);
        format!("_f.where({a} {} {b}, {then}, {otherwise})", sign(relation))
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
        let tape = schedule(program, function);
        text.push_str("\n\n");
        definition(&mut text, program, function, &tape, &arguments);
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
    tape: &Tape,
    arguments: &ArgumentNames,
) {
    let written = Text::new(Python, tape, arguments);
    let own = function.kind.takes().map_or("", Own::name);
    let [t, x, u, p, own] = ["t", "x", "u", "p", own].map(|name| {
        if name == "t" {
            Python.name(&arguments.time)
        } else {
            written.free(name)
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
    for argument in tape.arguments() {
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
    for value in written.constants() {
        let name = written.constant(&value);
        let _ = writeln!(text, "    {name} = {}", constant(&value));
    }
    for one in written.statements() {
        statement(text, &one);
    }
    let results: Vec<String> = (function.results.iter().zip(&tape.results))
        .map(|(array, result)| nested(&written, &shape(program, array.layout), &result.entries))
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

fn statement(out: &mut String, statement: &Statement<'_>) {
    match statement.heading {
        Some("") => out.push('\n'),
        Some(title) => {
            let _ = writeln!(out, "\n    # {}", sentence(title));
        }
        None => {}
    }
    let _ = match &statement.action {
        Action::Define(name, value) => writeln!(out, "    {name} = {}", value.text),
        Action::SinCos([sin, cos], angle) => {
            let angle = &angle.text;
            writeln!(out, "    {sin}, {cos} = _f.sin({angle}), _f.cos({angle})")
        }
        Action::Factor(number, rows) => {
            let rows = rows.iter().map(|row| format!("[{}]", Infix::list(row)));
            let rows: Vec<String> = rows.collect();
            writeln!(out, "    _matrix_{number} = [{}]", rows.join(", "))
        }
        Action::Solve(number, unknowns, right) => {
            let unknowns: Vec<&str> = unknowns.iter().map(|(name, _)| &**name).collect();
            let (unknowns, right) = (unknowns.join(", "), Infix::list(right));
            writeln!(
                out,
                "    {unknowns}, = _f.solve(_matrix_{number}, [{right}])"
            )
        }
    };
}

/// Nested lists of an array's shape.
fn nested(text: &Text<'_, Python>, shape: &[usize], entries: &[Value]) -> String {
    let list = |entries: &[Value]| format!("[{}]", Infix::list(&text.values(entries)));
    match shape {
        [] => entries
            .first()
            .map_or_else(|| "0.0".to_owned(), |entry| text.value(*entry).text),
        [_] => list(entries),
        [rows, columns, ..] => {
            let rows = (0..*rows).map(|row| list(&entries[row * columns..][..*columns]));
            let rows: Vec<String> = rows.collect();
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
