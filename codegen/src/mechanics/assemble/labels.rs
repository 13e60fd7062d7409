//! Labels and remarks of the results: entries by pseudo-velocity, places in the spec, constraints without rows.

use appell_runtime::model::Quantity;
use appell_spec::mechanism::{BodyId, ConstraintId, Mechanism};

use super::super::constraints::Constraints;
use crate::program::{Array, Layout, Space};
use crate::symbolic::Expr;

/// One entry per pseudo-velocity.
pub(in super::super) fn by_speed(
    name: &str,
    result: &str,
    about: &str,
    speeds: &[Quantity],
    entries: Vec<Expr>,
) -> Array {
    let all = 0..entries.len();
    Array::new(
        result,
        about,
        Layout::Vector(Space::GeneralizedForces),
        entries,
    )
    .labelled(listed(name, speeds).into_iter())
    .under(about, all)
}

/// `symbol_name` for every quantity.
pub(in super::super) fn listed(symbol: &str, quantities: &[Quantity]) -> Vec<String> {
    let names = quantities.iter();
    names
        .map(|quantity| format!("{symbol}_{}", quantity.name))
        .collect()
}

/// `symbol_row_column` for every pair, row by row.
pub(in super::super) fn paired(
    symbol: &str,
    rows: &[Quantity],
    columns: &[Quantity],
) -> Vec<String> {
    let rows = rows.iter();
    rows.flat_map(|row| listed(&format!("{symbol}_{}", row.name), columns))
        .collect()
}

/// The constraints without rows, with the reason.
pub(super) fn embedded(
    mechanism: &Mechanism,
    constraints: &Constraints,
) -> impl Iterator<Item = String> {
    let has_row =
        |index| (constraints.rows.iter()).any(|row| row.constraint == index && !row.is_embedded());
    let without = mechanism
        .constraints
        .ids()
        .filter(move |&index| !has_row(index));
    without.map(|index| {
        let name = &mechanism.constraints[index].name;
        format!("`{name}` has no row: the coordinates satisfy it identically.")
    })
}

/// The file as shown in comments: its path, or only its name if the path is absolute.
pub(super) fn shown_file(file: &str) -> &str {
    let path = std::path::Path::new(file);
    let name = path.file_name().and_then(std::ffi::OsStr::to_str);
    name.filter(|_| path.is_absolute()).unwrap_or(file)
}

/// Source locations of spec items, for comments.
pub(super) struct Source<'a>(pub(super) &'a Mechanism);

impl Source<'_> {
    pub(super) fn of_body(&self, index: BodyId) -> String {
        let body = &self.0.bodies[index];
        let file = shown_file(&self.0.file);
        format!("Body `{}`, {file}:{}.", body.name, body.line)
    }

    pub(super) fn of_constraint(&self, index: ConstraintId) -> String {
        let constraint = &self.0.constraints[index];
        let file = shown_file(&self.0.file);
        format!(
            "Constraint `{}`, {file}:{}.",
            constraint.name, constraint.line
        )
    }
}
