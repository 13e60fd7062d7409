//! Kinematic quantities in expressions of a spec, such as the speed of a point, as functions of the motion.

use appell_spec::expr::Motion;
use appell_spec::mechanism::ORIGIN;

use super::algebra::Algebra;
use super::kinematics::Kinematics;
use super::symbols::Symbols;
use crate::symbolic::{Expr, Substitution};

/// Values for the symbols of kinematic quantities in a motion.
pub fn motions(algebra: &mut Algebra, symbols: &Symbols, kinematics: &Kinematics) -> Substitution {
    let motions = symbols.motions.iter();
    let values = motions.map(|&(motion, symbol)| (symbol, value(algebra, kinematics, motion)));
    let values: Vec<(Expr, Expr)> = values.collect();
    Substitution::of_parts(&algebra.graph, &values)
}

/// An expression with its kinematic quantities substituted; `None` if it divides by the number zero.
pub fn told(
    algebra: &mut Algebra,
    symbols: &Symbols,
    kinematics: &Kinematics,
    expr: Expr,
) -> Option<Expr> {
    let mut values = Vec::new();
    for &(motion, symbol) in &symbols.motions {
        let known = algebra.graph.as_symbol(symbol);
        if known.is_some_and(|known| algebra.graph.mentions(expr, &[known])) {
            values.push((symbol, value(algebra, kinematics, motion)));
        }
    }
    Substitution::of_parts(&algebra.graph, &values).apply(&mut algebra.graph, expr)
}

fn value(algebra: &mut Algebra, kinematics: &Kinematics, motion: Motion) -> Expr {
    let frames = &kinematics.frames;
    let graph = &mut algebra.graph;
    let value = match motion {
        Motion::Position(point, axis, frame) => {
            kinematics.between(graph, ORIGIN, point, frame)[axis.index()]
        }
        Motion::Velocity(point, axis, frame) => {
            kinematics.velocity_in(graph, point, frame)[axis.index()]
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
