//! det(λ - A), with zero eigenvalues factored out.
//!
//! A matrix is a weighted graph with an edge for every nonzero entry. The coefficient of `λⁿ⁻ᵏ` is the sum,
//! over all sets of disjoint cycles through `k` states in total, of the products of their weights, negated for
//! an odd number of cycles. This needs no division, and only nonzero products.

use super::simplest;
use crate::mechanics::Derivation;
use crate::symbolic::dissolve::Dissolved;
use crate::symbolic::{Expr, Graph};

/// Maximum number of products in a coefficient; longer ones are unreadable.
const MOST_PRODUCTS: usize = 150;
/// Maximum number of paths followed from one state.
const MOST_STEPS: usize = 20_000;
/// States are bits of a number.
const MOST_STATES: usize = 64;

/// A characteristic polynomial with the leading coefficient 1.
#[derive(Debug, Clone)]
pub struct Characteristic {
    /// Its degree.
    pub degree: usize,
    /// A symbol for every entry of the matrix; numbers are kept.
    pub entries: Vec<Vec<Expr>>,
    /// The coefficient of `λⁿ⁻ᵏ` at index `k`, in those symbols.
    pub in_entries: Vec<Expr>,
    /// The same with the entries substituted.
    pub coefficients: Vec<Expr>,
}

impl Characteristic {
    /// The polynomial of a matrix. `None` if a coefficient has too many products.
    pub fn of(derivation: &mut Derivation, matrix: &[&[Expr]]) -> Option<Self> {
        let sets = cycle_sets(matrix)?;
        let entries: Vec<Vec<Expr>> = matrix
            .iter()
            .enumerate()
            .map(|(i, row)| {
                let letter = |(j, &entry): (usize, &Expr)| {
                    let graph = &mut derivation.algebra.graph;
                    if graph.as_number(entry).is_some() {
                        return entry;
                    }
                    graph.symbol(&format!("A_{}_{}", i + 1, j + 1))
                };
                row.iter().enumerate().map(letter).collect()
            })
            .collect();
        let mut names = Dissolved::default();
        let (mut in_entries, mut coefficients) = (Vec::new(), Vec::new());
        for sets in &sets {
            let graph = &mut derivation.algebra.graph;
            in_entries.push(sum(graph, sets, |i, j| entries[i][j]));
            let value = sum(graph, sets, |i, j| matrix[i][j]);
            let value = simplest(derivation, &mut names, value);
            coefficients.push(value);
        }
        // Products of several entries may cancel.
        for (in_entries, value) in in_entries.iter_mut().zip(&coefficients) {
            if *value == Graph::ZERO {
                *in_entries = Graph::ZERO;
            }
        }
        Some(Self {
            degree: matrix.len(),
            entries,
            in_entries,
            coefficients,
        })
    }

    /// The number of eigenvalues that are identically zero.
    pub fn zeros(&self) -> usize {
        let zeros = self.coefficients.iter().rev();
        zeros.take_while(|&&c| c == Graph::ZERO).count()
    }
}

/// A cycle: its states as bits, and its edges.
#[derive(Debug, Clone)]
struct Cycle {
    states: u64,
    edges: Vec<(usize, usize)>,
}

fn sum(graph: &mut Graph, sets: &[Vec<Cycle>], entry: impl Fn(usize, usize) -> Expr) -> Expr {
    let products: Vec<Expr> = sets
        .iter()
        .map(|set| {
            let edges = set.iter().flat_map(|cycle| &cycle.edges);
            let factors: Vec<Expr> = edges.map(|&(i, j)| entry(i, j)).collect();
            let product = graph.product(&factors);
            if set.len() % 2 == 1 {
                graph.neg(product)
            } else {
                product
            }
        })
        .collect();
    graph.sum(&products)
}

/// Sets of disjoint cycles through `k` states in total, at index `k`.
fn cycle_sets(matrix: &[&[Expr]]) -> Option<Vec<Vec<Vec<Cycle>>>> {
    if matrix.len() > MOST_STATES {
        return None;
    }
    let cycles = cycles(matrix)?;
    let mut sets: Vec<Vec<Vec<Cycle>>> = vec![Vec::new(); matrix.len() + 1];
    // Cycles are added in order, so that every set is generated once.
    let mut open: Vec<(usize, u64, Vec<Cycle>)> = vec![(0, 0, Vec::new())];
    while let Some((next, states, set)) = open.pop() {
        for (place, cycle) in cycles.iter().enumerate().skip(next) {
            if cycle.states & states == 0 {
                let larger = [set.as_slice(), std::slice::from_ref(cycle)].concat();
                open.push((place + 1, states | cycle.states, larger));
            }
        }
        let group = sets.get_mut(states.count_ones() as usize)?;
        group.push(set);
        if group.len() > MOST_PRODUCTS {
            return None;
        }
    }
    Some(sets)
}

/// Simple cycles, each starting at its first state.
fn cycles(matrix: &[&[Expr]]) -> Option<Vec<Cycle>> {
    let mut cycles = Vec::new();
    let mut open: Vec<Cycle> = Vec::new();
    for start in 0..matrix.len() {
        open.push(Cycle {
            states: 1 << start,
            edges: Vec::new(),
        });
        let mut steps = 0;
        while let Some(path) = open.pop() {
            steps += 1;
            if cycles.len() > MOST_PRODUCTS || steps > MOST_STEPS {
                return None;
            }
            let here = path.edges.last().map_or(start, |edge| edge.1);
            for (next, &entry) in matrix[here].iter().enumerate().skip(start) {
                if entry == Graph::ZERO {
                    continue;
                }
                let mut longer = path.clone();
                longer.edges.push((here, next));
                if next == start {
                    cycles.push(longer);
                } else if path.states & (1 << next) == 0 {
                    longer.states |= 1 << next;
                    open.push(longer);
                }
            }
        }
    }
    Some(cycles)
}
