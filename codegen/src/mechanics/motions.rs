//! Kinematic quantities in expressions of a spec, such as the speed of a point, as functions of the motion.

use appell_spec::expr::Motion;
use appell_spec::mechanism::Mechanism;

use super::algebra::Algebra;
use super::kinematics::Kinematics;
use super::symbols::Symbols;
use crate::symbolic::{Expr, Substitution};

/// Values for the symbols of kinematic quantities in a motion; `None` if there are none.
pub fn motions(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    symbols: &Symbols,
    kinematics: &Kinematics,
) -> Option<Substitution> {
    if symbols.motions.is_empty() {
        return None;
    }
    let mut values = Vec::with_capacity(symbols.motions.len());
    for &(motion, symbol) in &symbols.motions {
        values.push((symbol, value(algebra, mechanism, kinematics, motion)));
    }
    Some(Substitution::of_parts(&algebra.graph, &values))
}

/// An expression with its kinematic quantities substituted; `None` if it divides by the number zero.
pub fn told(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    symbols: &Symbols,
    kinematics: &Kinematics,
    expr: Expr,
) -> Option<Expr> {
    let mut values = Vec::new();
    for &(motion, symbol) in &symbols.motions {
        let known = algebra.graph.as_symbol(symbol);
        if known.is_some_and(|known| algebra.graph.mentions(expr, &[known])) {
            values.push((symbol, value(algebra, mechanism, kinematics, motion)));
        }
    }
    Substitution::of_parts(&algebra.graph, &values).apply(&mut algebra.graph, expr)
}

fn value(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    kinematics: &Kinematics,
    motion: Motion,
) -> Expr {
    let frames = &kinematics.frames;
    let graph = &mut algebra.graph;
    let value = match motion {
        Motion::Position(point, axis, frame) => {
            let origin = appell_spec::mechanism::ORIGIN;
            kinematics.between(graph, mechanism, origin, point, frame)[axis.index()]
        }
        Motion::Velocity(point, axis, frame) => {
            frames.express(graph, kinematics.velocity(point), frame)[axis.index()]
        }
        Motion::Speed(point) => {
            let v = kinematics.velocity(point).v;
            let square = graph.dot(v, v);
            graph.sqrt(square)
        }
        Motion::AngularVelocity(of, axis, frame) => {
            frames.angular_velocity_in(graph, of, frame)[axis.index()]
        }
    };
    algebra.shortest(value)
}
