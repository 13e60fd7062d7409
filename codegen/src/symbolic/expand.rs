//! Expansion of products, and operation counts.

use rustc_hash::FxHashMap;

use super::node::{Expr, Factor, Node, Term};
use super::{Graph, Rational};

impl Graph {
    /// Expands products and positive powers of sums. Names, functions and denominators are left unchanged.
    /// `None` where a sum would have more than `limit` terms.
    pub fn expand(&mut self, expr: Expr, limit: usize) -> Option<Expr> {
        if self.is_expanded(expr) {
            return Some(expr);
        }
        let expanded = self.expanded(expr, limit);
        if let Err(too_long) = expanded {
            // Also recorded for `expr`, so that expressions containing it fail at once.
            for part in [too_long, expr] {
                let most = self.too_long.entry(part).or_default();
                *most = limit.max(*most);
            }
        }
        expanded.ok()
    }

    /// An expanded expression, or the subexpression that has more terms than `limit`.
    fn expanded(&mut self, expr: Expr, limit: usize) -> Result<Expr, Expr> {
        let mut known: FxHashMap<Expr, Expr> = FxHashMap::default();
        let mut stack = vec![expr];
        while let Some(&top) = stack.last() {
            if self.too_long.get(&top).is_some_and(|&most| limit <= most) {
                return Err(top);
            }
            if known.contains_key(&top) {
                stack.pop();
                continue;
            }
            let height = stack.len();
            match self.node(top) {
                Node::Sum(terms) => {
                    stack.extend(
                        terms
                            .iter()
                            .map(|t| t.expr)
                            .filter(|e| !known.contains_key(e)),
                    );
                }
                Node::Product(factors) => {
                    let sums = factors
                        .iter()
                        .filter(|f| self.can_be_multiplied_out(f))
                        .map(|f| f.base);
                    stack.extend(sums.filter(|e| !known.contains_key(e)));
                }
                _ => {}
            }
            if stack.len() == height {
                let expanded = match self.node(top).clone() {
                    Node::Sum(terms) => {
                        let parts: Vec<(Rational, Expr)> = terms
                            .iter()
                            .map(|t| (t.coefficient.clone(), known[&t.expr]))
                            .collect();
                        self.linear_combination(&parts)
                    }
                    Node::Product(factors) => {
                        let product = self.multiply_out(&factors, &known, limit);
                        product.ok_or(top)?
                    }
                    _ => top,
                };
                if self.terms(expanded).len() > limit {
                    return Err(top);
                }
                known.insert(top, expanded);
                stack.pop();
            }
        }
        Ok(known[&expr])
    }

    /// Whether no term is a product of sums.
    fn is_expanded(&self, expr: Expr) -> bool {
        let flat = |e: Expr| match self.node(e) {
            Node::Product(factors) => !factors.iter().any(|f| self.can_be_multiplied_out(f)),
            _ => true,
        };
        match self.node(expr) {
            Node::Sum(terms) => terms.iter().all(|t| flat(t.expr)),
            _ => flat(expr),
        }
    }

    fn can_be_multiplied_out(&self, factor: &Factor) -> bool {
        factor.exponent > 0 && matches!(self.node(factor.base), Node::Sum(_))
    }

    /// Product of expanded factors.
    fn multiply_out(
        &mut self,
        factors: &[Factor],
        known: &FxHashMap<Expr, Expr>,
        limit: usize,
    ) -> Option<Expr> {
        let (sums, others): (Vec<&Factor>, Vec<&Factor>) =
            factors.iter().partition(|f| self.can_be_multiplied_out(f));
        let powers: Vec<Expr> = others
            .iter()
            .map(|f| self.pow(f.base, f.exponent))
            .collect();
        let mut product = self.product(&powers);
        for factor in sums {
            let sum = known[&factor.base];
            for _ in 0..factor.exponent {
                let (left, right) = (self.terms(product), self.terms(sum));
                // A bound on the work: like terms may still be combined.
                if left.len().saturating_mul(right.len()) > limit.saturating_mul(4) {
                    return None;
                }
                let mut parts = Vec::with_capacity(left.len() * right.len());
                for a in &left {
                    for b in &right {
                        parts.push((&a.coefficient * &b.coefficient, self.mul(a.expr, b.expr)));
                    }
                }
                product = self.linear_combination(&parts);
                if self.terms(product).len() > limit {
                    return None;
                }
            }
        }
        Some(product)
    }

    /// An expanded expression in which the square of a symbol is replaced by `value`. `None` where a sum
    /// would have more than `limit` terms.
    pub fn with_square(
        &mut self,
        expr: Expr,
        symbol: Expr,
        value: Expr,
        limit: usize,
    ) -> Option<Expr> {
        let expanded = self.expand(expr, limit)?;
        let mut parts = Vec::new();
        for term in self.terms(expanded) {
            let factors = match self.node(term.expr) {
                Node::Product(factors) => factors.to_vec(),
                _ => Vec::new(),
            };
            let mut product = term.expr;
            if let Some(factor) = factors.iter().find(|f| f.base == symbol && f.exponent > 1) {
                let squares = factor.exponent / 2;
                let taken = self.pow(symbol, -2 * squares);
                let put = self.pow(value, squares);
                product = self.product(&[product, taken, put]);
            }
            parts.push((term.coefficient, product));
        }
        let replaced = self.linear_combination(&parts);
        self.expand(replaced, limit)
    }

    /// The terms of an expression as a sum.
    pub(super) fn terms(&self, expr: Expr) -> Vec<Term> {
        match self.node(expr) {
            Node::Sum(terms) => terms.to_vec(),
            Node::Number(n) if n.is_zero() => Vec::new(),
            Node::Number(n) => vec![Term {
                expr: Self::ONE,
                coefficient: n.clone(),
            }],
            _ => vec![Term {
                expr,
                coefficient: Rational::ONE,
            }],
        }
    }

    /// The one of two expressions with fewer operations, the first if they have equally many.
    pub fn shorter(&self, a: Expr, b: Expr) -> Expr {
        if a != b && self.operations(&[b]) < self.operations(&[a]) {
            b
        } else {
            a
        }
    }
}

/// Operations of a node without its operands; the linear system of a solution is counted separately.
pub(super) fn operations_of(node: &Node) -> u32 {
    let count = match node {
        Node::Number(_) | Node::Symbol(_) | Node::Named(_) | Node::Solution { .. } => 0,
        Node::Sum(terms) => {
            let scaled = terms
                .iter()
                .filter(|t| t.expr != Graph::ONE && !is_unit(&t.coefficient));
            terms.len() - 1 + scaled.count()
        }
        Node::Product(factors) => {
            let over = factors.iter().filter(|f| f.exponent > 0).count();
            let under = factors.len() - over;
            let powers: usize = factors.iter().map(|f| power_cost(f.exponent)).sum();
            let joins = over.saturating_sub(1) + under.saturating_sub(1);
            powers + joins + usize::from(under > 0)
        }
        Node::Function(..) | Node::Atan2(..) | Node::Power(..) | Node::Choice { .. } => 1,
    };
    u32::try_from(count).unwrap_or(u32::MAX)
}

fn is_unit(coefficient: &Rational) -> bool {
    coefficient.is_one() || *coefficient == Rational::MINUS_ONE
}

/// Multiplications of an integer power by repeated squaring.
fn power_cost(exponent: i32) -> usize {
    let n = exponent.unsigned_abs().max(1);
    (n.ilog2() + n.count_ones() - 1) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_long_is_not_multiplied_out_again_in_what_contains_it() {
        let mut graph = Graph::new();
        let symbols: Vec<Expr> = (0..8).map(|i| graph.symbol(&format!("a{i}"))).collect();
        let mut product = Graph::ONE;
        for pair in symbols.chunks(2) {
            let sum = graph.add(pair[0], pair[1]);
            product = graph.mul(product, sum);
        }
        let whole = graph.add(product, symbols[0]);
        assert_eq!(graph.expand(whole, 10), None);
        let beyond = graph.mul(whole, symbols[1]);
        assert_eq!(graph.expanded(beyond, 10), Err(whole));
        // A larger limit may succeed later.
        let expanded = graph.expand(whole, 100).map(|e| graph.terms(e).len());
        assert_eq!(expanded, Some(17));
    }
}
