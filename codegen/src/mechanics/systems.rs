//! The linear systems that are solved with pivoting when the equations are evaluated.

use crate::symbolic::{Expr, Graph, Node};

/// The distinct matrices of the systems inside `roots`, row by row, each with its size. Systems of a single
/// unknown are divisions and need no condition number.
pub fn systems(graph: &Graph, roots: &[Expr]) -> Vec<(usize, Vec<Expr>)> {
    let mut systems: Vec<(usize, Vec<Expr>)> = Vec::new();
    for expr in graph.in_order(roots) {
        let Node::Solution { system, .. } = *graph.node(expr) else {
            continue;
        };
        let system = graph.system(system);
        let matrix = system.matrix.to_vec();
        let is_new = systems.iter().all(|(_, known)| *known != matrix);
        if matrix.len() > 1 && is_new {
            systems.push((system.right.len(), matrix));
        }
    }
    systems
}
