//! Shapes of result arrays.

use crate::program::{Layout, Program, Space};

/// Rows and columns of an array; only columns for a list, neither for a number.
pub(crate) fn shape(program: &Program, layout: Layout) -> Vec<usize> {
    let len = |space: Space| match space {
        Space::ConstraintRows => program.info.constraint_rows.len(),
        Space::Reactions => program.info.reactions.len(),
        _ => space.quantities(&program.info).len(),
    };
    match layout {
        Layout::Scalar => Vec::new(),
        Layout::List(n) => vec![n],
        Layout::Vector(space) => vec![len(space)],
        Layout::Matrix(rows, columns) => vec![rows, columns],
        Layout::Rows(space, columns) => vec![len(space), columns],
        Layout::Jacobian(rows, columns) => vec![len(rows), len(columns)],
    }
}
