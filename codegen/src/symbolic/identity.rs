//! Equality of expressions, decided by evaluation at random points of a finite field.
//!
//! Two forms of one rational function have the same value wherever both are defined. Two different rational
//! functions of degree `D` agree at no more than a fraction `D / p` of the points of a field with `p`
//! elements (Schwartz and Zippel). So a few random points decide, and the arithmetic is exact. The field has
//! nearly `2^61` elements; its prime is defined in `field.rs`.
//!
//! Non-rational functions are modelled so that their identities hold exactly:
//!
//! - **Sine and cosine.** An angle is split into atoms, `Σ coefficient · atom`. The *value* of an atom
//!   determines a pseudo-random point of the unit circle; equal atoms get equal points in whatever form they
//!   are written. The circle is a cyclic group of `p + 1 = 48 q` elements. The point drawn represents
//!   `atom / 2304`; a coefficient `n / d` multiplies it by `2304 n / d`, where the part of `d` that does not
//!   divide 2304 is inverted modulo the group's order. That is a homomorphism from the angles to the circle,
//!   hence all addition theorems and all formulas for multiples and fractions of angles are exact. A
//!   coefficient with `n d > 2^24`, or with more factors 2 and 3 in `d` than 2304 has, becomes part of its
//!   atom; the angle is then unrelated to other multiples of the atom. Angles are not expanded: `x (y + z)` and
//!   `x y + x z` are different atoms. If the symbol of π is given, multiples of `π/24` have their exact values,
//!   consistent with `√2` and `√3`.
//! - **exp, sinh, cosh, tanh.** The same with the multiplicative group and multiples of `1/720`.
//! - **Square root.** The root that is a square itself. Where the radicand is not a square, the point is
//!   skipped. If the radicand is a square at every point, such as `a²`, the sign of the root cannot be
//!   distinguished from that of `a`: the test makes no claim about such expressions. Roots of numbers are
//!   constants of the field, if only primes up to 31 occur in them.
//! - **Unit quaternions.** If the symbols of their components are given, these are drawn from the unit
//!   sphere, by its stereographic projection.
//! - **Choice.** `otherwise + w (then - otherwise)`, where `w` is a random function of the difference of the
//!   compared expressions. This is linear in the branches; the identity `w² = w` is not modelled.
//! - **Every other function** is a random function of the values of its arguments, odd where the function is
//!   odd. `|x|` is `x sign(x)`.
//! - **Unknowns of a linear system** are solved for.
//!
//! Each of these models satisfies every identity that it proves, so equal expressions can appear different
//! (by a theorem that is not modelled), but different ones appear equal only with the probability that
//! [`IdentityTest::error_bound`] bounds, provided that the prime does not divide the coefficients, which
//! holds for all numbers met in practice. Division by zero leaves a value undefined; questions about
//! expressions that are undefined at every point are answered with "no".

mod bound;
mod cone;
mod elimination;
mod point;
mod tag;

use rustc_hash::FxHashMap;

use self::cone::Cones;
use self::point::{Point, Redraw, symbol_bit};
use super::field::{Element, keyed};
use super::{Expr, Graph, SymbolId};

/// Points at which an identity must hold.
const TRIALS: usize = 2;
/// Points that are tried for an expression without square roots.
const MOST_POINTS: usize = TRIALS + 2;
/// Values that points with one symbol redrawn may memoise.
const MOST_REMEMBERED: usize = 1 << 21;
/// Points that are tried for an expression with square roots. Each independent root is defined at half of the
/// points on average.
const MOST_POINTS_WITH_ROOTS: usize = 128;

/// Identity testing on one graph, which may grow between queries.
///
/// Values are memoised by expression: queries about all expressions of a graph together cost one evaluation
/// of it per trial. The answers depend on the seed and the graph only.
#[derive(Debug, Clone)]
pub struct IdentityTest {
    seed: u64,
    pi: Option<SymbolId>,
    quaternions: Vec<[SymbolId; 4]>,
    points: Vec<Point>,
    cones: Cones,
    /// For [`IdentityTest::independent_of`]: the first points with one symbol redrawn.
    redrawn: FxHashMap<(SymbolId, usize), Point>,
    /// Number of values memoised for these points.
    remembered: usize,
    /// Whether sets of radicands are independent, as far as tested.
    independent: FxHashMap<u32, bool>,
}

impl IdentityTest {
    /// A test whose random points are determined by `seed`.
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            pi: None,
            quaternions: Vec::new(),
            points: Vec::new(),
            cones: Cones::default(),
            redrawn: FxHashMap::default(),
            remembered: 0,
            independent: FxHashMap::default(),
        }
    }

    /// The same test with the symbol of π.
    #[must_use]
    pub fn with_pi(self, pi: SymbolId) -> Self {
        Self {
            pi: Some(pi),
            quaternions: self.quaternions,
            ..Self::new(self.seed)
        }
    }

    /// The same test with the symbols of unit quaternions, scalar parts first.
    #[must_use]
    pub fn with_quaternions(self, quaternions: Vec<[SymbolId; 4]>) -> Self {
        Self {
            pi: self.pi,
            quaternions,
            ..Self::new(self.seed)
        }
    }

    /// A test of the same graph at other points.
    #[must_use]
    pub fn reseeded(&self, seed: u64) -> Self {
        Self {
            pi: self.pi,
            quaternions: self.quaternions.clone(),
            ..Self::new(seed)
        }
    }

    /// Whether `e` is zero wherever it is defined.
    pub fn is_zero(&mut self, g: &Graph, e: Expr) -> bool {
        e == Graph::ZERO || self.are_equal(g, e, Graph::ZERO)
    }

    /// Whether `a` and `b` are the same function.
    pub fn are_equal(&mut self, g: &Graph, a: Expr, b: Expr) -> bool {
        if a == b {
            return true;
        }
        self.cones.extend(g);
        let roots = self.cones.union(self.cones.roots(a), self.cones.roots(b));
        let both = |test: &mut Self, index| test.value(g, index, a).zip(test.value(g, index, b));
        self.agree_at(most_points(roots), TRIALS, both) && self.roots_are_independent(g, roots)
    }

    /// Whether the values of two expressions are equal at the first `enough` of `most` points where they are defined.
    fn agree_at(
        &mut self,
        most: usize,
        enough: usize,
        mut both: impl FnMut(&mut Self, usize) -> Option<(Element, Element)>,
    ) -> bool {
        let mut agreed = 0;
        for index in 0..most {
            if let Some((a, b)) = both(self, index) {
                if a != b {
                    return false;
                }
                agreed += 1;
                if agreed == enough {
                    return true;
                }
            }
        }
        false
    }

    /// Whether the value of `e` stays the same when only `symbol` changes.
    pub fn independent_of(&mut self, g: &Graph, e: Expr, symbol: SymbolId) -> bool {
        self.cones.extend(g);
        if self.cones.symbols(e) & symbol_bit(symbol) == 0 {
            return true;
        }
        // The points differ for each symbol: together they would store a value for each pair.
        if self.remembered > MOST_REMEMBERED {
            self.redrawn.clear();
            self.remembered = 0;
        }
        let roots = self.cones.roots(e);
        let both = |test: &mut Self, index| {
            let before = test.value(g, index, e)?;
            let Self {
                points,
                redrawn,
                remembered,
                cones,
                ..
            } = test;
            let original = &points[index];
            let redraw = Redraw {
                original,
                symbol,
                symbols: cones.all_symbols(),
            };
            let other = redrawn
                .entry((symbol, index))
                .or_insert_with(|| original.sibling());
            let known = other.len();
            let after = other.evaluate(g, e, Some(redraw));
            *remembered += other.len() - known;
            Some((before, after?))
        };
        self.agree_at(most_points(roots), TRIALS, both) && self.roots_are_independent(g, roots)
    }

    /// Bound on the probability that [`IdentityTest::is_zero`] takes a nonzero `e` for zero, over the choice
    /// of the seed. For `are_equal(a, b)` pass `a - b`.
    ///
    /// With `D` the degree of `e` in the drawn elements (numerator and denominator added, over a common
    /// denominator), `m` the number of random functions drawn in it and `A` the sum of their arguments'
    /// degrees, two different arguments have the same value with probability at most `m A / s`, and otherwise
    /// `e` vanishes with probability at most `D / s`. Here `s = p / 48` is the number of values that a drawn
    /// element takes when angles and exponents are integer multiples. Each of `k` square roots at most halves
    /// the defined points and doubles the degree. So a trial errs with probability at most `4^k (D + m A) / s`,
    /// and two trials with its square.
    pub fn error_bound(&self, g: &Graph, e: Expr) -> f64 {
        bound::per_trial(g, e, &self.quaternions)
            .powi(i32::try_from(TRIALS).unwrap_or(1))
            .min(1.0)
    }

    /// Value at a point that is created on first use.
    fn value(&mut self, g: &Graph, index: usize, e: Expr) -> Option<Element> {
        while self.points.len() <= index {
            let key = keyed(self.seed, self.points.len() as u64, [0, 0]).get();
            self.points
                .push(Point::new(key, self.pi, self.quaternions.clone()));
        }
        self.points[index].evaluate(g, e, None)
    }

    /// Whether the radicands are independent: none is a square in the field extension by the roots of those
    /// before it.
    ///
    /// A point proves this for a radicand that is not a square there while all radicands before it are. Then
    /// an expression in the roots that is zero at random points is zero for every choice of their signs.
    fn roots_are_independent(&mut self, g: &Graph, roots: u32) -> bool {
        if roots == Cones::NO_ROOTS {
            return true;
        }
        if let Some(&known) = self.independent.get(&roots) {
            return known;
        }
        let mut radicands = self.cones.radicands(roots).to_vec();
        self.drop_equal(g, &mut radicands);
        let mut proven = vec![false; radicands.len()];
        for index in 0..MOST_POINTS_WITH_ROOTS {
            for (radicand, proven) in radicands.iter().zip(&mut proven) {
                match self.value(g, index, *radicand) {
                    None => break,
                    Some(value) if value.square_root().is_none() => {
                        *proven = true;
                        break;
                    }
                    Some(_) => {}
                }
            }
            if proven.iter().all(|&p| p) {
                break;
            }
        }
        let independent = proven.iter().all(|&p| p);
        self.independent.insert(roots, independent);
        independent
    }

    /// Removes duplicates among radicands that are the same function.
    fn drop_equal(&mut self, g: &Graph, radicands: &mut Vec<Expr>) {
        let all = std::mem::take(radicands);
        for candidate in all {
            let mut known = false;
            for &other in radicands.iter() {
                known = known || self.agree(g, candidate, other);
            }
            if !known {
                radicands.push(candidate);
            }
        }
    }

    /// Whether two expressions agree wherever both are defined, taking the square roots drawn.
    fn agree(&mut self, g: &Graph, a: Expr, b: Expr) -> bool {
        let both = |test: &mut Self, index| test.value(g, index, a).zip(test.value(g, index, b));
        // More points guard against the sign of a root.
        self.agree_at(MOST_POINTS_WITH_ROOTS, 8 * TRIALS, both)
    }
}

/// The number of points to try for an expression with a given set of square roots.
fn most_points(roots: u32) -> usize {
    if roots == Cones::NO_ROOTS {
        MOST_POINTS
    } else {
        MOST_POINTS_WITH_ROOTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point for each symbol would store a value for each pair of a symbol and an expression.
    #[test]
    fn points_with_one_symbol_drawn_again_remember_what_depends_on_it() {
        const COUNT: usize = 300;
        let mut g = Graph::new();
        let symbols: Vec<Expr> = (0..COUNT).map(|k| g.symbol(&format!("x{k}"))).collect();
        let sines: Vec<Expr> = symbols.iter().map(|&x| g.sin(x)).collect();
        let mut test = IdentityTest::new(1);
        for (&symbol, k) in symbols.iter().zip(0..) {
            let symbol = g.as_symbol(symbol).expect("a symbol");
            for (&sine, other) in sines.iter().zip(0..) {
                assert_eq!(test.independent_of(&g, sine, symbol), k != other);
            }
        }
        // Sixty-four symbols apart share a bit.
        assert!(
            test.remembered < COUNT * 4 * COUNT.div_ceil(64),
            "{}",
            test.remembered
        );
    }
}
