//! Divisors of the generalised velocities that can vanish outside the declared ranges.

use super::super::units::range;
use super::super::{Block, Letter, Math, Span, Writer};
use super::phrases::{listed, math, words};
use appell_codegen::mechanics::parameter_ranges;
use appell_codegen::symbolic::{Expr, Intervals, Node};

/// `They are valid where cos θ ≠ 0; the spec declares θ from -1.5 to 1.5 rad.`
pub(super) fn conditions(w: &mut Writer<'_>) -> Option<Block> {
    let divisors = divisors(w);
    if divisors.is_empty() {
        return None;
    }
    let conditions = divisors.iter().map(|&divisor| {
        let condition = [w.set(divisor), Math::Sign("≠"), Math::zero()];
        vec![math(Math::Row(condition.into()))]
    });
    let mut what = vec![words("They are valid where ")];
    what.extend(listed(conditions.collect()));
    let declared = declared(w, &divisors);
    if !declared.is_empty() {
        what.push(words("; the spec declares "));
        what.extend(listed(declared));
    }
    what.push(words("."));
    Some(Block::Sentence(what))
}

/// Divisors that have zeros.
fn divisors(w: &Writer<'_>) -> Vec<Expr> {
    let graph = &w.derivation.algebra.graph;
    let parameters = parameter_ranges(graph, w.mechanism, &w.derivation.symbols);
    let mut anywhere = Intervals::new(graph, parameters);
    let mut divisors = Vec::new();
    for part in graph.in_order(&w.derivation.velocities.rates) {
        let Node::Product(factors) = graph.node(part) else {
            continue;
        };
        for factor in factors.iter().filter(|f| f.exponent < 0) {
            if !anywhere.cannot_vanish(graph, factor.base) && !divisors.contains(&factor.base) {
                divisors.push(factor.base);
            }
        }
    }
    divisors
}

/// Declared ranges of the coordinates in the divisors.
fn declared(w: &Writer<'_>, divisors: &[Expr]) -> Vec<Vec<Span>> {
    let graph = &w.derivation.algebra.graph;
    let coordinates = w.derivation.symbols.coordinates.iter();
    let mut declared = Vec::new();
    for (&symbol, q) in coordinates.zip(&w.mechanism.coordinates) {
        let (Some(id), Some(ends)) = (graph.as_symbol(symbol), q.range) else {
            continue;
        };
        if divisors.iter().any(|&d| graph.mentions(d, &[id])) {
            let letter = Math::Letter(Letter::of(&q.label.name));
            let ends = words(&format!(" from {}", range(&q.label, ends)));
            declared.push(vec![math(letter), ends]);
        }
    }
    declared
}
