//! Names for what the derivation computes without naming it: where a value on the way is one of these,
//! a reader meets it under its name.

use rustc_hash::FxHashSet;

use appell_spec::mechanism::Mechanism;

use super::Derivation;
use crate::program::{Arguments, Names, Term};
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Node};

const AXES: [&str; 3] = ["x", "y", "z"];

impl Derivation {
    /// Positions of points from the points that they are placed from, their derivatives by the
    /// coordinates, and partial velocities of frames and points, each named; and what the names mean.
    pub(super) fn hints(
        &mut self,
        mechanism: &Mechanism,
        arguments: &Arguments,
    ) -> (Vec<Expr>, Vec<Term>) {
        let mut hints = Vec::new();
        let mut terms = Vec::new();
        let mut add = |derivation: &mut Self, symbol: &str, value: Vec3, meaning: String| {
            let vector = AXES.iter().zip(value);
            let named = vector.map(|(axis, value)| (format!("{symbol}_{axis}"), value));
            hints.extend(named.clone());
            for (name, value) in named {
                for q in 0..mechanism.coordinates.len() {
                    let by = derivation.symbols.coordinates[q];
                    let slope = derivation.algebra.derivative(value, by);
                    let q = &mechanism.coordinates[q].label.name;
                    hints.push((format!("d_{name}_d_{q}"), slope));
                }
            }
            let derivatives = format!("derivatives of `{symbol}`.");
            terms.extend([
                (symbol.to_owned(), Names::Axes, meaning),
                (format!("d_{symbol}"), Names::Any, derivatives),
            ]);
        };
        for (point, placed) in mechanism.points.iter().enumerate() {
            let offset = self.kinematics.offset(point);
            let (name, along) = (&placed.name, &mechanism.frames[offset.frame].name);
            let meaning = format!("position of `{name}` from where it is placed, along `{along}`.");
            add(self, &format!("p_{name}"), offset.v, meaning);
        }
        for body in self.bodies.clone() {
            let rotation = body.rotation.iter();
            let partial = rotation.map(|turning| (format!("w_{}", body.name), &turning.partial));
            let centre = (format!("v_{}", body.centre.point), &body.centre.partial);
            for (symbol, partial) in partial.chain([centre]) {
                for (speed, &value) in mechanism.pseudo_velocities.iter().zip(partial) {
                    let by = &speed.label.name;
                    let named = AXES.iter().zip(value);
                    hints.extend(named.map(|(x, v)| (format!("d_{symbol}_{x}_d_{by}"), v)));
                }
                let derivatives = format!("partial velocities: derivatives of `{symbol}`.");
                terms.push((format!("d_{symbol}"), Names::Any, derivatives));
            }
        }
        let graph = &mut self.algebra.graph;
        let known = known(arguments);
        hints.retain(|&(_, value)| {
            graph.in_order(&[value]).into_iter().all(|part| {
                graph.as_symbol(part).is_none_or(|symbol| known.contains(&symbol))
            }) && matches!(graph.node(value), Node::Sum(_) | Node::Product(_))
        });
        let hints = hints.into_iter();
        let hints = hints.map(|(name, value)| graph.name(&name, value)).collect();
        let terms = terms.into_iter().map(|(symbol, names, meaning)| Term {
            symbol,
            names,
            meaning,
        });
        (hints, terms.collect())
    }
}

/// The symbols that emitted functions know.
fn known(arguments: &Arguments) -> FxHashSet<crate::symbolic::SymbolId> {
    let lists = [
        arguments.states.as_slice(),
        &arguments.inputs,
        &arguments.parameters,
        &[arguments.time],
    ];
    let all = lists.concat().into_iter();
    all.chain(arguments.pi).collect()
}
