//! Common factors of a sum.

use super::Graph;
use super::node::{Expr, Factor, Node};

impl Graph {
    /// Takes the factors that all terms of a sum share in front of it: `a b + a c = a (b + c)`.
    /// Anything but such a sum stays as it is.
    pub fn take_out_common_factors(&mut self, expr: Expr) -> Expr {
        let Node::Sum(terms) = self.node(expr) else { return expr };
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
        let powers: Vec<Expr> = shared.iter().map(|f| self.pow(f.base, f.exponent)).collect();
        let common = self.product(&powers);
        let rest: Vec<_> =
            terms.iter().map(|t| (t.coefficient.clone(), self.div(t.expr, common))).collect();
        let rest = self.linear_combination(&rest);
        self.mul(common, rest)
    }

    /// Numerator and denominator of a product; the numeric coefficient goes with the numerator.
    pub fn split_fraction(&mut self, expr: Expr) -> (Expr, Expr) {
        let (coefficient, rest) = self.split_coefficient(expr);
        let (mut over, mut under) = (vec![self.number(coefficient)], Vec::new());
        for factor in self.factors_of(rest) {
            let power = self.pow(factor.base, factor.exponent.abs());
            if factor.exponent > 0 { over.push(power) } else { under.push(power) }
        }
        (self.product(&over), self.product(&under))
    }

    fn factors_of(&self, expr: Expr) -> Vec<Factor> {
        match self.node(expr) {
            Node::Product(factors) => factors.to_vec(),
            Node::Number(_) => Vec::new(),
            _ => vec![Factor { base: expr, exponent: 1 }],
        }
    }
}
