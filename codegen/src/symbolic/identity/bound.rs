//! The degree of an expression in the elements that are drawn for it.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::field::PRIME;
use super::super::{Expr, Function, Graph, Node};
use super::point::{EXPONENT_PARTS, HALVINGS};

/// Degrees of numerator and denominator.
#[derive(Debug, Clone, Copy)]
struct Degree {
    over: f64,
    under: f64,
}

impl Degree {
    const CONSTANT: Self = Self { over: 0.0, under: 0.0 };
    const DRAWN: Self = Self { over: 1.0, under: 0.0 };

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
        Self { over: self.over + other.over, under: self.under + other.under }
    }

    fn power(self, exponent: i32) -> Self {
        let n = f64::from(exponent.unsigned_abs());
        let (over, under) = (n * self.over, n * self.under);
        if exponent < 0 { Self { over: under, under: over } } else { Self { over, under } }
    }
}

/// Bound on the probability that one trial takes `root` for zero; see
/// [`IdentityTest::error_bound`](super::IdentityTest::error_bound).
pub(super) fn per_trial(g: &Graph, root: Expr) -> f64 {
    let order = g.in_order(&[root]);
    let parts_of_angles = finest_part(g, &order);
    let mut degrees: FxHashMap<Expr, Degree> = FxHashMap::default();
    let mut roots: FxHashSet<Expr> = FxHashSet::default();
    let (mut drawn, mut arguments) = (0.0, 0.0);
    for &expr in &order {
        let of = |e: Expr| degrees[&e];
        let degree = match g.node(expr) {
            Node::Number(_) => Degree::CONSTANT,
            Node::Symbol(_) => Degree::DRAWN,
            Node::Named(id) => of(g.definition(*id).value),
            Node::Sum(terms) => Degree::sum(terms.iter().map(|t| of(t.expr))),
            Node::Product(factors) => factors
                .iter()
                .fold(Degree::CONSTANT, |p, f| p.times(of(f.base).power(f.exponent))),
            Node::Function(function, x) => {
                drawn += 1.0;
                arguments += of(*x).total();
                match function {
                    // Numerator and denominator of the parametrisation are quadratic.
                    Function::Sin | Function::Cos => {
                        let turns = 2.0 * multiples(g, *x) * parts_of_angles;
                        Degree { over: turns, under: turns }
                    }
                    Function::Exp | Function::Sinh | Function::Cosh | Function::Tanh => {
                        let parts = 2.0 * multiples(g, *x);
                        Degree { over: parts, under: parts }
                    }
                    Function::Sqrt => {
                        roots.insert(*x);
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
                let n = multiples(g, *exponent);
                let parts = Degree { over: n, under: n };
                Degree { over: n * of(*base).total(), under: n * of(*base).total() }.times(parts)
            }
            Node::Choice { compared, branches, .. } => {
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
                Degree { over: minor, under: minor }
            }
        };
        degrees.insert(expr, degree);
    }
    let values = PRIME as f64 / f64::from(1 << HALVINGS) / 90.0;
    let degree = degrees.get(&root).map_or(0.0, |d| d.total());
    (4f64.powf(roots.len() as f64) * (degree + drawn * arguments) / values).min(1.0)
}

/// `Σ |n|` of the coefficients `n / d` in an angle or an exponent, names looked through, at least 1.
fn multiples(g: &Graph, argument: Expr) -> f64 {
    let mut total: f64 = 0.0;
    let mut pending = vec![(1.0, argument)];
    while let Some((factor, expr)) = pending.pop() {
        match g.node(expr) {
            Node::Named(id) => pending.push((factor, g.definition(*id).value)),
            Node::Sum(terms) => {
                for t in terms {
                    let n = t.coefficient.as_small().map_or(1.0, |(n, _)| n.unsigned_abs() as f64);
                    pending.push((factor * n, t.expr));
                }
            }
            _ => total += factor,
        }
    }
    // The unit of exponents may be any of 720 parts; a whole one is counted by the caller's scale.
    total.clamp(1.0, EXPONENT_PARTS as f64 * f64::from(1 << 24))
}

/// The odd part of the common denominator of all coefficients in angles, since the drawn unit is
/// divided by it, times the common power of two.
fn finest_part(g: &Graph, order: &[Expr]) -> f64 {
    use num_integer::Integer;
    let mut common: u64 = 1;
    for &expr in order {
        let Node::Function(Function::Sin | Function::Cos | Function::Exp, x) = g.node(expr) else { continue };
        if let Node::Sum(terms) = g.node(*x) {
            for (_, d) in terms.iter().filter_map(|t| t.coefficient.as_small()) {
                let d = d.unsigned_abs();
                if let Some(lcm) = (common / common.gcd(&d)).checked_mul(d) {
                    common = lcm;
                }
            }
        }
    }
    common as f64
}
