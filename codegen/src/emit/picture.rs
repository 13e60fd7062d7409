//! Small matrices drawn in characters.

use super::types::Types;
use crate::program::{Function, FunctionKind, Layout};
use crate::schedule::piece::text;
use crate::schedule::{Schedule, Step, Tree, Value};

/// Widest picture, in characters.
const WIDEST: usize = 84;

/// The mass matrix as rustdoc lines, where it fits on the page.
pub(super) fn picture(types: &Types<'_>, function: &Function, schedule: &Schedule) -> Vec<String> {
    let (FunctionKind::MassMatrix, [array], [result]) = (
        function.kind,
        function.results.as_slice(),
        schedule.results.as_slice(),
    ) else {
        return Vec::new();
    };
    let Layout::Matrix(rows, columns @ 1..=6) = array.layout else {
        return Vec::new();
    };
    let cells: Vec<String> = result
        .entries
        .iter()
        .map(|tree| cell(types, schedule, tree))
        .collect();
    let width_of = |column: usize| {
        let column = cells.iter().skip(column).step_by(columns);
        column.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width_of).collect();
    if rows == 0 || widths.iter().map(|width| width + 3).sum::<usize>() > WIDEST {
        return Vec::new();
    }
    let mut lines = vec!["```text".to_owned()];
    for (i, row) in cells.chunks(columns).enumerate() {
        let (left, right) = match (i, rows) {
            (0, 1) => ('[', ']'),
            (0, _) => ('⎡', '⎤'),
            _ if i + 1 == rows => ('⎣', '⎦'),
            _ => ('⎢', '⎥'),
        };
        let padded: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, &width)| format!("{cell:<width$}"))
            .collect();
        let name = if i == rows / 2 { "M = " } else { "    " };
        lines.push(format!("{name}{left} {} {right}", padded.join("   ")));
    }
    lines.extend(["```".to_owned(), String::new()]);
    lines
}

/// An entry, with the value it names written out.
fn cell(types: &Types<'_>, schedule: &Schedule, tree: &Tree) -> String {
    let definition = |value: &Value| {
        schedule.steps.iter().find_map(|step| match step {
            Step::Let {
                value: defined,
                tree,
            } if defined == value => Some(tree),
            _ => None,
        })
    };
    match tree {
        Tree::Value(value) => {
            let tree = definition(value).unwrap_or(tree);
            text(tree, schedule, &types.names)
        }
        Tree::Constant(value) if value.is_zero() => "·".to_owned(),
        _ => text(tree, schedule, &types.names),
    }
}
