//! Passive elements that supply energy: a sign error.

use appell_spec::Code;
use appell_spec::expr::Expr as Spec;
use appell_spec::mechanism::{LoadId, LoadKind};

use super::bench::{Audit, Bench};
use crate::mechanics::finding::{Finding, Item};
use crate::mechanics::symbols::ids;
use crate::symbolic::{Expr, Graph, Substitution};

pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    for (index, load) in bench.mechanism.loads.entries() {
        let name = &load.name;
        let negative = |bench: &mut Bench, coefficient| is_negative(bench, coefficient);
        let (message, help) = match &load.kind {
            LoadKind::SpringDamper {
                damping: Some(damping),
                ..
            } if negative(bench, damping) => (
                format!("the damping of `{name}` is negative: it drives the motion"),
                "the sign of a damper is built in; write a positive coefficient",
            ),
            LoadKind::SpringDamper {
                spring: Some(spring),
                ..
            } if negative(bench, &spring.stiffness) => (
                format!(
                    "the stiffness of `{name}` is negative: it pushes away from its rest position"
                ),
                "the sign of a spring is built in; write a positive stiffness",
            ),
            LoadKind::Gravity { acceleration, .. } if negative(bench, acceleration) => (
                format!("the acceleration of `{name}` is negative: bodies fall upwards"),
                "write a positive acceleration; `down` gives the direction",
            ),
            LoadKind::Force { .. } | LoadKind::Torque { .. } | LoadKind::Generalized { .. }
                if drives(bench, index) =>
            {
                (
                    format!(
                        "`{name}` adds energy at every velocity: friction acts against the \
                         velocity, with a minus sign"
                    ),
                    "reverse its sign, or use a load of kind `damper`",
                )
            }
            LoadKind::SpringDamper { .. }
            | LoadKind::Gravity { .. }
            | LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Generalized { .. } => continue,
        };
        told.warnings.push(Finding {
            code: Code::EnergySource,
            message,
            item: Item::Load(index),
            help: help.to_owned(),
        });
    }
}

fn is_negative(bench: &mut Bench, coefficient: &Spec) -> bool {
    let setting = bench.setting();
    let graph = &mut bench.algebra.graph;
    setting
        .lower(graph, coefficient)
        .is_ok_and(|coefficient| bench.declared.of(graph, coefficient).hi < 0.0)
}

/// Whether a load depends on the state only, and its power is even in every velocity and never negative:
/// friction with the wrong sign.
fn drives(bench: &mut Bench, load: LoadId) -> bool {
    let symbols = &bench.derivation.symbols;
    let load = &bench.derivation.loads[load.index()];
    let graph = &mut bench.algebra.graph;
    let mut outside = symbols.inputs.clone();
    outside.extend(symbols.signals.iter().flatten());
    outside.push(symbols.time);
    if load.depends_on(graph, &ids(graph, &outside)) {
        return false;
    }
    let power = load.power(graph);
    let power = bench.algebra.shortest(power);
    if power == Graph::ZERO {
        return false;
    }
    let graph = &mut bench.algebra.graph;
    let backwards: Vec<_> = ids(graph, &symbols.speeds)
        .into_iter()
        .zip(&symbols.speeds)
        .map(|(id, &speed)| (id, graph.neg(speed)))
        .collect();
    let against: Option<Expr> = Substitution::new(graph, &backwards).apply(graph, power);
    against.is_some_and(|against| bench.algebra.test.are_equal(graph, power, against))
        && bench.declared.of(graph, power).lo >= 0.0
}
