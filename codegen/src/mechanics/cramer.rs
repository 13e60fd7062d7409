//! Small systems with a nonvanishing determinant but no safe pivot, as for a rotation by angles: solved by
//! Cramer's rule.

use super::algebra::{Algebra, scalar_product};
use crate::symbolic::{Expr, Graph, Intervals, SymbolId};

/// Size of the largest system solved by its determinant: a rotation in space has three unknowns.
const MOST_UNKNOWNS: usize = 3;

/// Equations with the unknowns that occur only in them, by index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Indices of its equations.
    pub equations: Vec<usize>,
    /// Its unknowns.
    pub unknowns: Vec<usize>,
}

/// The independent blocks of a system. `matrix` holds the coefficients of all unknowns, a row per equation;
/// `open` are the unsolved unknowns.
pub fn blocks(matrix: &[&[Expr]], open: &[usize]) -> Vec<Block> {
    let mut left: Vec<usize> = (0..matrix.len()).collect();
    let mut blocks = Vec::new();
    while !left.is_empty() {
        let mut equations = vec![left.remove(0)];
        let mut unknowns: Vec<usize> = Vec::new();
        let mut asked = 0;
        while let Some(&equation) = equations.get(asked) {
            asked += 1;
            let occurs = |&q: &usize| matrix[equation][q] != Graph::ZERO && !unknowns.contains(&q);
            let new: Vec<usize> = open.iter().copied().filter(occurs).collect();
            left.retain(|&other| {
                let joins = new.iter().any(|&q| matrix[other][q] != Graph::ZERO);
                if joins {
                    equations.push(other);
                }
                !joins
            });
            unknowns.extend(new);
        }
        equations.sort_unstable();
        unknowns.sort_unstable();
        blocks.push(Block {
            equations,
            unknowns,
        });
    }
    // Larger blocks first: the remainder may then be a block of two.
    blocks.sort_by_key(|block| std::cmp::Reverse(block.unknowns.len()));
    blocks
}

/// The unknowns of a square system. `None` if it has more than three, or its determinant is not known to be
/// nonzero; the identity test removes cancelling terms from it. The determinant must not mention `held`:
/// quotients by variable terms are longer than a system.
pub fn solve(
    algebra: &mut Algebra,
    rows: &[Vec<Expr>],
    right: &[Expr],
    held: &[SymbolId],
    intervals: &mut Intervals,
) -> Option<Vec<Expr>> {
    let (cofactors, determinant) = adjugate(algebra, rows)?;
    if algebra.graph.mentions(determinant, held)
        || !intervals.cannot_vanish(&algebra.graph, determinant)
    {
        return None;
    }
    let n = rows.len();
    let unknowns = (0..n).map(|j| {
        let column: Vec<Expr> = cofactors.iter().map(|row| row[j]).collect();
        let numerator = along(algebra, right, &column);
        algebra.graph.div(numerator, determinant)
    });
    Some(unknowns.collect())
}

/// Cofactors, row by row, and determinant of a square matrix. `None` if it is larger than 3 × 3.
pub fn adjugate(algebra: &mut Algebra, rows: &[Vec<Expr>]) -> Option<(Vec<Vec<Expr>>, Expr)> {
    let n = rows.len();
    if !(1..=MOST_UNKNOWNS).contains(&n) || rows.iter().any(|row| row.len() != n) {
        return None;
    }
    let mut cofactors = Vec::with_capacity(n);
    for i in 0..n {
        let row: Vec<Expr> = (0..n).map(|j| cofactor(algebra, rows, i, j)).collect();
        cofactors.push(row);
    }
    let determinant = along(algebra, &rows[0], &cofactors[0]);
    Some((cofactors, determinant))
}

/// The signed minor without row i and column j. For a rotation it equals the entry.
fn cofactor(algebra: &mut Algebra, rows: &[Vec<Expr>], i: usize, j: usize) -> Expr {
    let others = |left_out: usize| (0..rows.len()).filter(move |&k| k != left_out);
    let rest: Vec<Expr> = others(i)
        .flat_map(|row| others(j).map(move |column| rows[row][column]))
        .collect();
    let graph = &mut algebra.graph;
    let minor = match rest[..] {
        [] => Graph::ONE,
        [only] => only,
        [a, b, c, d] => {
            let (ad, bc) = (graph.mul(a, d), graph.mul(b, c));
            graph.sub(ad, bc)
        }
        _ => return Graph::ZERO,
    };
    let signed = if (i + j).is_multiple_of(2) {
        minor
    } else {
        graph.neg(minor)
    };
    if rest.len() < 4 {
        return signed;
    }
    let mut best = algebra.shortest(signed);
    for &entry in rows.iter().flatten() {
        for entry in [entry, algebra.graph.neg(entry)] {
            if algebra.graph.operations(&[entry]) < algebra.graph.operations(&[best])
                && algebra.test.are_equal(&algebra.graph, entry, best)
            {
                best = entry;
            }
        }
    }
    best
}

/// `Σ a b` in its shortest form.
fn along(algebra: &mut Algebra, a: &[Expr], b: &[Expr]) -> Expr {
    let sum = scalar_product(&mut algebra.graph, a, b);
    algebra.shortest(sum)
}
