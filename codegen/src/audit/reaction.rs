//! Forces and their reactions: opposite, and on one line.

use appell_spec::Code;
use appell_spec::mechanism::{FrameId, LoadKind};

use super::{Audit, Bench};
use crate::mechanics::expressions::Lowering;
use crate::mechanics::finding::{Finding, Item};
use crate::mechanics::symbols::ids;
use crate::symbolic::vector::Vec3;

pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    couples(bench, told);
    equal_signs(bench, told);
}

/// Forces between two points that do not act along the line between them.
fn couples(bench: &mut Bench, told: &mut Audit) {
    let mechanism = bench.mechanism;
    let lowering = Lowering {
        symbols: &bench.derivation.symbols,
        rates: &bench.derivation.velocities.rates,
    };
    for (index, load) in mechanism.loads.iter().enumerate() {
        let LoadKind::Force {
            on,
            reaction_on: Some(other),
            frame,
            vector,
            ..
        } = &load.kind
        else {
            continue;
        };
        let graph = &mut bench.algebra.graph;
        let Ok(force) = lowering.lower_all(graph, vector) else {
            continue;
        };
        let arm = bench
            .unconstrained
            .between(graph, mechanism, *other, *on, *frame);
        let couple = graph.cross(arm, force);
        let test = &mut bench.algebra.test;
        if couple
            .iter()
            .all(|&component| test.is_zero(graph, component))
        {
            continue;
        }
        let [on, other] = [*on, *other].map(|point| &mechanism.points[point].name);
        told.warnings.push(Finding {
            code: Code::UnbalancedReaction,
            message: format!(
                "`{}` does not act along the line from `{other}` to `{on}`: force and reaction form \
                 an unbalanced couple",
                load.name
            ),
            item: Item::Load(index),
            help: format!(
                "let the reaction act on a point of the line of action of `{}`, fixed in the body that \
                 carries the reaction",
                load.name
            ),
        });
    }
}

/// What acts where: a torque on a body, or a force on a point.
type Action = (bool, usize, FrameId, Vec3);

/// One input that acts with the same sign on two bodies or points: the second may be meant as the
/// reaction to the first.
fn equal_signs(bench: &mut Bench, told: &mut Audit) {
    let mechanism = bench.mechanism;
    let inputs = ids(&bench.algebra.graph, &bench.derivation.symbols.inputs);
    let mut before: Vec<(usize, Action)> = Vec::new();
    for index in 0..mechanism.loads.len() {
        let graph = &bench.algebra.graph;
        if !bench.derivation.loads[index].depends_on(graph, &inputs) {
            continue;
        }
        let Some(action) = external(bench, index) else {
            continue;
        };
        let (is_torque, on, frame, vector) = action;
        let same = before.iter().find(|(_, other)| {
            other.0 == is_torque && other.1 != on && other.2 == frame && other.3 == vector
        });
        if let Some(&(other, _)) = same {
            let [name, other] = [index, other].map(|load| &mechanism.loads[load].name);
            told.notes.push(Finding {
                code: Code::UnbalancedReaction,
                message: format!(
                    "`{name}` has the same sign as `{other}`; a reaction would have the opposite one"
                ),
                item: Item::Load(index),
                help: format!(
                    "if it is the reaction to `{other}`, remove it and give `{other}` a \
                     `reaction_on`; otherwise no action is needed"
                ),
            });
        }
        before.push((index, action));
    }
}

/// A load without a reaction.
fn external(bench: &mut Bench, load: usize) -> Option<Action> {
    let lowering = Lowering {
        symbols: &bench.derivation.symbols,
        rates: &bench.derivation.velocities.rates,
    };
    let (is_torque, on, frame, vector) = match &bench.mechanism.loads[load].kind {
        LoadKind::Force {
            on,
            reaction_on: None,
            frame,
            vector,
            ..
        } => (false, *on, *frame, vector),
        LoadKind::Torque {
            on,
            reaction_on: None,
            frame,
            vector,
        } => (true, *on, *frame, vector),
        _ => return None,
    };
    let vector = lowering.lower_all(&mut bench.algebra.graph, vector).ok()?;
    Some((is_torque, on, frame, vector))
}
