//! The solution of Appell's equations in letters, for blocks whose written-out form is no reading.

use super::super::display::Equation;
use super::super::{Letter, Math};
use crate::symbolic::{Expr, Graph};

/// Larger blocks are solved when the equations are evaluated.
const LARGEST_BLOCK: usize = 5;

/// A block of linear equations with the mass matrix, in letters.
pub(super) struct System<'a> {
    /// The mass matrix, for its zeros.
    pub(super) matrix: &'a [Vec<Expr>],
    /// The unknown of a speed.
    pub(super) unknown: &'a dyn Fn(usize) -> Math,
    /// The right-hand side of a speed.
    pub(super) right: &'a dyn Fn(usize) -> Math,
}

impl System<'_> {
    /// Equations for the unknowns of a block; empty for large blocks.
    pub(super) fn solved(&self, block: &[usize]) -> Vec<Equation> {
        match *block {
            [k] => {
                vec![Equation::new(
                    (self.unknown)(k),
                    Math::fraction((self.right)(k), entry("M", k, k)),
                )]
            }
            [i, j] => self.by_determinants(i, j),
            _ if block.len() <= LARGEST_BLOCK => self.by_elimination(block),
            _ => Vec::new(),
        }
    }

    /// Two equations by Cramer's rule.
    fn by_determinants(&self, i: usize, j: usize) -> Vec<Equation> {
        let determinant = entry("Δ", i, j);
        let product = |a: Math, b: Math| Math::product(vec![a, b]);
        let value = Math::sum(vec![
            (false, product(entry("M", i, i), entry("M", j, j))),
            (true, square(entry("M", i, j))),
        ]);
        let mut equations = vec![Equation::new(determinant.clone(), value)];
        for (own, other) in [(i, j), (j, i)] {
            let numerator = Math::sum(vec![
                (false, product(entry("M", other, other), (self.right)(own))),
                (true, product(entry("M", i, j), (self.right)(other))),
            ]);
            let left = (self.unknown)(own);
            equations.push(Equation::new(
                left,
                Math::fraction(numerator, determinant.clone()),
            ));
        }
        equations
    }

    /// `M = L D Lᵀ`, entry by entry; what is zero by structure is left out.
    fn by_elimination(&self, block: &[usize]) -> Vec<Equation> {
        let n = block.len();
        let mut filled = vec![vec![false; n]; n];
        let mut equations = Vec::new();
        for a in 0..n {
            for p in 0..a {
                let changes: Vec<usize> =
                    (0..p).filter(|&q| filled[a][q] && filled[p][q]).collect();
                let own = self.matrix[block[a]][block[p]] != Graph::ZERO;
                filled[a][p] = own || !changes.is_empty();
                if !filled[a][p] {
                    continue;
                }
                let mut terms = Vec::new();
                if own {
                    terms.push((false, entry("M", block[a], block[p])));
                }
                for q in changes {
                    let factors = vec![
                        entry("L", block[a], block[q]),
                        entry("L", block[p], block[q]),
                        single("D", block[q]),
                    ];
                    terms.push((true, Math::product(factors)));
                }
                let value = Math::fraction(Math::sum(terms), single("D", block[p]));
                equations.push(Equation::new(entry("L", block[a], block[p]), value));
            }
            let mut pivot = vec![(false, entry("M", block[a], block[a]))];
            let mut reduced = vec![(false, (self.right)(block[a]))];
            for p in (0..a).filter(|&p| filled[a][p]) {
                let coupling = entry("L", block[a], block[p]);
                pivot.push((
                    true,
                    Math::product(vec![square(coupling.clone()), single("D", block[p])]),
                ));
                reduced.push((true, Math::product(vec![coupling, single("z", block[p])])));
            }
            equations.push(Equation::new(single("D", block[a]), Math::sum(pivot)));
            equations.push(Equation::new(single("z", block[a]), Math::sum(reduced)));
        }
        for a in (0..n).rev() {
            let mut terms = vec![(
                false,
                Math::fraction(single("z", block[a]), single("D", block[a])),
            )];
            for p in (a + 1..n).filter(|&p| filled[p][a]) {
                let known = (self.unknown)(block[p]);
                terms.push((
                    true,
                    Math::product(vec![entry("L", block[p], block[a]), known]),
                ));
            }
            let left = (self.unknown)(block[a]);
            equations.push(Equation::new(left, Math::sum(terms)));
        }
        equations
    }
}

/// `M₁₂`, with the smaller index first in a symmetric matrix.
fn entry(name: &str, i: usize, j: usize) -> Math {
    let (i, j) = if name == "M" {
        (i.min(j) + 1, i.max(j) + 1)
    } else {
        (i + 1, j + 1)
    };
    let place = if i.max(j) > 9 {
        format!("{i},{j}")
    } else {
        format!("{i}{j}")
    };
    Math::Letter(Letter::plain(name).below(&place))
}

fn single(name: &str, k: usize) -> Math {
    Math::Letter(Letter::plain(name).below(&(k + 1).to_string()))
}

/// `Π - b`
pub(super) fn force_less_bias(k: usize) -> Math {
    Math::Sum(vec![(false, single("Π", k)), (true, single("b", k))])
}

fn square(base: Math) -> Math {
    Math::Power(Box::new(base), Box::new(Math::integer(2)))
}
