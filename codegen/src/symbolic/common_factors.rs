//! Common factors of all terms of a sum: `a b + a c = a (b + c)`.

use super::Graph;
use super::node::{Expr, Factor, Node};

impl Graph {
    /// Factors a sum by the factors common to all its terms: `a b + a c = a (b + c)`. Other expressions are
    /// returned unchanged.
    pub fn take_out_common_factors(&mut self, expr: Expr) -> Expr {
        let Node::Sum(terms) = self.node(expr) else {
            return expr;
        };
        if terms.len() < 2 {
            return expr;
        }
        let terms = terms.clone();
        let mut shared = self.factors_of(terms[0].expr);
        for term in &terms[1..] {
            let here = self.factors_of(term.expr);
            shared.retain_mut(|factor| match here.iter().find(|f| f.base == factor.base) {
                // The exponent nearest to zero, where both have the same sign.
                Some(other) if other.exponent.signum() == factor.exponent.signum() => {
                    if other.exponent.abs() < factor.exponent.abs() {
                        factor.exponent = other.exponent;
                    }
                    true
                }
                _ => false,
            });
        }
        if shared.is_empty() {
            return expr;
        }
        let powers: Vec<Expr> = shared
            .iter()
            .map(|f| self.pow(f.base, f.exponent))
            .collect();
        let common = self.product(&powers);
        let rest: Vec<_> = terms
            .iter()
            .map(|t| (t.coefficient.clone(), self.div(t.expr, common)))
            .collect();
        let rest = self.linear_combination(&rest);
        self.mul(common, rest)
    }

    /// Nests a sum: the factor common to most terms is extracted from these, and both parts are nested
    /// recursively. `a x + b x + c y = x (a + b) + c y`.
    pub fn nest(&mut self, expr: Expr) -> Expr {
        let Node::Sum(terms) = self.node(expr) else {
            return expr;
        };
        if terms.len() < 2 {
            return expr;
        }
        let terms = terms.clone();
        let mut shared_by: Vec<(Expr, usize)> = Vec::new();
        for term in &terms {
            for factor in self.factors_of(term.expr).iter().filter(|f| f.exponent > 0) {
                match shared_by.iter_mut().find(|(base, _)| *base == factor.base) {
                    Some((_, count)) => *count += 1,
                    None => shared_by.push((factor.base, 1)),
                }
            }
        }
        let most = shared_by.iter().max_by_key(|&&(base, count)| (count, base));
        let Some(&(base, count)) = most.filter(|&&(_, count)| count >= 2) else {
            return expr;
        };
        let holds = |graph: &Self, e: Expr| {
            graph
                .factors_of(e)
                .iter()
                .any(|f| f.base == base && f.exponent > 0)
        };
        let (mut inside, mut outside) = (Vec::with_capacity(count), Vec::new());
        for term in &terms {
            if holds(self, term.expr) {
                inside.push((term.coefficient.clone(), self.div(term.expr, base)));
            } else {
                outside.push((term.coefficient.clone(), term.expr));
            }
        }
        let (inside, outside) = (
            self.linear_combination(&inside),
            self.linear_combination(&outside),
        );
        let (inside, outside) = (self.nest(inside), self.nest(outside));
        let product = self.mul(base, inside);
        self.add(product, outside)
    }

    /// `dividend = quotient · divisor + rest` for sums of products, as far as the dividend contains complete
    /// multiples of the divisor.
    pub fn divide_out(&mut self, dividend: Expr, divisor: Expr) -> (Expr, Expr) {
        let (Node::Sum(parts), Node::Sum(pattern)) = (self.node(dividend), self.node(divisor))
        else {
            return (Self::ZERO, dividend);
        };
        let (candidates, pattern) = (parts.clone(), pattern.clone());
        if pattern.len() < 2 {
            return (Self::ZERO, dividend);
        }
        let (mut quotient, mut rest) = (Self::ZERO, dividend);
        for candidate in &candidates {
            let Node::Sum(left) = self.node(rest) else {
                break;
            };
            let left = left.clone();
            let find = |e: Expr| left.iter().find(|t| t.expr == e);
            let ratio = self.div(candidate.expr, pattern[0].expr);
            if self.factors_of(ratio).iter().any(|f| f.exponent < 0) {
                continue;
            }
            let Some(first) = find(candidate.expr) else {
                continue;
            };
            let multiple = &first.coefficient * &pattern[0].coefficient.recip();
            let whole = pattern.iter().all(|term| {
                let expected = self.mul(ratio, term.expr);
                find(expected).is_some_and(|t| t.coefficient == &multiple * &term.coefficient)
            });
            if whole {
                let share = self.scale(&multiple, ratio);
                quotient = self.add(quotient, share);
                let terms: Vec<_> = pattern
                    .iter()
                    .map(|t| (-&(&multiple * &t.coefficient), self.mul(ratio, t.expr)))
                    .collect();
                let minus = self.linear_combination(&terms);
                rest = self.add(rest, minus);
            }
        }
        (quotient, rest)
    }

    /// Numerator and denominator of a product; the numeric coefficient belongs to the numerator.
    pub fn split_fraction(&mut self, expr: Expr) -> (Expr, Expr) {
        let (coefficient, rest) = self.split_coefficient(expr);
        let (mut over, mut under) = (vec![self.number(coefficient)], Vec::new());
        for factor in self.factors_of(rest) {
            let power = self.pow(factor.base, factor.exponent.abs());
            if factor.exponent > 0 {
                over.push(power);
            } else {
                under.push(power);
            }
        }
        (self.product(&over), self.product(&under))
    }

    pub(super) fn factors_of(&self, expr: Expr) -> Vec<Factor> {
        match self.node(expr) {
            Node::Product(factors) => factors.to_vec(),
            Node::Number(_) => Vec::new(),
            _ => vec![Factor {
                base: expr,
                exponent: 1,
            }],
        }
    }
}
