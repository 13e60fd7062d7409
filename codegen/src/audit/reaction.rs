//! Forces and their reactions: opposite, with a common line of action.

use std::mem::discriminant;

use appell_spec::Code;
use appell_spec::mechanism::{BodyId, FrameId, LoadId, LoadKind, PointId};

use super::bench::{Audit, Bench};
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
    let setting = bench.setting();
    for (index, load) in mechanism.loads.entries() {
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
        let Ok(force) = setting.lower_all(graph, vector) else {
            continue;
        };
        let arm = bench.unconstrained.between(graph, *other, *on, *frame);
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

/// The point or body on which a load acts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum On {
    /// A force on a point.
    Point(PointId),
    /// A torque on a body.
    Body(BodyId),
}

/// Application, frame and components of a load.
type Action = (On, FrameId, Vec3);

/// One input that acts with the same sign on two bodies or points: the second may be intended as the reaction
/// to the first.
fn equal_signs(bench: &mut Bench, told: &mut Audit) {
    let mechanism = bench.mechanism;
    let inputs = ids(&bench.algebra.graph, &bench.derivation.symbols.inputs);
    let mut before: Vec<(LoadId, Action)> = Vec::new();
    for index in mechanism.loads.ids() {
        let graph = &bench.algebra.graph;
        if !bench.derivation.loads[index.index()].depends_on(graph, &inputs) {
            continue;
        }
        let Some(action) = external(bench, index) else {
            continue;
        };
        let (on, frame, vector) = action;
        let same = before.iter().find(|(_, other)| {
            discriminant(&other.0) == discriminant(&on)
                && other.0 != on
                && other.1 == frame
                && other.2 == vector
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
fn external(bench: &mut Bench, load: LoadId) -> Option<Action> {
    let setting = bench.setting();
    let (on, frame, vector) = match &bench.mechanism.loads[load].kind {
        LoadKind::Force {
            on,
            reaction_on: None,
            frame,
            vector,
            ..
        } => (On::Point(*on), *frame, vector),
        LoadKind::Torque {
            on,
            reaction_on: None,
            frame,
            vector,
        } => (On::Body(*on), *frame, vector),
        _ => return None,
    };
    let vector = setting.lower_all(&mut bench.algebra.graph, vector).ok()?;
    Some((on, frame, vector))
}
