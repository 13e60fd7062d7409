//! Equations in C99: one header and one source, without allocation, with the names and units of the spec.
//!
//! Operations and their order are those of the tape, hence of the emitted Rust: compiled without
//! contraction, the results are bit-identical.

mod adapters;
mod cuda;
mod motion;
mod types;

use std::fmt::Write as _;

use appell_spec::foreign::sentence;

use crate::program::{Array, Function, FunctionKind, Layout, Program, Space};
use crate::schedule::pi::parts_of_pi;
use crate::schedule::schedule;
use crate::symbolic::{self, Rational, Relation};
use crate::tape::{Argument, Tape, Value};
use crate::text::{Action, Infix, Notation, Text, math_name, shape, sign, unreserved};

pub(crate) use adapters::{adapted, adapters};
pub use cuda::{Kernel, cuda, kernels};
pub use motion::{Followed, Motion, motion};
use types::Types;

/// The type of all numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Real {
    /// 64 bits.
    #[default]
    Double,
    /// 32 bits, with the functions of `math.h` with suffix `f`.
    Float,
}

/// Options of the emission.
#[derive(Debug, Clone)]
pub struct Options {
    /// The functions; those that the program lacks are skipped.
    pub functions: Vec<FunctionKind>,
    /// The type of all numbers.
    pub real: Real,
    /// Whether to emit a step of the classical Runge-Kutta method, which needs [`FunctionKind::Rates`].
    pub integrator: bool,
}

impl Default for Options {
    /// The functions of emitted Rust, in double precision.
    fn default() -> Self {
        Self {
            functions: FunctionKind::STANDARD.to_vec(),
            real: Real::default(),
            integrator: false,
        }
    }
}

/// Emitted text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Emitted {
    /// Name of both files, without extension.
    pub name: String,
    /// `NAME.h`.
    pub header: String,
    /// `NAME.c`.
    pub source: String,
}

/// Keywords of C, and names of `math.h` that some implementations define as macros or objects.
const KEYWORDS: &str = "auto break case char const continue default do double else enum extern float for goto if \
    inline int long register restrict return short signed sizeof static struct switch typedef \
    union unsigned void volatile while asm bool true false NULL NAN INFINITY HUGE_VAL errno \
    alignas alignof class constexpr delete new nullptr operator private protected public \
    template this throw try catch typeof using virtual namespace friend mutable explicit \
    export typename and or not xor linux unix signgam";

impl Notation for Real {
    fn name(&self, name: &str) -> String {
        unreserved(name, KEYWORDS)
    }

    fn function(&self, function: symbolic::Function, of: &Infix) -> String {
        let of = &of.text;
        match function {
            symbolic::Function::Sign => format!("sign_of({of})"),
            other => format!("{}{}({of})", math_name(other), self.suffix()),
        }
    }

    fn atan2(&self, y: &Infix, x: &Infix) -> String {
        format!("atan2{}({}, {})", self.suffix(), y.text, x.text)
    }

    fn power(&self, base: &Infix, exponent: &Infix) -> String {
        format!("pow{}({}, {})", self.suffix(), base.text, exponent.text)
    }

    fn choice(&self, relation: Relation, operands: [Infix; 4]) -> String {
        let [a, b, then, otherwise] = operands.map(|one| one.text);
        format!("({a} {} {b} ? {then} : {otherwise})", sign(relation))
    }
}

impl Real {
    const fn suffix(self) -> &'static str {
        match self {
            Self::Double => "",
            Self::Float => "f",
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Double => "double",
            Self::Float => "float",
        }
    }

    /// A number as in the emitted Rust: as a quotient of doubles, rounded once.
    fn number(self, value: &Rational) -> String {
        if let Some((1, 1)) = parts_of_pi(value) {
            return self.literal(std::f64::consts::PI);
        }
        self.literal(value.to_f64())
    }

    fn literal(self, value: f64) -> String {
        if !value.is_finite() {
            let sign = if value < 0.0 { "-" } else { "" };
            return format!("{sign}{}", if value.is_nan() { "NAN" } else { "INFINITY" });
        }
        match self {
            Self::Double => format!("{value:?}"),
            Self::Float => format!("(float){value:?}"),
        }
    }
}

/// Emits the functions of a program.
pub fn emit(program: &Program, options: &Options) -> Emitted {
    let types = Types::new(program, options.real);
    let functions: Vec<&Function> = emitted(program, options).collect();
    let bodies: String = functions
        .iter()
        .map(|function| definition(&types, function, &schedule(program, function)))
        .collect();
    let mut source = format!(
        "/* {} */\n\n#include \"{}.h\"\n\n#include <math.h>\n",
        heading(program),
        types.prefix
    );
    if options.integrator {
        source.push_str("#include <string.h>\n");
    }
    source.push('\n');
    source.push_str(&types.values());
    source.push_str(&helpers(options.real, &bodies));
    source.push_str(&bodies);
    let mut prototypes = String::new();
    for function in &functions {
        let _ = write!(
            prototypes,
            "{}{};\n\n",
            comment(program, function),
            types.signature(function)
        );
    }
    let mut header = types.header(&heading(program), &prototypes, options.integrator);
    if options.integrator {
        source.push_str(&types.integrator());
    }
    header.push('\n');
    Emitted {
        name: types.prefix.clone(),
        header,
        source,
    }
}

/// The functions with results.
fn emitted<'p>(program: &'p Program, options: &'p Options) -> impl Iterator<Item = &'p Function> {
    let functions = program.functions.iter();
    functions
        .filter(|function| options.functions.contains(&function.kind))
        .filter(|function| {
            !function
                .results
                .iter()
                .all(|array| is_empty(program, array))
        })
}

fn heading(program: &Program) -> String {
    format!(
        "{}. Equations of motion by the Gibbs-Appell method, emitted from {}.",
        sentence(&program.info.title),
        sentence(&program.file)
    )
}

/// An array without entries is not allowed in C.
fn is_empty(program: &Program, array: &Array) -> bool {
    shape(program, array.layout).contains(&0)
}

/// Description of a function and its results.
fn comment(program: &Program, function: &Function) -> String {
    let about = sentence(&function.kind.about().replace(['[', ']', '`'], ""));
    let mut text = format!("/* {about}\n");
    for array in &function.results {
        if !is_empty(program, array) {
            let _ = writeln!(
                text,
                " * {}: {}",
                sentence(&array.name),
                sentence(&array.about)
            );
        }
    }
    text + " */\n"
}

/// Static functions used in bodies.
fn helpers(real: Real, bodies: &str) -> String {
    let number = real.name();
    let mut text = String::new();
    if bodies.contains("sign_of(") {
        let _ = write!(
            text,
            "static {number} sign_of({number} x) {{\n    return x > 0 ? 1 : (x < 0 ? -1 : x);\n}}\n\n"
        );
    }
    if bodies.contains("lu_factor(") {
        text.push_str(
            &LU.replace("REAL", number)
                .replace("FABS", if real == Real::Float { "fabsf" } else { "fabs" }),
        );
    }
    text
}

/// The operations of `appell_runtime::dense` in the same order.
const LU: &str = "\
/* P A = L U with partial pivoting, n by n, row by row. */
static void lu_factor(int n, REAL *a, unsigned char *exchanged) {
    int i, j, k;
    for (k = 0; k < n; k++) {
        for (i = k + 1; i < n; i++) {
            unsigned char exchange = FABS(a[k * n + k]) < FABS(a[i * n + k]);
            exchanged[i * n + k] = exchange;
            for (j = 0; exchange && j < n; j++) {
                REAL upper = a[k * n + j];
                a[k * n + j] = a[i * n + j];
                a[i * n + j] = upper;
            }
        }
        for (i = k + 1; i < n; i++) {
            a[i * n + k] = a[i * n + k] / a[k * n + k];
            for (j = k + 1; j < n; j++) {
                a[i * n + j] = a[i * n + j] - a[i * n + k] * a[k * n + j];
            }
        }
    }
}

/* A x = right, given the factors of A; x replaces the right side. */
static void lu_solve(int n, const REAL *a, const unsigned char *exchanged, REAL *x) {
    int i, k;
    for (k = 0; k < n; k++) {
        for (i = k + 1; i < n; i++) {
            if (exchanged[i * n + k]) {
                REAL upper = x[k];
                x[k] = x[i];
                x[i] = upper;
            }
        }
    }
    for (i = 1; i < n; i++) {
        for (k = 0; k < i; k++) {
            x[i] = x[i] - a[i * n + k] * x[k];
        }
    }
    for (i = n - 1; i >= 0; i--) {
        for (k = i + 1; k < n; k++) {
            x[i] = x[i] - a[i * n + k] * x[k];
        }
        x[i] = x[i] / a[i * n + i];
    }
}

";

fn definition(types: &Types<'_>, function: &Function, tape: &Tape) -> String {
    let written = Text::new(types.real, tape, types.names());
    let real = types.real.name();
    let mut text = format!("{} {{\n", types.signature(function));
    let [parameters, state, inputs] = types.groups();
    let own = function.kind.takes().map(|own| types.own(own));
    let own = own.unwrap_or_default();
    let accelerations = types.fields(Space::Accelerations);
    for argument in tape.arguments() {
        let name = types.local(argument);
        let place = match argument {
            Argument::Time => continue,
            Argument::State(_) => format!("{state}->{name}"),
            Argument::Input(_) => format!("{inputs}->{name}"),
            Argument::Parameter(_) => format!("{parameters}->{name}"),
            Argument::Weight(i) | Argument::OutputWeight(i) => format!("{own}[{i}]"),
            Argument::Acceleration(i) => format!("{own}->{}", accelerations[i as usize]),
        };
        let _ = writeln!(text, "    const {real} {name} = {place};");
    }
    computed(&mut text, &written);
    for unused in types.unused(tape) {
        let _ = writeln!(text, "    (void){unused};");
    }
    text.push('\n');
    for (array, result) in function.results.iter().zip(&tape.results) {
        if !is_empty(types.program, array) {
            results(&mut text, types, &written, function, array, &result.entries);
        }
    }
    text + "}\n\n"
}

/// The numbers and the statements of a tape.
fn computed(out: &mut String, text: &Text<'_, Real>) {
    let real = text.notation.name();
    for value in text.constants() {
        let (name, number) = (text.constant(&value), text.notation.number(&value));
        let _ = writeln!(out, "    const {real} {name} = {number};");
    }
    for statement in text.statements() {
        match statement.heading {
            Some("") => out.push('\n'),
            Some(title) => {
                let _ = writeln!(out, "\n    /* {} */", sentence(title));
            }
            None => {}
        }
        act(out, text, &statement.action);
    }
}

fn act(out: &mut String, text: &Text<'_, Real>, action: &Action) {
    let real = text.notation.name();
    let factors = |number| ["lu", "moved"].map(|word| text.free(&format!("{word}_{number}")));
    let _ = match action {
        Action::Define(name, value) => writeln!(out, "    const {real} {name} = {};", value.text),
        Action::SinCos(names, angle) => {
            let functions = [symbolic::Function::Sin, symbolic::Function::Cos];
            functions
                .iter()
                .zip(names)
                .try_for_each(|(function, name)| {
                    let value = text.notation.function(*function, angle);
                    writeln!(out, "    const {real} {name} = {value};")
                })
        }
        Action::Factor(number, rows) => {
            let [lu, moved] = factors(*number);
            let entries: Vec<String> = rows.iter().map(|row| Infix::list(row)).collect();
            let (size, count) = (rows.len(), rows.len() * rows.len());
            write!(
                out,
                "    {real} {lu}[{count}] = {{{}}};\n    unsigned char {moved}[{count}];\n    \
                 lu_factor({size}, {lu}, {moved});\n",
                entries.join(", ")
            )
        }
        Action::Solve(number, unknowns, right) => {
            let [lu, moved] = factors(*number);
            let size = unknowns.len();
            // The list is named after the first unknown, since each is defined once.
            let first = unknowns.first().map_or("", |(name, _)| name);
            let list = text.free(&format!("solved_{first}"));
            let right = Infix::list(right);
            let _ = write!(
                out,
                "    {real} {list}[{size}] = {{{right}}};\n    lu_solve({size}, {lu}, {moved}, {list});\n"
            );
            let mut used = unknowns.iter().enumerate().filter(|(_, unknown)| unknown.1);
            used.try_for_each(|(index, (name, _))| {
                writeln!(out, "    const {real} {name} = {list}[{index}];")
            })
        }
    };
}

/// Stores the entries of an array.
fn results(
    text: &mut String,
    types: &Types<'_>,
    written: &Text<'_, Real>,
    function: &Function,
    array: &Array,
    entries: &[Value],
) {
    let to = types.result(function, array);
    let columns = shape(types.program, array.layout)
        .get(1)
        .copied()
        .unwrap_or(1);
    for (index, entry) in entries.iter().enumerate() {
        let place = match array.layout {
            Layout::Scalar => format!("*{to}"),
            Layout::Vector(space) => format!("{to}->{}", types.fields(space)[index]),
            Layout::List(_) => format!("{to}[{index}]"),
            Layout::Rows(..) | Layout::Jacobian(..) | Layout::Matrix(..) => {
                format!("{to}[{}][{}]", index / columns, index % columns)
            }
        };
        let _ = writeln!(text, "    {place} = {};", written.value(*entry).text);
    }
}
