//! Sines and cosines of inverse trigonometric functions: `cos(atan x) = 1/√(1 + x²)`.
//!
//! Sine and cosine of a slope angle are algebraic. In this form the identities of the slope hold, such as a
//! tangent having no component along the normal.

use super::node::{Factor, Function, Node};
use super::{Expr, Graph, Intervals, Rational};

/// Highest multiple of an angle that is expanded.
const MOST_TURNS: i64 = 4;

impl Graph {
    /// Cosine and sine of an angle that contains an inverse function.
    pub(super) fn cos_sin_of_inverse(&mut self, angle: Expr) -> Option<[Expr; 2]> {
        if let Some(turn) = self.cos_sin_of_atom(angle) {
            return Some(turn);
        }
        let Node::Sum(terms) = self.node(angle) else {
            return None;
        };
        let terms = terms.clone();
        let (place, times, turn) = terms.iter().enumerate().find_map(|(place, term)| {
            let times = term.coefficient.as_integer()?;
            let turn = (times.abs() <= MOST_TURNS).then(|| self.cos_sin_of_atom(term.expr));
            Some((place, times, turn??))
        })?;
        let mut rest: Vec<(Rational, Expr)> = Vec::with_capacity(terms.len());
        rest.extend(
            terms
                .iter()
                .map(|term| (term.coefficient.clone(), term.expr)),
        );
        rest.remove(place);
        let rest = self.linear_combination(&rest);
        let mut sum = [self.cos(rest), self.sin(rest)];
        let [cos, sin] = turn;
        let turn = [cos, if times < 0 { self.neg(sin) } else { sin }];
        for _ in 0..times.abs() {
            sum = self.turned(sum, turn);
        }
        Some(sum)
    }

    /// Cosine and sine of a sum of two angles.
    fn turned(&mut self, [cos, sin]: [Expr; 2], [other_cos, other_sin]: [Expr; 2]) -> [Expr; 2] {
        let both = [self.mul(cos, other_cos), self.mul(sin, other_sin)];
        let mixed = [self.mul(sin, other_cos), self.mul(cos, other_sin)];
        [self.sub(both[0], both[1]), self.sum(&mixed)]
    }

    fn cos_sin_of_atom(&mut self, angle: Expr) -> Option<[Expr; 2]> {
        match *self.node(angle) {
            Node::Named(id) => self.cos_sin_of_atom(self.definition(id).value),
            Node::Function(Function::Atan, x) => {
                let square = self.square(x);
                let norm = self.add(Self::ONE, square);
                let root = self.sqrt(norm);
                Some([self.pow(root, -1), self.div(x, root)])
            }
            Node::Function(Function::Asin, x) => Some([self.other_leg(x), x]),
            Node::Function(Function::Acos, x) => Some([x, self.other_leg(x)]),
            Node::Atan2(y, x) => {
                let squares = [self.square(x), self.square(y)];
                let norm = self.sum(&squares);
                // The angle of the origin is zero and has no such form.
                if !self.is_evidently_positive(norm) {
                    return None;
                }
                let root = self.sqrt(norm);
                Some([self.div(x, root), self.div(y, root)])
            }
            _ => None,
        }
    }

    /// `√(1 − x²)`, with the roots in the denominator of `x` factored: `x = a/√b` gives `√(b − a²)/√b`.
    fn other_leg(&mut self, x: Expr) -> Expr {
        let (_, rest) = self.split_coefficient(x);
        let factors = match self.node(rest) {
            Node::Product(factors) => factors.to_vec(),
            _ => Vec::new(),
        };
        let is_root = |f: &&Factor| matches!(self.node(f.base), Node::Function(Function::Sqrt, _));
        let divisors: Vec<Factor> = factors
            .iter()
            .filter(|f| f.exponent < 0 && is_root(f))
            .cloned()
            .collect();
        let under: Vec<Expr> = divisors
            .iter()
            .map(|f| self.pow(f.base, -f.exponent))
            .collect();
        let under = self.product(&under);
        let over = self.mul(x, under);
        let [over, square] = [self.square(over), self.square(under)];
        let leg = self.sub(square, over);
        let leg = self.sqrt(leg);
        self.div(leg, under)
    }

    /// Whether an expression is positive for all values of its symbols.
    fn is_evidently_positive(&self, expr: Expr) -> bool {
        let mut intervals = Intervals::new(self, Vec::new());
        intervals.of(self, expr).lo >= 0.0 && intervals.cannot_vanish(self, expr)
    }
}
