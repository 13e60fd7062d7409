//! The degree of an expression in the drawn field elements.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::field::PRIME;
use super::super::{Expr, Function, Graph, Node, Rational, SymbolId};

/// Degrees of numerator and denominator.
#[derive(Debug, Clone, Copy)]
struct Degree {
    over: f64,
    under: f64,
}

impl Degree {
    const CONSTANT: Self = Self {
        over: 0.0,
        under: 0.0,
    };
    const DRAWN: Self = Self {
        over: 1.0,
        under: 0.0,
    };

    /// A component of a unit quaternion, by stereographic projection.
    const ON_SPHERE: Self = Self {
        over: 2.0,
        under: 2.0,
    };

    fn total(self) -> f64 {
        self.over + self.under
    }

    fn sum(parts: impl Iterator<Item = Self>) -> Self {
        parts.fold(Self::CONSTANT, |a, b| Self {
            over: (a.over + b.under).max(b.over + a.under),
            under: a.under + b.under,
        })
    }

    fn times(self, other: Self) -> Self {
        Self {
            over: self.over + other.over,
            under: self.under + other.under,
        }
    }

    fn power(self, exponent: i32) -> Self {
        let n = f64::from(exponent.unsigned_abs());
        let (over, under) = (n * self.over, n * self.under);
        if exponent < 0 {
            Self {
                over: under,
                under: over,
            }
        } else {
            Self { over, under }
        }
    }
}

/// Bound on the probability that one trial takes a nonzero `root` for zero; see
/// [`IdentityTest::error_bound`](super::IdentityTest::error_bound).
pub(super) fn per_trial(g: &Graph, root: Expr, quaternions: &[[SymbolId; 4]]) -> f64 {
    let order = g.in_order(&[root]);
    let unit = finest_part(g, &order);
    let mut degrees: FxHashMap<Expr, Degree> = FxHashMap::default();
    let mut roots: FxHashSet<Expr> = FxHashSet::default();
    let (mut drawn, mut arguments) = (0.0, 0.0);
    for &expr in &order {
        let of = |e: Expr| degrees[&e];
        let degree = match g.node(expr) {
            Node::Number(_) => Degree::CONSTANT,
            Node::Symbol(symbol) if quaternions.iter().flatten().any(|s| s == symbol) => {
                Degree::ON_SPHERE
            }
            Node::Symbol(_) => Degree::DRAWN,
            Node::Named(id) => of(g.definition(*id).value),
            Node::Sum(terms) => Degree::sum(terms.iter().map(|t| of(t.expr))),
            Node::Product(factors) => factors.iter().fold(Degree::CONSTANT, |p, f| {
                p.times(of(f.base).power(f.exponent))
            }),
            Node::Function(function, x) => {
                drawn += 1.0;
                arguments += of(*x).total();
                match function {
                    // The parametrisation of the circle is quadratic in numerator and denominator, and so is
                    // the hyperbolic sine in the exponential.
                    Function::Sin
                    | Function::Cos
                    | Function::Exp
                    | Function::Sinh
                    | Function::Cosh
                    | Function::Tanh => {
                        let parts = 2.0 * multiples(g, *x, unit);
                        Degree {
                            over: parts,
                            under: parts,
                        }
                    }
                    Function::Sqrt => {
                        if g.as_number(*x).is_none() {
                            roots.insert(*x);
                        }
                        of(*x)
                    }
                    Function::Abs => of(*x).times(Degree::DRAWN),
                    _ => Degree::DRAWN,
                }
            }
            Node::Atan2(y, x) => {
                drawn += 1.0;
                arguments += of(*y).total() + of(*x).total();
                Degree::DRAWN
            }
            Node::Power(base, exponent) => {
                drawn += 1.0;
                arguments += of(*base).total() + of(*exponent).total();
                roots.insert(*base);
                let n = multiples(g, *exponent, unit);
                let parts = Degree { over: n, under: n };
                Degree {
                    over: n * of(*base).total(),
                    under: n * of(*base).total(),
                }
                .times(parts)
            }
            Node::Choice {
                compared, branches, ..
            } => {
                drawn += 1.0;
                arguments += of(compared[0]).total() + of(compared[1]).total();
                let [then, otherwise] = branches.map(of);
                Degree::sum([then, otherwise].into_iter()).times(Degree::DRAWN)
            }
            Node::Solution { system, .. } => {
                // Cramer's rule: products of one entry per row, over a common denominator.
                let system = g.system(*system);
                let all = system.matrix.iter().chain(&system.right).map(|&e| of(e));
                let (over, under) =
                    all.fold((0.0_f64, 0.0), |(o, u), d| (o.max(d.over), u + d.under));
                let size = system.right.len() as f64;
                let minor = size * (over + under);
                Degree {
                    over: minor,
                    under: minor,
                }
            }
        };
        degrees.insert(expr, degree);
    }
    // Common divisors of the multiples used and the orders of the groups, 48 and 10.
    let values = PRIME as f64 / 48.0;
    let degree = degrees.get(&root).map_or(0.0, |d| d.total());
    (4f64.powf(roots.len() as f64) * (degree + drawn * arguments) / values).min(1.0)
}

/// The coefficients of an angle or an exponent in multiples of the expression's common unit:
/// `Σ |coefficient| · unit`, at least 1.
fn multiples(g: &Graph, argument: Expr, unit: f64) -> f64 {
    let sum: f64 = coefficients(g, argument)
        .iter()
        .map(|c| c.abs().to_f64())
        .sum();
    (sum * unit).max(1.0)
}

/// The common denominator of all coefficients in angles and exponents.
fn finest_part(g: &Graph, order: &[Expr]) -> f64 {
    use num_integer::Integer;
    let mut common: u64 = 1;
    for &expr in order {
        let argument = match g.node(expr) {
            Node::Function(Function::Sqrt, _) => continue,
            Node::Function(_, x) | Node::Power(_, x) => *x,
            _ => continue,
        };
        for (_, d) in coefficients(g, argument)
            .iter()
            .filter_map(Rational::as_small)
        {
            let d = d.unsigned_abs();
            // Multiples that overflow are not related to others.
            if let Some(multiple) = (common / common.gcd(&d)).checked_mul(d) {
                common = multiple;
            }
        }
    }
    common as f64
}

/// The coefficients of the atoms of a sum, with names replaced by their definitions.
fn coefficients(g: &Graph, argument: Expr) -> Vec<Rational> {
    let mut found = Vec::new();
    let mut pending = vec![(Rational::ONE, argument)];
    while let Some((factor, expr)) = pending.pop() {
        match g.node(expr) {
            Node::Named(id) => pending.push((factor, g.definition(*id).value)),
            Node::Sum(terms) => {
                pending.extend(terms.iter().map(|t| (&factor * &t.coefficient, t.expr)));
            }
            Node::Number(n) => found.push(&factor * n),
            _ => found.push(factor),
        }
    }
    found
}
