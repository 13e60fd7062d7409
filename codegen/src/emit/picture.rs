//! Small matrices drawn in characters.

use super::layout::one_line;
use super::types::Types;
use crate::program::{Function, FunctionKind, Layout};
use crate::symbolic::Graph;
use crate::symbolic::print::{Printer, Text};

/// Widest picture, in characters.
const WIDEST: usize = 92;
/// Nodes of the largest entry that is worth a try.
const LARGEST: usize = 60;

/// The mass matrix as rustdoc lines, where it fits on the page.
pub(super) fn picture(types: &Types<'_>, function: &Function) -> Vec<String> {
    let (FunctionKind::MassMatrix, [array]) = (function.kind, function.results.as_slice()) else {
        return Vec::new();
    };
    let Layout::Matrix(rows, columns @ 1..=6) = array.layout else {
        return Vec::new();
    };
    let at = &types.program.arguments;
    let printer = Printer::new(&types.program.graph, Text)
        .with_order(&[at.parameters.as_slice(), &at.states].concat())
        .with_definitions_inline();
    let mut cells = Vec::with_capacity(array.entries.len());
    for &entry in &array.entries {
        if types.program.graph.in_order(&[entry]).len() > LARGEST {
            return Vec::new();
        }
        let zero = entry == Graph::ZERO;
        cells.push(if zero {
            "·".to_owned()
        } else {
            one_line(&printer.expression(entry))
        });
    }
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
