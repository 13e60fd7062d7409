//! Small matrices drawn with characters.

use appell_spec::foreign::one_line;

use super::types::Types;
use crate::program::{Function, FunctionKind, Layout};
use crate::symbolic::print::{Setter, Vocabulary, text};
use crate::symbolic::{Expr, Graph, SymbolId};

/// Widest picture, in characters.
const WIDEST: usize = 92;
/// Nodes of the largest entry that is tried.
const LARGEST: usize = 60;

/// Letters spelled as their names, with the parameters first in every product.
#[derive(Clone, Copy)]
pub(super) struct ParametersFirst<'a>(pub(super) &'a [SymbolId]);

impl Vocabulary for ParametersFirst<'_> {
    fn place(&self, graph: &Graph, symbol: Expr) -> u8 {
        let is_parameter = graph.as_symbol(symbol).is_some_and(|s| self.0.contains(&s));
        if is_parameter { 1 } else { 2 }
    }
}

/// The mass matrix as rustdoc lines, if it fits.
pub(super) fn picture(types: &Types<'_>, function: &Function) -> Vec<String> {
    let (FunctionKind::MassMatrix, [array]) = (function.kind, function.results.as_slice()) else {
        return Vec::new();
    };
    let Layout::Matrix(rows, columns @ 1..=6) = array.layout else {
        return Vec::new();
    };
    let graph = &*function.graph;
    let mut setter =
        Setter::new(ParametersFirst(&types.program.arguments.parameters)).with_definitions_inline();
    let mut cells = Vec::with_capacity(array.entries.len());
    for &entry in &array.entries {
        if graph.in_order(&[entry]).len() > LARGEST {
            return Vec::new();
        }
        let zero = entry == Graph::ZERO;
        cells.push(if zero {
            "·".to_owned()
        } else {
            one_line(&text(&setter.set(graph, entry).math))
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
