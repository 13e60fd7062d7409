//! Symbolic elimination, for blocks of the mass matrix whose explicit form is unreadable.

use super::super::{About, Equation, Letter, Math};
use super::energy::numbered;
use appell_codegen::mechanics::motion::Block;

/// The elimination of larger blocks is not written entry by entry.
const LARGEST_BLOCK: usize = 5;

/// The elimination: speeds in order, and the non-zero entries of L.
pub(super) struct Elimination {
    /// Speeds in the order of elimination.
    pub(super) order: Vec<usize>,
    /// Columns of L with an entry, for each row.
    couplings: Vec<Vec<usize>>,
}

impl Elimination {
    pub(super) fn of(block: &Block) -> Self {
        match block {
            Block::Eliminated(equations) => {
                // The last equation was eliminated first.
                let columns = || equations.iter().rev();
                let order: Vec<usize> = columns().map(|e| e.speed).collect();
                let row = |(place, speed): (usize, &usize)| {
                    let couples = |column: usize| {
                        let equation = columns().nth(column);
                        equation.is_some_and(|e| e.couplings.iter().any(|c| c.0 == *speed))
                    };
                    (0..place).filter(|&column| couples(column)).collect()
                };
                let couplings = order.iter().enumerate().map(row).collect();
                Self { order, couplings }
            }
            Block::Factorized(block) => {
                let order = block.speeds.clone();
                let row = |row| (0..row).filter(|&c| block.couples(row, c)).collect();
                let couplings = (0..order.len()).map(row).collect();
                Self { order, couplings }
            }
        }
    }

    /// `M = L D Lᵀ`, entry by entry, and the accelerations; `None` for large blocks.
    pub(super) fn in_letters(&self, acceleration: impl Fn(usize) -> Math) -> Vec<Equation> {
        match *self.order {
            [k] => {
                let value = Math::fraction(force_less_bias(k), entry("M", k, k));
                vec![Equation::new(acceleration(k), value).about(About::Motion(k))]
            }
            _ if self.order.len() > LARGEST_BLOCK => Vec::new(),
            _ => {
                let mut equations = Vec::new();
                for row in 0..self.order.len() {
                    self.factorize(row, &mut equations);
                }
                for column in (0..self.order.len()).rev() {
                    equations.push(self.substituted_back(column, &acceleration));
                }
                equations
            }
        }
    }

    /// A row of L, its pivot, and the reduced right-hand side.
    fn factorize(&self, row: usize, equations: &mut Vec<Equation>) {
        let k = self.order[row];
        let (mut pivot, mut reduced) = (
            vec![(false, entry("M", k, k))],
            vec![(false, force_less_bias(k))],
        );
        for &column in &self.couplings[row] {
            let p = self.order[column];
            let shared = |q: &&usize| **q < column && self.couplings[column].contains(q);
            let mut terms = vec![(false, entry("M", k, p))];
            for &q in self.couplings[row].iter().filter(shared) {
                let q = self.order[q];
                let change = vec![entry("L", k, q), entry("L", p, q), numbered("D", q)];
                terms.push((true, Math::product(change)));
            }
            let coupling = entry("L", k, p);
            let value = Math::fraction(Math::sum(terms), numbered("D", p));
            equations.push(Equation::new(coupling.clone(), value).about(About::Inertia(k, p)));
            let change = Math::product(vec![raised(coupling.clone(), 2), numbered("D", p)]);
            pivot.push((true, change));
            reduced.push((true, Math::product(vec![coupling, numbered("z", p)])));
        }
        let pivot = Equation::new(numbered("D", k), Math::sum(pivot));
        equations.push(pivot.about(About::Inertia(k, k)));
        let reduced = Equation::new(numbered("z", k), Math::sum(reduced));
        equations.push(reduced.about(About::Motion(k)));
    }

    /// The acceleration of a column, from those of later rows.
    fn substituted_back(&self, column: usize, acceleration: impl Fn(usize) -> Math) -> Equation {
        let k = self.order[column];
        let uncoupled = Math::fraction(numbered("z", k), numbered("D", k));
        let mut terms = vec![(false, uncoupled)];
        for row in (column + 1..self.order.len()).filter(|&r| self.couplings[r].contains(&column)) {
            let known = self.order[row];
            let term = vec![entry("L", known, k), acceleration(known)];
            terms.push((true, Math::product(term)));
        }
        Equation::new(acceleration(k), Math::sum(terms)).about(About::Motion(k))
    }
}

/// `M₁₂`, with the smaller index first in a symmetric matrix.
fn entry(name: &str, i: usize, j: usize) -> Math {
    let (i, j) = if name == "M" {
        (i.min(j) + 1, i.max(j) + 1)
    } else {
        (i + 1, j + 1)
    };
    let comma = if i.max(j) > 9 { "," } else { "" };
    Math::Letter(Letter::plain(name).below(&format!("{i}{comma}{j}")))
}

/// `Π - b`
fn force_less_bias(k: usize) -> Math {
    Math::Sum(vec![(false, numbered("Π", k)), (true, numbered("b", k))])
}

pub(super) fn raised(base: Math, exponent: usize) -> Math {
    Math::Power(Box::new(base), Box::new(Math::integer(exponent)))
}
