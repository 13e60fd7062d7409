//! Coordinates that position constraints give explicitly, such as the tilt of a road by its slope.
//!
//! Quantities that vanish only on the constraint manifold, such as the normal velocity of a contact on a
//! surface, are recognised by substituting the formula for the coordinate. Only contacts use this.

use appell_spec::mechanism::{ConstraintKind, CoordinateId};

use super::algebra::Algebra;
use super::expressions::Setting;
use crate::symbolic::{Expr, Function, Graph, Substitution};

/// Coordinates with their formulas, at most one for each constraint.
pub(crate) fn given_coordinates(algebra: &mut Algebra, setting: Setting<'_>) -> Vec<(Expr, Expr)> {
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let mut constraints = mechanism.constraints.iter();
    if !constraints.any(|constraint| matches!(constraint.kind, ConstraintKind::Rolling { .. })) {
        return Vec::new();
    }
    let mut given: Vec<(Expr, Expr)> = Vec::new();
    for constraint in &mechanism.constraints {
        let ConstraintKind::Position {
            zero, dependent, ..
        } = &constraint.kind
        else {
            continue;
        };
        let Ok(residual) = setting.lower(&mut algebra.graph, zero) else {
            continue;
        };
        let candidates = match dependent.map(CoordinateId::index) {
            Some(named) => &symbols.coordinates[named..=named],
            None => &symbols.coordinates,
        };
        let free = |q: &&Expr| !given.iter().any(|(known, _)| known == *q);
        let mut free = candidates.iter().filter(free);
        let found = free.find_map(|&q| Some((q, solved_for(algebra, residual, q)?)));
        given.extend(found);
    }
    given
}

/// The value of a coordinate where `residual` is zero: of `k q + r`, or of an angle by `k sin q + r cos q` or
/// `tan q`.
fn solved_for(algebra: &mut Algebra, residual: Expr, q: Expr) -> Option<Expr> {
    let symbol = algebra.graph.as_symbol(q)?;
    let slope = algebra.derivative(residual, q);
    if slope == Graph::ZERO {
        return None;
    }
    let mut at_zero = Substitution::by_zero(&algebra.graph, &[q]);
    if algebra.graph.as_number(slope).is_some() {
        let rest = at_zero.apply(&mut algebra.graph, residual)?;
        let value = algebra.graph.div(rest, slope);
        return Some(algebra.graph.neg(value));
    }
    let cos = algebra.graph.cos(q);
    let without_tangent = algebra.graph.mul(residual, cos);
    for turned in [residual, without_tangent] {
        let slope = algebra.derivative(turned, q);
        let second = algebra.derivative(slope, q);
        let sum = algebra.graph.add(second, turned);
        if !algebra.test.is_zero(&algebra.graph, sum) {
            continue;
        }
        let over = at_zero.apply(&mut algebra.graph, turned)?;
        let under = at_zero.apply(&mut algebra.graph, slope)?;
        if algebra.test.is_zero(&algebra.graph, under) || algebra.graph.mentions(under, &[symbol]) {
            return None;
        }
        let tangent = algebra.graph.div(over, under);
        let angle = algebra.graph.function(Function::Atan, tangent);
        return Some(algebra.graph.neg(angle));
    }
    None
}
