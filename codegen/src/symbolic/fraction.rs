//! A rational expression as a single fraction in lowest terms.

use rustc_hash::{FxHashMap, FxHashSet};

use super::node::{Expr, Function, Node, Term};
use super::{Graph, IdentityTest, Rational};

/// `over / Π base^exponent`, with `over` expanded.
#[derive(Debug, Clone)]
struct Fraction {
    over: Expr,
    under: Vec<(Expr, i32)>,
}

impl Fraction {
    fn whole(over: Expr) -> Self {
        Self {
            over,
            under: Vec::new(),
        }
    }
}

impl Graph {
    /// The same value as one fraction, with the fewest operations found: over a common denominator, with
    /// common factors of numerator and denominator cancelled and sin² or cos² exchanged for each other. Names
    /// and functions are left unchanged. `None` where a sum would have more than `limit` terms.
    pub fn one_fraction(
        &mut self,
        test: &mut IdentityTest,
        expr: Expr,
        limit: usize,
    ) -> Option<Expr> {
        let fraction = self.together(expr, limit)?;
        let mut numerators = vec![fraction.over];
        for kept in [Function::Sin, Function::Cos] {
            numerators.extend(self.by_pythagoras(fraction.over, kept, limit));
        }
        let mut best: Option<Expr> = None;
        for over in numerators {
            let cancelled = self.cancel(test, over, &fraction.under, limit);
            best = Some(best.map_or(cancelled, |best| self.shorter(best, cancelled)));
        }
        best
    }

    /// Number of distinct divisors in an expression.
    pub fn divisor_count(&self, expr: Expr) -> usize {
        let mut divisors = FxHashSet::default();
        for part in self.in_order(&[expr]) {
            if let Node::Product(factors) = self.node(part) {
                let under = factors.iter().filter(|factor| factor.exponent < 0);
                divisors.extend(under.map(|factor| factor.base));
            }
        }
        divisors.len()
    }

    /// Converts an expression to a single fraction, operands before users.
    fn together(&mut self, expr: Expr, limit: usize) -> Option<Fraction> {
        let mut known: FxHashMap<Expr, Fraction> = FxHashMap::default();
        for part in self.in_order(&[expr]) {
            let fraction = match self.node(part).clone() {
                Node::Sum(terms) => self.sum_of_fractions(&terms, &known, limit)?,
                Node::Product(factors) => {
                    let mut over = Vec::with_capacity(factors.len());
                    let mut under = Vec::new();
                    for factor in &factors {
                        let base = known
                            .get(&factor.base)
                            .cloned()
                            .unwrap_or_else(|| Fraction::whole(factor.base));
                        let size = factor.exponent.abs();
                        if base.over == Self::ZERO && factor.exponent < 0 {
                            return None;
                        }
                        if factor.exponent > 0 {
                            over.push(self.pow(base.over, size));
                            raise(&mut under, &base.under, size);
                        } else {
                            let (coefficient, divisors) = self.divisors(base.over)?;
                            let coefficient = self.number(coefficient.recip());
                            over.push(self.pow(coefficient, size));
                            for (divisor, exponent) in base.under {
                                over.push(self.pow(divisor, exponent * size));
                            }
                            raise(&mut under, &divisors, size);
                        }
                    }
                    let over = self.product(&over);
                    Fraction {
                        over: self.expand(over, limit)?,
                        under,
                    }
                }
                _ => Fraction::whole(part),
            };
            known.insert(part, fraction);
        }
        known.remove(&expr)
    }

    fn sum_of_fractions(
        &mut self,
        terms: &[Term],
        known: &FxHashMap<Expr, Fraction>,
        limit: usize,
    ) -> Option<Fraction> {
        let parts: Vec<(Rational, Fraction)> = terms
            .iter()
            .map(|t| {
                let part = known.get(&t.expr).cloned();
                let part = part.unwrap_or_else(|| Fraction::whole(t.expr));
                (t.coefficient.clone(), part)
            })
            .collect();
        let mut under: Vec<(Expr, i32)> = Vec::new();
        for &(base, exponent) in parts.iter().flat_map(|(_, part)| &part.under) {
            match under.iter_mut().find(|(other, _)| *other == base) {
                Some((_, most)) => *most = exponent.max(*most),
                None => under.push((base, exponent)),
            }
        }
        let mut over = Vec::with_capacity(parts.len());
        for (coefficient, part) in parts {
            let mut factors = vec![part.over];
            for &(base, exponent) in &under {
                let own = part.under.iter().find(|(other, _)| *other == base);
                factors.push(self.pow(base, exponent - own.map_or(0, |own| own.1)));
            }
            let product = self.product(&factors);
            over.push((coefficient, self.expand(product, limit)?));
        }
        let over = self.linear_combination(&over);
        Some(Fraction { over, under })
    }

    /// A divisor as a number times powers.
    fn divisors(&mut self, divisor: Expr) -> Option<(Rational, Vec<(Expr, i32)>)> {
        let divisor = self.take_out_common_factors(divisor);
        let (mut coefficient, core) = self.split_coefficient(divisor);
        let mut powers = Vec::new();
        for factor in self.factors_of(core) {
            let (number, base) = self.split_coefficient(factor.base);
            coefficient = &coefficient * &number.checked_pow(factor.exponent)?;
            powers.push((base, factor.exponent));
        }
        Some((coefficient, powers))
    }

    /// Reduces powers of sine or cosine in a sum of products by `cos² = 1 - sin²`, expressed in `kept`.
    /// `None` where there is nothing to reduce.
    fn by_pythagoras(&mut self, sum: Expr, kept: Function, limit: usize) -> Option<Expr> {
        let other = match kept {
            Function::Sin => Function::Cos,
            _ => Function::Sin,
        };
        let mut parts = Vec::new();
        let mut exchanged = false;
        for term in self.terms(sum) {
            let mut factors = Vec::new();
            for factor in self.factors_of(term.expr) {
                let angle = match *self.node(factor.base) {
                    Node::Function(function, angle)
                        if function == other && factor.exponent >= 2 =>
                    {
                        angle
                    }
                    _ => {
                        factors.push(self.pow(factor.base, factor.exponent));
                        continue;
                    }
                };
                exchanged = true;
                let function = self.function(kept, angle);
                let square = self.square(function);
                let square = self.sub(Self::ONE, square);
                factors.push(self.pow(square, factor.exponent / 2));
                factors.push(self.pow(factor.base, factor.exponent % 2));
            }
            parts.push((term.coefficient, self.product(&factors)));
        }
        let sum = self.linear_combination(&parts);
        self.expand(sum, limit).filter(|_| exchanged)
    }

    /// `over / Π base^exponent` with common factors cancelled.
    fn cancel(
        &mut self,
        test: &mut IdentityTest,
        mut over: Expr,
        under: &[(Expr, i32)],
        limit: usize,
    ) -> Expr {
        let mut below = Vec::with_capacity(under.len());
        for &(base, mut exponent) in under {
            while exponent > 0
                && let Some(quotient) = self.exact_quotient(test, over, base, limit)
            {
                over = quotient;
                exponent -= 1;
            }
            below.push(self.pow(base, exponent));
        }
        let below = self.product(&below);
        let over = self.take_out_common_factors(over);
        self.div(over, below)
    }

    /// `sum / divisor` if the remainder is zero, by Horner's rule in a symbol that occurs in one term of the
    /// divisor only, as a mass does in a moment of inertia.
    fn exact_quotient(
        &mut self,
        test: &mut IdentityTest,
        sum: Expr,
        divisor: Expr,
        limit: usize,
    ) -> Option<Expr> {
        let (symbol, slope, rest) = self.linear_in_a_symbol(divisor)?;
        let powers = self.by_powers(sum, symbol)?;
        let root = self.div(rest, slope);
        let root = self.neg(root);
        let mut value = Self::ZERO;
        let mut quotient = Vec::with_capacity(powers.len());
        for (exponent, &coefficient) in powers.iter().enumerate().rev() {
            let share = self.mul(value, root);
            if exponent + 1 < powers.len() {
                let power = self.pow(symbol, i32::try_from(exponent).ok()?);
                quotient.push(self.product(&[value, power]));
            }
            let next = self.add(coefficient, share);
            value = self.expand(next, limit)?;
        }
        if !test.is_zero(self, value) {
            return None;
        }
        let quotient = self.sum(&quotient);
        let quotient = self.div(quotient, slope);
        self.expand(quotient, limit)
    }

    /// `slope · symbol + rest` where the slope is one product.
    fn linear_in_a_symbol(&mut self, sum: Expr) -> Option<(Expr, Expr, Expr)> {
        let terms = self.terms(sum);
        for (place, term) in terms.iter().enumerate() {
            for factor in self.factors_of(term.expr) {
                let Some(symbol) = self.as_symbol(factor.base) else {
                    continue;
                };
                let slope = self.div(term.expr, factor.base);
                let others = terms.iter().enumerate().filter(|&(k, _)| k != place);
                let mut others = others.map(|(_, t)| t.expr).chain([slope]);
                if others.any(|e| self.mentions(e, &[symbol])) {
                    continue;
                }
                let slope = self.scale(&term.coefficient, slope);
                let whole = self.mul(slope, factor.base);
                let rest = self.sub(sum, whole);
                return Some((factor.base, slope, rest)).filter(|_| terms.len() > 1);
            }
        }
        None
    }

    /// Coefficients of the powers of a symbol, from the zeroth; `None` if the sum is not a polynomial in it.
    fn by_powers(&mut self, sum: Expr, symbol: Expr) -> Option<Vec<Expr>> {
        let id = [self.as_symbol(symbol)?];
        let mut powers: Vec<Vec<(Rational, Expr)>> = Vec::new();
        for term in self.terms(sum) {
            let factors = self.factors_of(term.expr);
            let exponent = factors.iter().find(|f| f.base == symbol);
            let exponent = exponent.map_or(0, |f| f.exponent);
            let power = self.pow(symbol, -exponent);
            let rest = self.mul(term.expr, power);
            let place = usize::try_from(exponent).ok()?;
            if self.mentions(rest, &id) {
                return None;
            }
            powers.resize_with(powers.len().max(place + 1), Vec::new);
            powers[place].push((term.coefficient, rest));
        }
        Some(powers.iter().map(|p| self.linear_combination(p)).collect())
    }
}

fn raise(under: &mut Vec<(Expr, i32)>, more: &[(Expr, i32)], size: i32) {
    for &(base, exponent) in more {
        match under.iter_mut().find(|(other, _)| *other == base) {
            Some((_, total)) => *total += exponent * size,
            None => under.push((base, exponent * size)),
        }
    }
}
