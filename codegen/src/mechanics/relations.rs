//! Division-free relations between the unknowns of a system without a safe pivot: linear combinations of them
//! that equal combinations of the right-hand sides. The angular velocity of a top equals its pseudo-velocities
//! even where its angles are singular.

use super::algebra::{Algebra, Relation};
use super::cramer::{self, Block};
use super::elimination::OpenSystem;
use super::symbols::ids;
use crate::symbolic::Expr;

/// Systems with more operations have no short relations.
const MOST_OPERATIONS: usize = 24;

/// The blocks of an open system that are small enough for Cramer's rule.
pub fn relations(algebra: &mut Algebra, system: &OpenSystem) -> Vec<Relation> {
    let n = system.unknowns.len();
    if n == 0 {
        return Vec::new();
    }
    let matrix: Vec<&[Expr]> = system.matrix.chunks(n).collect();
    let all: Vec<usize> = (0..n).collect();
    let mut relations = Vec::new();
    for Block {
        equations,
        unknowns,
    } in cramer::blocks(&matrix, &all)
    {
        let row = |&i: &usize| unknowns.iter().map(|&k| matrix[i][k]).collect();
        let rows: Vec<Vec<Expr>> = equations.iter().map(row).collect();
        if algebra.graph.operations(&rows.concat()) > MOST_OPERATIONS {
            continue;
        }
        let Some((cofactors, determinant)) = cramer::adjugate(algebra, &rows) else {
            continue;
        };
        let unknowns: Vec<Expr> = unknowns.iter().map(|&k| system.unknowns[k]).collect();
        relations.push(Relation {
            symbols: ids(&algebra.graph, &unknowns),
            unknowns,
            cofactors,
            determinant,
            right: equations.iter().map(|&i| system.right[i]).collect(),
        });
    }
    relations
}
