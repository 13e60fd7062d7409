//! Appell's equations `M ω̇ = Π - b`, solved for the pseudo-accelerations.

use appell_spec::mechanism::Mechanism;

use super::algebra::Algebra;
use super::finding::{Finding, Item, Stage};
use crate::symbolic::{Expr, Graph};

/// Blocks up to this size are solved by explicit formulas, simplified entry by entry; larger ones
/// by an unrolled factorisation with named entries.
const LARGEST_EXPLICIT_BLOCK: usize = 3;

/// `Pᵀ M P = L D Lᵀ`, block by block. M is positive definite, so every order of pivots is stable
/// and the simplest one is taken.
#[derive(Debug, Clone)]
pub struct Factorization {
    /// Independent blocks of speeds, each in its order of elimination.
    pub blocks: Vec<Block>,
}

/// A block of the mass matrix.
#[derive(Debug, Clone)]
pub struct Block {
    /// Speeds in the order of elimination.
    pub speeds: Vec<usize>,
    /// `lower[i][j]`, `j < i`.
    lower: Vec<Vec<Expr>>,
    /// Pivots.
    pivots: Vec<Expr>,
}

/// Factorises the mass matrix.
pub fn factorize(algebra: &mut Algebra, mechanism: &Mechanism, mass_matrix: &[Vec<Expr>]) -> Stage<Factorization> {
    let mut blocks = Vec::new();
    for speeds in independent_blocks(mass_matrix) {
        blocks.push(factorize_block(algebra, mechanism, mass_matrix, speeds)?);
    }
    Ok(Factorization { blocks })
}

/// Sets of speeds that no entry of the mass matrix couples.
pub fn independent_blocks(mass_matrix: &[Vec<Expr>]) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut placed = vec![false; mass_matrix.len()];
    for start in 0..mass_matrix.len() {
        if placed[start] {
            continue;
        }
        placed[start] = true;
        let mut block = vec![start];
        let mut next = 0;
        while let Some(&i) = block.get(next) {
            for j in 0..mass_matrix.len() {
                if !placed[j] && mass_matrix[i][j] != Graph::ZERO {
                    placed[j] = true;
                    block.push(j);
                }
            }
            next += 1;
        }
        block.sort_unstable();
        blocks.push(block);
    }
    blocks
}

fn factorize_block(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    mass_matrix: &[Vec<Expr>],
    mut open: Vec<usize>,
) -> Stage<Block> {
    let size = open.len();
    let explicit = size <= LARGEST_EXPLICIT_BLOCK;
    let name = |speed: usize| mechanism.pseudo_velocities[speed].label.name.as_str();
    let mut schur = mass_matrix.to_vec();
    let mut block = Block { speeds: Vec::new(), lower: Vec::new(), pivots: Vec::new() };
    // Column of L per eliminated speed, indexed by speed.
    let mut columns: Vec<Vec<Expr>> = Vec::new();
    while !open.is_empty() {
        let (place, _) = open
            .iter()
            .enumerate()
            .map(|(place, &k)| (place, algebra.graph.operations(&[schur[k][k]])))
            .min_by_key(|&(place, operations)| (operations, place))
            .unwrap_or((0, 0));
        let k = open.remove(place);
        let pivot = schur[k][k];
        if algebra.test.is_zero(&algebra.graph, pivot) {
            return Err(vec![Finding {
                code: "singular-mass-matrix",
                message: format!("`{}` can change without moving any mass", name(k)),
                item: Item::PseudoVelocity(k),
                help: "give a mass or an inertia to what it moves, or constrain it".to_owned(),
            }]);
        }
        let pivot = if open.is_empty() && size == 1 {
            pivot
        } else {
            algebra.graph.name(&format!("pivot_{}", name(k)), pivot)
        };
        let mut column = vec![Graph::ZERO; mass_matrix.len()];
        for &i in &open {
            let mut ratio = algebra.graph.div(schur[i][k], schur[k][k]);
            if explicit {
                ratio = algebra.shortest(ratio);
            } else if ratio != Graph::ZERO {
                ratio = algebra.graph.div(schur[i][k], pivot);
                ratio = algebra.graph.name(&format!("l_{}_{}", name(i), name(k)), ratio);
            }
            column[i] = ratio;
        }
        for (a, &i) in open.iter().enumerate() {
            for &j in &open[..=a] {
                let change = algebra.graph.mul(column[i], schur[j][k]);
                let mut entry = algebra.graph.sub(schur[i][j], change);
                if explicit {
                    entry = algebra.shortest(entry);
                } else if change != Graph::ZERO && i != j {
                    entry = algebra.graph.name(&format!("m_{}_{}", name(i), name(j)), entry);
                }
                schur[i][j] = entry;
                schur[j][i] = entry;
            }
        }
        block.lower.push(columns.iter().map(|column| column[k]).collect());
        block.pivots.push(pivot);
        block.speeds.push(k);
        columns.push(column);
    }
    Ok(block)
}

impl Factorization {
    /// Unknowns of `M x = right`. With names, one per speed, every step is brought to its shortest
    /// form and the unknowns are named: that pays for the accelerations themselves, not for every
    /// column of a Jacobian.
    pub fn solve(&self, algebra: &mut Algebra, right: &[Expr], names: Option<&[String]>) -> Vec<Expr> {
        let mut x = vec![Graph::ZERO; right.len()];
        for block in &self.blocks {
            block.solve(algebra, right, names, &mut x);
        }
        x
    }
}

impl Block {
    /// Forward substitution, pivots, back substitution.
    fn solve(&self, algebra: &mut Algebra, right: &[Expr], names: Option<&[String]>, x: &mut [Expr]) {
        let explicit = names.is_some() && self.speeds.len() <= LARGEST_EXPLICIT_BLOCK;
        let mut z: Vec<Expr> = Vec::with_capacity(self.speeds.len());
        for (i, &speed) in self.speeds.iter().enumerate() {
            let mut parts = vec![right[speed]];
            for (j, &done) in z.iter().enumerate() {
                let part = algebra.graph.mul(self.lower[i][j], done);
                parts.push(algebra.graph.neg(part));
            }
            let value = algebra.graph.sum(&parts);
            z.push(if explicit { algebra.shortest(value) } else { value });
        }
        for i in (0..self.speeds.len()).rev() {
            let speed = self.speeds[i];
            let mut parts = vec![algebra.graph.div(z[i], self.pivots[i])];
            for j in i + 1..self.speeds.len() {
                let part = algebra.graph.mul(self.lower[j][i], x[self.speeds[j]]);
                parts.push(algebra.graph.neg(part));
            }
            x[speed] = algebra.graph.sum(&parts);
            if let Some(names) = names {
                x[speed] = algebra.graph.name(&names[speed], x[speed]);
            }
        }
    }
}
