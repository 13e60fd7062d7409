//! Divisions by what is zero in every configuration: `1/(sin(a)^2 + cos(a)^2 - 1)`, `tan(pi/2)`.
//!
//! All expressions of a spec are read once in a graph of their own, so that every such mistake is told
//! at once and the equations do not depend on the search.

use appell_spec::expr::Expr as Spec;
use appell_spec::mechanism::{ConstraintKind, LoadKind, Mechanism};

use super::algebra::Algebra;
use super::expressions::Lowering;
use super::finding::{Finding, Item, division_by_zero};
use super::symbols::Symbols;
use crate::symbolic::{Graph, Node};

/// One finding per item that divides by zero.
pub fn findings(mechanism: &Mechanism) -> Vec<Finding> {
    let mut graph = Graph::new();
    let symbols = Symbols::new(&mut graph, mechanism);
    let mut algebra = Algebra::new(graph, mechanism, &symbols);
    let mut items: Vec<Item> = Vec::new();
    for (item, expr) in expressions(mechanism) {
        if items.last() != Some(&item) && divides_by_zero(&mut algebra, &symbols, expr) {
            items.push(item);
        }
    }
    items.into_iter().map(division_by_zero).collect()
}

fn divides_by_zero(algebra: &mut Algebra, symbols: &Symbols, expr: &Spec) -> bool {
    let lowering = Lowering {
        symbols,
        rates: &symbols.rates,
    };
    let Ok(lowered) = lowering.lower(&mut algebra.graph, expr) else {
        return true;
    };
    let Algebra { graph, test, .. } = algebra;
    graph.in_order(&[lowered]).into_iter().any(|part| {
        let Node::Product(factors) = graph.node(part) else {
            return false;
        };
        factors
            .iter()
            .any(|f| f.exponent < 0 && test.is_zero(graph, f.base))
    })
}

/// Every expression of a mechanism with the item it belongs to, item by item.
fn expressions(mechanism: &Mechanism) -> Vec<(Item, &Spec)> {
    let mut all: Vec<(Item, &Spec)> = Vec::new();
    for (i, frame) in mechanism.frames.entries() {
        all.extend(frame.turns.iter().map(|turn| (Item::Frame(i), &turn.angle)));
    }
    for (i, point) in mechanism.points.entries() {
        all.extend(point.at.iter().map(|c| (Item::Point(i), c)));
    }
    for (i, body) in mechanism.bodies.entries() {
        all.push((Item::Body(i), &body.mass));
        let entries = body.inertia.iter().flat_map(|inertia| &inertia.matrix);
        all.extend(entries.flatten().map(|entry| (Item::Body(i), entry)));
    }
    for (i, constraint) in mechanism.constraints.entries() {
        let item = Item::Constraint(i);
        match &constraint.kind {
            ConstraintKind::Velocity { zero, equals, .. } => {
                all.extend([(item, zero), (item, equals)]);
            }
            ConstraintKind::FixedVelocity {
                direction, equals, ..
            } => {
                all.extend(direction.iter().chain([equals]).map(|e| (item, e)));
            }
            ConstraintKind::Position { zero, .. } => all.push((item, zero)),
            ConstraintKind::Rolling {
                friction, creep, ..
            } => {
                all.extend(friction.iter().map(|e| (item, e)));
                let creep = creep
                    .iter()
                    .flat_map(|creep| [&creep.longitudinal, &creep.lateral]);
                all.extend(creep.map(|e| (item, e)));
            }
        }
    }
    for (i, speed) in mechanism.pseudo_velocities.entries() {
        let item = Item::PseudoVelocity(i);
        all.extend([(item, &speed.definition)]);
        all.extend(speed.rate.iter().map(|rate| (item, rate)));
    }
    for (i, load) in mechanism.loads.entries() {
        let item = Item::Load(i);
        match &load.kind {
            LoadKind::Gravity { acceleration, .. } => all.push((item, acceleration)),
            LoadKind::Force { vector, .. } | LoadKind::Torque { vector, .. } => {
                all.extend(vector.iter().map(|c| (item, c)));
            }
            LoadKind::Spring {
                stiffness, relaxed, ..
            } => all.extend([(item, stiffness), (item, relaxed)]),
            LoadKind::Damper { damping, .. } => all.push((item, damping)),
            LoadKind::Generalized { force, .. } => all.push((item, force)),
        }
    }
    for (i, output) in mechanism.outputs.entries() {
        all.push((Item::Output(i), &output.value));
    }
    all
}
