//! Divisions by expressions that vanish identically, `1/(sin(a)^2 + cos(a)^2 - 1)`, `tan(pi/2)`, and numbers
//! beyond the range of doubles.
//!
//! All expressions of a spec are lowered once in a separate graph, so that every such mistake is reported at
//! once and the equations are unaffected by the search.

use appell_spec::Code;
use appell_spec::expr::Expr as Spec;
use appell_spec::mechanism::{ConstraintKind, Mechanism};

use super::algebra::Algebra;
use super::finding::{Finding, Item, division_by_zero};
use super::symbols::Symbols;
use crate::symbolic::{Expr, Graph, Node};

/// One finding per item that divides by zero or contains a number beyond double precision.
pub fn findings(mechanism: &Mechanism) -> Vec<Finding> {
    let mut graph = Graph::new();
    let symbols = Symbols::new(&mut graph, mechanism);
    let mut algebra = Algebra::new(graph, mechanism, &symbols);
    let mut findings: Vec<Finding> = Vec::new();
    for (item, expr) in expressions(mechanism) {
        if findings.last().is_none_or(|last| last.item != item) {
            findings.extend(finding(&mut algebra, &symbols, item, expr));
        }
    }
    findings
}

fn finding(algebra: &mut Algebra, symbols: &Symbols, item: Item, expr: &Spec) -> Option<Finding> {
    let Ok(lowered) = symbols.lower(&mut algebra.graph, expr) else {
        return Some(division_by_zero(item));
    };
    let Algebra { graph, test, .. } = algebra;
    let divides_by_zero = graph.in_order(&[lowered]).into_iter().any(|part| {
        let Node::Product(factors) = graph.node(part) else {
            return false;
        };
        factors
            .iter()
            .any(|f| f.exponent < 0 && test.is_zero(graph, f.base))
    });
    if divides_by_zero {
        return Some(division_by_zero(item));
    }
    (!holds_doubles(graph, &[lowered])).then(|| beyond_double("an expression", item))
}

/// Whether all numbers in expressions are in the range of doubles.
pub fn holds_doubles(graph: &Graph, roots: &[Expr]) -> bool {
    graph
        .in_order(roots)
        .into_iter()
        .all(|part| match graph.node(part) {
            Node::Number(number) => number.is_double(),
            Node::Sum(terms) => terms.iter().all(|term| term.coefficient.is_double()),
            Node::Product(factors) => factors.iter().all(|factor| {
                let base = graph.as_number(factor.base);
                base.is_none_or(|base| base.to_f64().powi(factor.exponent).is_normal())
            }),
            _ => true,
        })
}

/// A number beyond the range of doubles.
pub fn beyond_double(what: &str, item: Item) -> Finding {
    Finding {
        code: Code::NotFinite,
        message: format!("{what} has a number beyond double precision in it"),
        item,
        help: "use parameters, or other units: a double holds 1e-308 to 1e308".to_owned(),
    }
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
        let coefficients = load.kind.coefficients().into_iter();
        all.extend(coefficients.map(|e| (Item::Load(i), e)));
    }
    for (i, output) in mechanism.outputs.entries() {
        all.push((Item::Output(i), &output.value));
    }
    all
}
