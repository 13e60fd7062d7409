//! The expression graph with the tools shared by all stages of the derivation.

use appell_spec::Code;
use appell_spec::mechanism::Mechanism;

use crate::symbolic::vector::Vec3;
use crate::symbolic::{Derivatives, Expr, Graph, IdentityTest, Substitution, SymbolId};

use super::finding::{Finding, Item, Outcome, defined};
use super::quaternion::quaternions;
use super::symbols::{Symbols, ids};

/// Maximum number of expressions in a derivation.
const MOST_EXPRESSIONS: usize = 1_000_000;
/// Maximum number of expressions in a program with all derivatives.
pub(super) const MOST_OF_PROGRAM: usize = 8 * MOST_EXPRESSIONS;
/// Products with more terms than this are not expanded.
const MOST_TERMS: usize = 200;
/// Fractions are not combined if the numerator would have more terms than this.
const MOST_JOINED_TERMS: usize = 12;

/// Longer expressions are left in recursive form.
const MOST_OPERATIONS_OF_SHORT: usize = 80;

/// A system `C s = r` that determines unknowns, by the cofactors and the determinant of C.
#[derive(Debug, Clone)]
pub struct Relation {
    /// s.
    pub unknowns: Vec<Expr>,
    /// Their symbols.
    pub symbols: Vec<SymbolId>,
    /// Cofactors of C, row by row.
    pub cofactors: Vec<Vec<Expr>>,
    /// det C, which may vanish.
    pub determinant: Expr,
    /// r.
    pub right: Vec<Expr>,
}

/// Graph, identity test and memoised derivatives.
#[derive(Clone)]
pub struct Algebra {
    /// Owner of the expressions.
    pub graph: Graph,
    /// Decides equality of expressions in different forms.
    pub test: IdentityTest,
    /// The circle constant.
    pub(super) pi: Expr,
    coordinates: Vec<SymbolId>,
    derivatives: Vec<(SymbolId, Derivatives)>,
    /// Relations between unknowns without an explicit formula; temporarily removed while in use.
    pub(super) relations: Vec<Relation>,
    /// Unit quaternions, the scalar part first.
    pub(super) quaternions: Vec<[Expr; 4]>,
    /// Coordinates that position constraints determine explicitly.
    pub(crate) given: Vec<(Expr, Expr)>,
    /// Whether long expressions are left in recursive form.
    pub(super) recursive: bool,
    /// Whether generalised velocities that are quotients remain symbols, for display.
    pub in_letters: bool,
}

impl Algebra {
    /// Tools for the expressions in `graph`, whose symbols are those of a mechanism.
    pub fn new(graph: Graph, mechanism: &Mechanism, symbols: &Symbols) -> Self {
        let coordinates = ids(&graph, &symbols.coordinates);
        let quaternions = quaternions(mechanism);
        let quaternions = quaternions.map(|places| places.map(|place| symbols.coordinates[place]));
        let quaternions: Vec<[Expr; 4]> = quaternions.collect();
        let of_symbols = quaternions
            .iter()
            .filter_map(|e| ids(&graph, e).try_into().ok());
        let mut test = IdentityTest::new(seed(mechanism)).with_quaternions(of_symbols.collect());
        if let Some(pi) = graph.as_symbol(symbols.pi) {
            test = test.with_pi(pi);
        }
        Self {
            graph,
            test,
            pi: symbols.pi,
            coordinates,
            derivatives: Vec::new(),
            relations: Vec::new(),
            quaternions,
            given: Vec::new(),
            recursive: false,
            in_letters: false,
        }
    }

    /// Fails if the number of expressions exceeds any realistic mechanism's.
    pub fn check_size(&self) -> Outcome<()> {
        self.holds_at_most(MOST_EXPRESSIONS)
    }

    /// Fails if there are more expressions.
    pub fn holds_at_most(&self, most: usize) -> Outcome<()> {
        if self.graph.len() <= most {
            return Ok(());
        }
        Err(vec![Finding {
            code: Code::TooLarge,
            message: format!("the equations need more than {most} expressions"),
            item: Item::Mechanism,
            help:
                "rotate frames from the ground instead of from each other, or split the mechanism"
                    .to_owned(),
        }])
    }

    /// `∂expr/∂symbol`; zero where `symbol` is not a symbol.
    pub fn derivative(&mut self, expr: Expr, symbol: Expr) -> Expr {
        let Some(symbol) = self.graph.as_symbol(symbol) else {
            return Graph::ZERO;
        };
        let known = self.derivatives.iter().position(|(s, _)| *s == symbol);
        let place = known.unwrap_or_else(|| {
            self.derivatives
                .push((symbol, Derivatives::with_respect_to(symbol)));
            self.derivatives.len() - 1
        });
        self.derivatives[place].1.of(&mut self.graph, expr)
    }

    /// [`Algebra::derivative`] of each component.
    pub fn derivative3(&mut self, v: Vec3, symbol: Expr) -> Vec3 {
        v.map(|component| self.derivative(component, symbol))
    }

    /// Expressions after a substitution.
    pub fn apply(&mut self, substitution: &mut Substitution, exprs: &[Expr]) -> Outcome<Vec<Expr>> {
        let applied = substitution.apply_all(&mut self.graph, exprs);
        defined(applied, Item::Mechanism)
    }

    /// The expression, or the number zero if it vanishes identically, so that rounding cannot make it appear to
    /// depend on anything.
    pub fn unless_zero(&mut self, expr: Expr) -> Expr {
        if self.test.is_zero(&self.graph, expr) {
            Graph::ZERO
        } else {
            expr
        }
    }

    /// Whether an expression vanishes on the constraint manifold, as far as position constraints give
    /// coordinates explicitly.
    pub fn vanishes(&mut self, expr: Expr) -> bool {
        if self.test.is_zero(&self.graph, expr) {
            return true;
        }
        let symbols: Vec<Expr> = self.given.iter().map(|&(q, _)| q).collect();
        let symbols = ids(&self.graph, &symbols);
        if !self.graph.mentions(expr, &symbols) {
            return false;
        }
        let there = Substitution::of_parts(&self.graph, &self.given).apply(&mut self.graph, expr);
        there.is_some_and(|there| self.test.is_zero(&self.graph, there))
    }

    /// The same value with the fewest operations found by the tools here.
    ///
    /// A coordinate on which the value provably does not depend is set to zero: the velocity of a wheel in its
    /// own frame, written with the yaw angle, is independent of yaw. Then the products are expanded where that
    /// saves operations.
    pub fn shortest(&mut self, expr: Expr) -> Expr {
        if self.graph.is_free(expr) || self.recursive && self.is_long(expr) {
            return expr;
        }
        if self.test.is_zero(&self.graph, expr) {
            return Graph::ZERO;
        }
        let mut best = self.without_idle_coordinates(expr);
        if let Some(expanded) = self.graph.expand(best, MOST_TERMS) {
            best = self.graph.shorter(best, expanded);
        }
        best = self.with_unit_norms(best);
        let factored = self.graph.take_out_common_factors(best);
        self.graph.shorter(best, factored)
    }

    /// The same value on unit quaternions, if that is shorter: w² = 1 − x² − y² − z².
    fn with_unit_norms(&mut self, mut expr: Expr) -> Expr {
        for quaternion in self.quaternions.clone() {
            let symbols = ids(&self.graph, &quaternion);
            if !self.graph.mentions(expr, &symbols) {
                continue;
            }
            let [scalar, vector @ ..] = quaternion;
            let squares = vector.map(|component| self.graph.square(component));
            let sum = self.graph.sum(&squares);
            let rest = self.graph.sub(Graph::ONE, sum);
            if let Some(reduced) = self.graph.with_square(expr, scalar, rest, MOST_TERMS) {
                expr = self.graph.shorter(expr, reduced);
            }
        }
        expr
    }

    /// An equal expression with fewer divisors and no more operations: pivots of an elimination often cancel.
    pub fn with_fewest_divisors(&mut self, expr: Expr) -> Expr {
        let divisors = self.graph.divisor_count(expr);
        if divisors < 2 {
            return expr;
        }
        let joined = (self.graph).one_fraction(&mut self.test, expr, MOST_JOINED_TERMS);
        let expanded = self.graph.expand(expr, MOST_JOINED_TERMS);
        let nested = expanded.map(|expanded| self.graph.nest(expanded));
        let graph = &self.graph;
        let cost = |form: &Expr| (graph.divisor_count(*form), graph.operations(&[*form]));
        let pays = |form: &Expr| {
            let (left, operations) = cost(form);
            left < divisors && operations <= graph.operations(&[expr])
        };
        let forms = [joined, nested].into_iter().flatten().filter(pays);
        forms.min_by_key(cost).unwrap_or(expr)
    }

    /// A vector from which others are computed: its components are named, which prevents their expansion.
    pub(super) fn shared3(&mut self, name: &str, v: Vec3) -> Vec3 {
        let v = v.map(|component| self.shortest(component));
        named3(self, name, v)
    }

    fn is_long(&self, expr: Expr) -> bool {
        self.graph.operations(&[expr]) > MOST_OPERATIONS_OF_SHORT
    }

    /// [`Algebra::shortest`] of each component, using the relations between unknowns.
    pub fn shortest3(&mut self, v: Vec3) -> Vec3 {
        let v = v.map(|component| self.shortest(component));
        let relations = std::mem::take(&mut self.relations);
        let v = v.map(|component| {
            let told = relations.iter();
            told.fold(component, |e, relation| {
                self.related(e, relation).unwrap_or(e)
            })
        });
        self.relations = relations;
        v
    }

    /// An expression `c s + rest` with the unknowns eliminated, `c C⁻¹ r + rest`, if that needs no division and
    /// no more operations.
    fn related(&mut self, expr: Expr, relation: &Relation) -> Option<Expr> {
        let is_long = self.graph.operations(&[expr]) > MOST_TERMS;
        if is_long || !self.graph.mentions(expr, &relation.symbols) {
            return None;
        }
        let mut slopes = Vec::with_capacity(relation.unknowns.len());
        let mut parts = vec![expr];
        for &unknown in &relation.unknowns {
            let slope = self.derivative(expr, unknown);
            let slope = self.shortest(slope);
            if self.graph.mentions(slope, &relation.symbols) {
                return None;
            }
            let part = self.graph.mul(slope, unknown);
            parts.push(self.graph.neg(part));
            slopes.push(slope);
        }
        for (cofactors, &right) in relation.cofactors.iter().zip(&relation.right) {
            let over = scalar_product(&mut self.graph, &slopes, cofactors);
            let over = self.shortest(over);
            let factor = self.graph.div(over, relation.determinant);
            let factor = self.shortest(factor);
            if self.graph.divisor_count(factor) > 0 {
                return None;
            }
            parts.push(self.graph.mul(factor, right));
        }
        let sum = self.graph.sum(&parts);
        let told = self.shortest(sum);
        let graph = &self.graph;
        let pays = graph.operations(&[told]) <= graph.operations(&[expr]);
        (pays && !graph.mentions(told, &relation.symbols)).then_some(told)
    }

    /// An expression with `parts` substituted, expanded and nested again. `None` if that gives too many terms.
    pub fn written_out(&mut self, expr: Expr, parts: &[(Expr, Expr)]) -> Option<Expr> {
        let plain = Substitution::of_parts(&self.graph, parts).apply(&mut self.graph, expr)?;
        let expanded = self.graph.expand(plain, MOST_TERMS)?;
        let expanded = self.with_unit_norms(expanded);
        Some(self.graph.nest(expanded))
    }

    /// A quotient as `whole + over / under` without common factors, with `parts` substituted:
    /// `[whole, over, under]`. `None` if the expansion has too many terms.
    pub fn cancelled(
        &mut self,
        numerator: Expr,
        denominator: Expr,
        parts: &[(Expr, Expr)],
    ) -> Option<[Expr; 3]> {
        let mut written_out = Substitution::of_parts(&self.graph, parts);
        let over = written_out.apply(&mut self.graph, numerator)?;
        let over = self.graph.expand(over, MOST_TERMS)?;
        let under = self.graph.expand(denominator, MOST_TERMS)?;
        let (over, under) = (
            self.graph.take_out_common_factors(over),
            self.graph.take_out_common_factors(under),
        );
        let quotient = self.graph.div(over, under);
        let (over, under) = self.graph.split_fraction(quotient);
        let (over, under) = (
            self.graph.expand(over, MOST_TERMS)?,
            self.graph.expand(under, MOST_TERMS)?,
        );
        let (whole, rest) = self.graph.divide_out(over, under);
        Some([whole, rest, under].map(|part| self.graph.nest(part)))
    }

    fn without_idle_coordinates(&mut self, expr: Expr) -> Expr {
        let mentioned: Vec<SymbolId> = self
            .coordinates
            .iter()
            .copied()
            .filter(|&c| self.graph.mentions(expr, &[c]))
            .collect();
        let mut best = expr;
        for coordinate in mentioned {
            if self.test.independent_of(&self.graph, best, coordinate) {
                let at_zero = Substitution::new(&mut self.graph, &[(coordinate, Graph::ZERO)])
                    .apply(&mut self.graph, best);
                // At zero the expression may be undefined although no denominator is the number 0.
                best = at_zero
                    .filter(|&at_zero| self.test.are_equal(&self.graph, best, at_zero))
                    .unwrap_or(best);
            }
        }
        best
    }
}

/// The seed of the identity test is derived from the spec, so that runs are reproducible.
pub fn seed(mechanism: &Mechanism) -> u64 {
    // FNV-1a: short and stable. An adversarial spec harms only its author.
    mechanism
        .name
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
}

/// Replaces each of `parts` by its value.
pub fn replacing(graph: &Graph, parts: &[Expr], values: &[Expr]) -> Substitution {
    let pairs = parts.iter().copied().zip(values.iter().copied());
    Substitution::of_parts(graph, &pairs.collect::<Vec<_>>())
}

/// `Σ a b`
pub fn scalar_product(graph: &mut Graph, a: &[Expr], b: &[Expr]) -> Expr {
    let products: Vec<Expr> = a.iter().zip(b).map(|(&a, &b)| graph.mul(a, b)).collect();
    graph.sum(&products)
}

/// A vector with names for its components.
pub(super) fn named3(algebra: &mut Algebra, name: &str, v: Vec3) -> Vec3 {
    let mut named = v;
    for (component, axis) in named.iter_mut().zip(["x", "y", "z"]) {
        *component = algebra.graph.name(&format!("{name}_{axis}"), *component);
    }
    named
}

/// Name of a symbol.
pub(super) fn name_of(graph: &Graph, symbol: Expr) -> String {
    graph
        .as_symbol(symbol)
        .map_or_else(String::new, |symbol| graph.symbol_name(symbol).to_owned())
}
