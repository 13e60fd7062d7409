//! Expression to readable formula. Definitions are substituted for names where the result stays
//! short (`dissolve`), sums are collected by velocities or angles (`collect`), quotients are kept
//! together.

use super::Math;
use super::collect::{Monomial, Term, collect, collect_turns, terms, with_compound_angles};
use super::writer::Writer;
use appell_codegen::symbolic::print::assemble;
use appell_codegen::symbolic::{Expr, Factor, Graph, Node, Rational};

/// A formula with more terms keeps the names of its intermediate quantities.
const MOST_EXPLICIT_TERMS: usize = 24;
/// Sums with more terms stay as the derivation left them.
const MOST_TERMS: usize = 120;
/// A quotient with a longer numerator is written as a factor before a sum that may be broken.
const LONGEST_NUMERATOR: usize = 72;

impl Writer<'_> {
    /// The formula of an expression, explicit where that stays readable, ordered by accelerations
    /// and velocities, with common factors before the sum.
    pub(super) fn explicit(&mut self, expr: Expr) -> Math {
        let keys = [self.accelerations.clone(), self.velocities.clone()].concat();
        self.arranged(expr, &[&keys], true)
    }

    /// The same without common factors before the sum.
    pub(super) fn expanded(&mut self, expr: Expr) -> Math {
        let keys = [self.accelerations.clone(), self.velocities.clone()].concat();
        self.arranged(expr, &[&keys], false)
    }

    /// Ordered by accelerations first and by velocities inside their coefficients.
    pub(super) fn by_acceleration(&mut self, expr: Expr) -> Math {
        let (accelerations, velocities) = (self.accelerations.clone(), self.velocities.clone());
        self.arranged(expr, &[&accelerations, &velocities], true)
    }

    fn arranged(&mut self, expr: Expr, keys: &[&[Expr]], common: bool) -> Math {
        let readable = self.readable(expr);
        let graph = self.graph();
        // Quotients by sums are kept; the rest is expanded and ordered.
        let (quotients, plain): (Vec<Term>, Vec<Term>) = terms(graph, readable)
            .into_iter()
            .partition(|(_, e)| is_quotient(graph, *e));
        let mut parts = Vec::new();
        if !plain.is_empty() {
            let rest = graph.linear_combination(&plain);
            parts.push((false, self.multiplied_out(rest, keys, common)));
        }
        for (coefficient, quotient) in quotients {
            let term = self.graph().scale(&coefficient, quotient);
            parts.push((false, self.multiplied_out(term, keys, true)));
        }
        Math::sum(parts)
    }

    fn multiplied_out(&mut self, expr: Expr, keys: &[&[Expr]], common: bool) -> Math {
        let graph = self.graph();
        let best = graph.expand(expr, MOST_TERMS).unwrap_or(expr);
        let mut best = with_compound_angles(graph, best);
        if keys.iter().all(|list| !occurs(graph, best, list)) {
            return self.constant(best);
        }
        if common {
            best = self.graph().take_out_common_factors(best);
        }
        self.present(best, keys)
    }

    /// Substitutes definitions for names, unless the sum gets too long.
    fn readable(&mut self, expr: Expr) -> Expr {
        let graph = &mut self.derivation.algebra.graph;
        let lexicon = self.setter.vocabulary();
        let Some(explicit) = self.dissolved.of(graph, expr, |name| lexicon.keeps(name)) else {
            return expr;
        };
        match graph.expand(explicit, MOST_EXPLICIT_TERMS) {
            Some(_) => explicit,
            None => expr,
        }
    }

    /// `coefficient · others · (sum) / below`, with the sum collected by the keys.
    fn present(&mut self, expr: Expr, keys: &[&[Expr]]) -> Math {
        let Some((outer, rest)) = keys.split_first() else {
            return self.constant(expr);
        };
        let graph = self.graph();
        let (coefficient, core) = graph.split_coefficient(expr);
        let factors = match graph.node(core) {
            Node::Sum(_) => {
                let groups = collect(graph, expr, outer);
                return Math::sum(self.groups(groups, outer, rest));
            }
            Node::Product(factors) => factors.to_vec(),
            _ => return self.set(expr),
        };
        let is_sum = |f: &Factor| f.exponent == 1 && matches!(graph.node(f.base), Node::Sum(_));
        let with_keys =
            |f: &Factor| is_sum(f) && keys.iter().any(|list| occurs(graph, f.base, list));
        let place = factors.iter().position(with_keys);
        let Some(place) = place.or_else(|| factors.iter().position(is_sum)) else {
            return self.set(expr);
        };
        let mut sum = factors[place].base;
        let holds_keys = keys.iter().any(|list| occurs(self.graph(), sum, list));
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (_, factor) in factors.iter().enumerate().filter(|(k, _)| *k != place) {
            let power = self.graph().pow(factor.base, factor.exponent.abs());
            if factor.exponent > 0 {
                above.push(power);
            } else {
                below.push(power);
            }
        }
        let above = self.graph().product(&above);
        let below = self.graph().product(&below);
        let mut minus = coefficient.is_negative();
        // -a (b - c) is a (c - b); accelerations keep their order.
        let graph = &self.derivation.algebra.graph;
        if minus && has_both_signs(graph, sum) && !occurs(graph, sum, &self.accelerations) {
            sum = self.graph().neg(sum);
            minus = false;
        }
        let sum = if holds_keys {
            let groups = collect(self.graph(), sum, outer);
            Math::sum(self.groups(groups, outer, rest))
        } else {
            self.constant(sum)
        };
        let product = self.quotient(&coefficient.abs(), above, sum, below, holds_keys);
        if minus {
            Math::Sum(vec![(true, product)])
        } else {
            product
        }
    }

    fn quotient(
        &mut self,
        coefficient: &Rational,
        above: Expr,
        sum: Math,
        below: Expr,
        last: bool,
    ) -> Math {
        let mut factors = |product: Expr| {
            let product = Some(product).filter(|&product| product != Graph::ONE);
            product
                .map(|product| self.set(product))
                .into_iter()
                .collect()
        };
        let (above, below): (Vec<Math>, Vec<Math>) = (factors(above), factors(below));
        let width = sum.width();
        if below.is_empty() || width <= LONGEST_NUMERATOR {
            // A factor of constants goes before the letters, a sum of motions behind them.
            let above = if last {
                [above, vec![sum]].concat()
            } else {
                [vec![sum], above].concat()
            };
            return assemble(coefficient, above, below);
        }
        let factor = assemble(coefficient, above, below);
        Math::product(vec![factor, Math::Brackets(Box::new(sum))])
    }

    fn groups(
        &mut self,
        groups: Vec<(Monomial, Expr)>,
        keys: &[Expr],
        rest: &[&[Expr]],
    ) -> Vec<(bool, Math)> {
        let mut terms = Vec::with_capacity(groups.len());
        for (monomial, coefficient) in groups {
            let graph = self.graph();
            let powers = monomial.iter();
            let powers: Vec<Expr> = powers
                .map(|&(key, exponent)| graph.pow(keys[key], exponent))
                .collect();
            let power = graph.product(&powers);
            let (minus, coefficient) = without_sign(graph, coefficient);
            let several = matches!(graph.node(coefficient), Node::Sum(t) if t.len() > 1);
            let math = if several {
                let factor = self.present(coefficient, rest);
                self.times(factor, &monomial, power)
            } else {
                let term = self.graph().mul(coefficient, power);
                self.set(term)
            };
            // A leading sign of the formula is the sign of the term.
            let (inner, math) = signed(math);
            terms.push((minus != inner, math));
        }
        plus_first(terms)
    }

    /// `factor · power`, with the sign of the factor before both.
    fn times(&mut self, factor: Math, monomial: &Monomial, power: Expr) -> Math {
        if monomial.is_empty() {
            return factor;
        }
        let power = self.set(power);
        let (minus, factor) = signed(factor);
        let product = functions_last(Math::product(vec![factor, power]));
        if minus {
            Math::Sum(vec![(true, product)])
        } else {
            product
        }
    }

    /// A sum without velocities: ordered by its sines and cosines where that shortens it, with
    /// common factors before it.
    fn constant(&mut self, expr: Expr) -> Math {
        let graph = self.graph();
        let Node::Sum(terms) = graph.node(expr) else {
            return self.set(expr);
        };
        let count = terms.len();
        let groups = collect_turns(graph, expr);
        if groups.len() > 1 && groups.len() < count {
            let mut terms = Vec::with_capacity(groups.len());
            for (power, coefficient) in groups {
                let graph = self.graph();
                let (minus, coefficient) = without_sign(graph, coefficient);
                let coefficient = graph.take_out_common_factors(coefficient);
                let term = graph.mul(coefficient, power);
                terms.push((minus, self.set(term)));
            }
            return Math::sum(plus_first(terms));
        }
        let factored = graph.take_out_common_factors(expr);
        self.set(factored)
    }
}

/// Whether a product divides by a sum or by a name.
fn is_quotient(graph: &Graph, expr: Expr) -> bool {
    let Node::Product(factors) = graph.node(expr) else {
        return false;
    };
    factors.iter().any(|f| {
        f.exponent < 0
            && matches!(
                graph.node(f.base),
                Node::Sum(_) | Node::Named(_) | Node::Solution { .. }
            )
    })
}

/// Whether one of the keys occurs in an expression, without expanding names.
fn occurs(graph: &Graph, expr: Expr, keys: &[Expr]) -> bool {
    appell_codegen::symbolic::print::visible(graph, expr)
        .iter()
        .any(|e| keys.contains(e))
}

fn has_both_signs(graph: &Graph, sum: Expr) -> bool {
    let Node::Sum(terms) = graph.node(sum) else {
        return false;
    };
    let negative = terms.iter().filter(|t| t.coefficient.is_negative()).count();
    negative > 0 && negative < terms.len()
}

/// Whether every term is negative, and the expression or its opposite.
fn without_sign(graph: &mut Graph, expr: Expr) -> (bool, Expr) {
    let is_negative = match graph.node(expr) {
        Node::Number(n) => n.is_negative(),
        Node::Sum(terms) => terms.iter().all(|t| t.coefficient.is_negative()),
        _ => false,
    };
    if is_negative {
        (true, graph.neg(expr))
    } else {
        (false, expr)
    }
}

/// The sign of a formula that is a single term, and the term.
pub(super) fn signed(math: Math) -> (bool, Math) {
    match math {
        Math::Sum(mut single) if single.len() == 1 => single.remove(0),
        math => (false, math),
    }
}

/// A sum starts with a positive term if it has one.
fn plus_first(mut terms: Vec<(bool, Math)>) -> Vec<(bool, Math)> {
    if terms.first().is_some_and(|(minus, _)| *minus)
        && let Some(place) = terms.iter().position(|(minus, _)| !minus)
    {
        let first = terms.remove(place);
        terms.insert(0, first);
    }
    terms
}

/// `(a + b) ω² tan θ`: no letter follows the argument of a function.
fn functions_last(product: Math) -> Math {
    let Math::Row(factors) = product else {
        return product;
    };
    let (functions, others): (Vec<Math>, Vec<Math>) = factors
        .into_iter()
        .partition(|f| matches!(f, Math::Call(..)));
    Math::Row([others, functions].concat())
}
