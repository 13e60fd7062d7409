//! The body of a function: its tape, statement by statement.

use syn::{Attribute, Expr, Stmt};

use super::layout;
use super::statements::Statements;
use super::syntax as s;
use super::types::{Types, result_struct};
use crate::program::{Array, Function, Layout, Space};
use crate::symbolic::Rational;
use crate::tape::{Argument, Operation, Tape, Value};

/// Maximum columns of lines that destructure arguments.
const COLUMNS: usize = 80;

/// The statements of a function; the last one is its result.
pub(super) fn body(types: &Types<'_>, function: &Function, tape: &Tape) -> Vec<Stmt> {
    let mut body = Body {
        types,
        tape,
        statements: Statements::new(&types.names, tape),
    };
    body.arguments();
    body.own(function);
    body.statements.constants();
    body.statements.operations();
    body.results(function);
    body.statements.all
}

struct Body<'a> {
    types: &'a Types<'a>,
    tape: &'a Tape,
    statements: Statements<'a>,
}

impl Body<'_> {
    /// `let &Parameters { m, g, .. } = p;`, on as many lines as the names need.
    fn arguments(&mut self) {
        let arguments = self.tape.arguments();
        for group in self.types.groups() {
            let used: Vec<&str> = arguments
                .iter()
                .filter(|&&argument| group.holds(argument))
                .map(|&argument| self.types.names.get(argument))
                .collect();
            let frame = "    let & { .. } = ;".len() + group.type_name.len() + group.argument.len();
            for row in rows(&used, COLUMNS.saturating_sub(frame)) {
                let pattern = s::borrowed_fields(group.type_name, row, row.len() == group.len);
                self.statements.push(pattern, s::name(&group.argument));
            }
        }
    }

    /// `let lambda_v = weights[0];`, `let v_dot = accelerations.v_dot;`
    fn own(&mut self, function: &Function) {
        let Some((own, _)) = self.types.own(function.kind) else {
            return;
        };
        let accelerations = self.types.fields(Space::Accelerations);
        for argument in self.tape.arguments() {
            let value = match argument {
                Argument::Weight(index) | Argument::OutputWeight(index) => {
                    s::entry(s::name(&own), &[index as usize])
                }
                Argument::Acceleration(index) => {
                    s::field(s::name(&own), &accelerations[index as usize])
                }
                _ => continue,
            };
            let local = s::binding(self.types.names.get(argument));
            self.statements.push(local, value);
        }
    }

    /// The arrays, and the expression that contains them.
    fn results(&mut self, function: &Function) {
        let mut fields = Vec::new();
        let structure = result_struct(function);
        let names = Types::result_fields(function);
        let results = function.results.iter().zip(&self.tape.results);
        for ((array, result), name) in results.zip(&names) {
            let value = self.result(array, &result.entries);
            fields.push((name.as_str(), value));
        }
        let value = match (structure, fields.len()) {
            (None, 1) => fields.remove(0).1,
            (structure, _) => {
                let fields = fields
                    .iter()
                    .map(|(name, value)| (*name, value.clone()))
                    .collect();
                s::structure(structure.unwrap_or_default(), fields, None)
            }
        };
        let mut value = value;
        if !self.statements.all.is_empty() {
            self.statements.attributes.push(layout::blank());
        }
        attach(&mut value, std::mem::take(&mut self.statements.attributes));
        self.statements.all.push(Stmt::Expr(value, None));
    }

    fn result(&self, array: &Array, entries: &[Value]) -> Expr {
        match array.layout {
            Layout::Scalar => match entries {
                [entry, ..] => self.statements.value(*entry),
                [] => s::associated("constant", vec![s::number(0.0)]),
            },
            Layout::Vector(space) => self.vector(space, self.statements.values(entries)),
            Layout::List(_) => s::array(self.statements.values(entries)),
            Layout::Rows(space, columns) => {
                let rows = entries
                    .chunks(columns)
                    .map(|row| s::array(self.statements.values(row)));
                self.vector(space, rows.collect())
            }
            Layout::Matrix(rows, columns) => {
                // A row may be empty: a model may have contacts and no coordinates.
                let lines = (0..rows).map(|row| &entries[row * columns..][..columns]);
                s::array(
                    lines
                        .map(|line| s::array(self.statements.values(line)))
                        .collect(),
                )
            }
            Layout::Jacobian(rows, columns) => {
                let count = self.types.fields(columns).len();
                let lines = (0..self.types.fields(rows).len())
                    .map(|row| self.row(columns, &entries[row * count..][..count]));
                self.vector(rows, lines.collect())
            }
        }
    }

    /// `Name { field: value, … }`
    fn vector(&self, space: Space, values: Vec<Expr>) -> Expr {
        let fields = self.types.fields(space).iter().map(String::as_str);
        s::structure(Types::type_name(space), fields.zip(values).collect(), None)
    }

    /// `Name { field: value, ..Name::splat(zero) }` with the nonzero entries.
    fn row(&self, space: Space, entries: &[Value]) -> Expr {
        let zero = Operation::Constant(Rational::ZERO);
        let is_zero = |entry: &&Value| *self.tape.operation(**entry) == zero;
        if entries.iter().filter(is_zero).count() <= 1 {
            return self.vector(space, self.statements.values(entries));
        }
        let name = Types::type_name(space);
        let zero = s::name(&self.types.names.constant(&Rational::ZERO));
        let zeros = s::associated_with(name, "splat", vec![zero]);
        let fields: Vec<(&str, Expr)> = self
            .types
            .fields(space)
            .iter()
            .zip(entries)
            .filter(|(_, entry)| !is_zero(entry))
            .map(|(field, entry)| (field.as_str(), self.statements.value(*entry)))
            .collect();
        if fields.is_empty() {
            zeros
        } else {
            s::structure(name, fields, Some(zeros))
        }
    }
}

/// Names in rows of at most `columns` columns, commas included.
fn rows<'a>(names: &'a [&'a str], columns: usize) -> impl Iterator<Item = &'a [&'a str]> {
    let mut rest = names;
    std::iter::from_fn(move || {
        let mut width = 0;
        let fits = |name: &&&str| {
            width += name.len() + ", ".len();
            width <= columns
        };
        let count = rest.iter().take_while(fits).count().max(1);
        let (row, later) = rest.split_at_checked(count)?;
        rest = later;
        Some(row)
    })
}

/// Attaches comments before an expression.
fn attach(value: &mut Expr, attributes: Vec<Attribute>) {
    match value {
        Expr::Struct(inner) => inner.attrs = attributes,
        Expr::Array(inner) => inner.attrs = attributes,
        Expr::Path(inner) => inner.attrs = attributes,
        Expr::Call(inner) => inner.attrs = attributes,
        Expr::Unary(inner) => inner.attrs = attributes,
        _ => {}
    }
}

/// A struct of arguments.
pub(super) struct Group {
    /// Name of the struct.
    pub(super) type_name: &'static str,
    /// Name of the function's argument.
    pub(super) argument: String,
    /// Number of fields.
    pub(super) len: usize,
    /// One of its arguments.
    pub(super) like: Argument,
}

impl Group {
    fn holds(&self, argument: Argument) -> bool {
        std::mem::discriminant(&argument) == std::mem::discriminant(&self.like)
    }
}
