//! Names for unnamed intermediate values: a value equal to one of these hints is displayed under its name.

use rustc_hash::FxHashSet;

use appell_spec::mechanism::Mechanism;

use super::Derivation;
use crate::program::{Arguments, Hint, Names, Term};
use crate::symbolic::SymbolId;

const AXES: [&str; 3] = ["x", "y", "z"];

impl Derivation {
    /// Positions of points relative to their reference points, their derivatives with respect to coordinates,
    /// and partial velocities of bodies, with a glossary.
    pub(super) fn hints(
        &mut self,
        mechanism: &Mechanism,
        arguments: &Arguments,
    ) -> (Vec<Hint>, Vec<Term>) {
        let mut hints = Vec::new();
        let mut terms = Vec::new();
        for (point, placed) in mechanism.points.entries() {
            let Some(from) = placed.from else {
                continue;
            };
            let offset = self.kinematics.offset(point);
            let along = &mechanism.frames[offset.frame].name;
            let (from, to) = (&mechanism.points[from].name, &placed.name);
            for (axis, value) in AXES.iter().zip(offset.v) {
                let [there, back] = [
                    format!("p_{from}_{to}_{axis}"),
                    format!("p_{to}_{from}_{axis}"),
                ];
                for (q, &by) in mechanism.coordinates.iter().zip(&self.symbols.coordinates) {
                    let by_q = |name: &str| format!("d_{name}_d_{}", q.label.name);
                    hints.push(Hint {
                        value: self.algebra.derivative(value, by),
                        name: by_q(&there),
                        opposite: Some(by_q(&back)),
                    });
                }
                hints.push(Hint {
                    value,
                    name: there,
                    opposite: Some(back),
                });
            }
            for (from, to) in [(from, to), (to, from)] {
                let symbol = format!("p_{from}_{to}");
                let meaning = format!("position of `{to}` from `{from}`, along `{along}`.");
                terms.push((
                    format!("d_{symbol}"),
                    Names::Any,
                    format!("derivatives of `{symbol}`, the {meaning}"),
                ));
                terms.push((symbol, Names::Axes, meaning));
            }
        }
        for body in self.bodies.clone() {
            let (name, point) = (&body.name, &body.centre.point);
            let turning = body.rotation.iter().map(|rotation| {
                let meaning = format!("partial angular velocities of `{name}`.");
                (format!("w_{name}"), meaning, &rotation.partial)
            });
            let meaning = format!("partial velocities of `{point}`.");
            let centre = (format!("v_{point}"), meaning, &body.centre.partial);
            for (symbol, meaning, partial) in turning.chain([centre]) {
                for (speed, &value) in mechanism.pseudo_velocities.iter().zip(partial) {
                    let by = &speed.label.name;
                    let named = AXES.iter().zip(value);
                    hints.extend(named.map(|(x, value)| Hint {
                        value,
                        name: format!("d_{symbol}_{x}_d_{by}"),
                        opposite: None,
                    }));
                }
                terms.push((format!("d_{symbol}"), Names::Any, meaning));
            }
        }
        let graph = &self.algebra.graph;
        let known = known(arguments);
        hints.retain(|hint| {
            let symbols = graph.in_order(&[hint.value]).into_iter();
            let mut symbols = symbols.filter_map(|part| graph.as_symbol(part));
            symbols.all(|symbol| known.contains(&symbol))
        });
        let terms = terms.into_iter().map(|(symbol, names, meaning)| Term {
            symbol,
            names,
            meaning,
        });
        (hints, terms.collect())
    }
}

/// The symbols available in emitted functions.
fn known(arguments: &Arguments) -> FxHashSet<SymbolId> {
    let lists = [
        arguments.states.as_slice(),
        &arguments.inputs,
        &arguments.parameters,
        &[arguments.time],
    ];
    let all = lists.concat().into_iter();
    all.chain(arguments.pi).collect()
}
