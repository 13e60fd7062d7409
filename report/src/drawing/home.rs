//! Location of a name of the spec in the drawing: a joint, a body, a point of application.

use std::collections::BTreeSet;

use appell_spec::expr::{Expr, Quantity};
use appell_spec::mechanism::{
    Body, BodyId, Connection, CoordinateId, Load, LoadKind, Mechanism, PointId,
};

use super::link::held;

/// Points that represent a coordinate, pseudo-velocity, parameter, input, body, constraint or
/// point.
pub(super) fn home(mechanism: &Mechanism, name: &str) -> BTreeSet<PointId> {
    let mut points = BTreeSet::new();
    let named = mechanism.points.find(|point| point.name == name);
    points.extend(named);
    let body = mechanism.bodies.iter().find(|body| body.name == name);
    points.extend(body.map(|body| body.centre));
    let mut constraints = mechanism.constraints.iter();
    let constraint = constraints.find(|constraint| constraint.name == name);
    points.extend(constraint.and_then(|constraint| Some(held(constraint)?.1)));
    let coordinate = mechanism.coordinates.find(|q| q.label.name == name);
    let speed = mechanism.pseudo_velocities.find(|w| w.label.name == name);
    let moving = coordinate.map(Quantity::Coordinate);
    for moving in moving
        .into_iter()
        .chain(speed.map(Quantity::PseudoVelocity))
    {
        points.extend(carried(mechanism, moving));
    }
    if let Some(input) = mechanism.inputs.find(|u| u.label.name == name) {
        points.extend(felt(mechanism, Quantity::Input(input)));
    }
    if let Some(parameter) = mechanism.parameters.find(|p| p.label.name == name) {
        points.extend(shaped(mechanism, Quantity::Parameter(parameter)));
    }
    points
}

/// The joint of a coordinate: points that it places, and the pivots of frames that it rotates.
fn moved(mechanism: &Mechanism, coordinate: CoordinateId) -> Vec<PointId> {
    let quantity = Quantity::Coordinate(coordinate);
    let mut points: Vec<PointId> = placed(mechanism, quantity).collect();
    let mut centres = Vec::new();
    for (id, frame) in mechanism.frames.entries() {
        if !frame
            .turns
            .iter()
            .any(|turn| mentions(&turn.angle, quantity))
        {
            continue;
        }
        let placing = mechanism.points.iter().find(|point| point.frame == id);
        let body = mechanism.bodies.iter().find(|body| body.frame == Some(id));
        points.extend(placing.and_then(|point| point.from));
        centres.extend(body.map(|body| body.centre));
    }
    // A rotor without a point is where the joint is that it drives.
    if points.is_empty() { centres } else { points }
}

/// Points whose positions depend on a quantity.
fn placed(mechanism: &Mechanism, quantity: Quantity) -> impl Iterator<Item = PointId> {
    let points = mechanism.points.entries();
    points
        .filter(move |(_, point)| point.at.iter().any(|at| mentions(at, quantity)))
        .map(|(id, _)| id)
}

/// Points of application of loads that depend on a quantity.
fn felt(mechanism: &Mechanism, quantity: Quantity) -> Vec<PointId> {
    let loads = mechanism.loads.iter();
    loads
        .filter(|load| {
            load.kind
                .coefficients()
                .iter()
                .any(|expr| mentions(expr, quantity))
        })
        .flat_map(|load| attack(mechanism, load))
        .collect()
}

/// Points for a parameter: positions, masses, loads that depend on it.
fn shaped(mechanism: &Mechanism, quantity: Quantity) -> Vec<PointId> {
    let heavy = mechanism.bodies.iter().filter(|body| {
        let inertia = body
            .inertia
            .iter()
            .flat_map(|inertia| inertia.matrix.as_flattened());
        std::iter::once(&body.mass)
            .chain(inertia)
            .any(|expr| mentions(expr, quantity))
    });
    let mut points: Vec<PointId> = heavy.map(|body| body.centre).collect();
    points.extend(placed(mechanism, quantity));
    points.extend(felt(mechanism, quantity));
    points
}

/// The point about which a body turns.
fn pivot(mechanism: &Mechanism, body: &Body) -> PointId {
    let placing = mechanism.points.iter();
    let placing = placing.filter(|point| Some(point.frame) == body.frame);
    let mut pivots = placing.filter_map(|point| point.from);
    pivots.next().unwrap_or(body.centre)
}

/// Where a torque acts: in the joint of its two bodies, or about the pivot of the only one.
fn motor(mechanism: &Mechanism, on: BodyId, reaction_on: Option<BodyId>) -> PointId {
    let on = &mechanism.bodies[on];
    let own = pivot(mechanism, on);
    let Some(other) = reaction_on.map(|other| &mechanism.bodies[other]) else {
        return own;
    };
    let lies_on = |point: PointId, body: &Body| {
        point == body.centre || Some(mechanism.points[point].frame) == body.frame
    };
    let others = pivot(mechanism, other);
    if !lies_on(own, other) && lies_on(others, on) {
        return others;
    }
    own
}

fn attack(mechanism: &Mechanism, load: &Load) -> Vec<PointId> {
    match &load.kind {
        LoadKind::Torque {
            on, reaction_on, ..
        } => vec![motor(mechanism, *on, *reaction_on)],
        LoadKind::Generalized {
            velocity: along, ..
        }
        | LoadKind::SpringDamper {
            between: Connection::Along(along),
            ..
        } => {
            let mut points = Vec::new();
            along.visit(&mut |quantity| points.extend(carried(mechanism, quantity)));
            points
        }
        kind => kind.points(),
    }
}

/// Points that move with a coordinate or at a pseudo-velocity.
fn carried(mechanism: &Mechanism, quantity: Quantity) -> Vec<PointId> {
    match quantity {
        Quantity::Coordinate(q) | Quantity::Rate(q) => moved(mechanism, q),
        Quantity::PseudoVelocity(speed) => {
            let mut points = Vec::new();
            let definition = &mechanism.pseudo_velocities[speed].definition;
            definition.visit(&mut |part| {
                if let Quantity::Rate(q) = part {
                    points.extend(moved(mechanism, q));
                }
            });
            points
        }
        _ => Vec::new(),
    }
}

fn mentions(expr: &Expr, quantity: Quantity) -> bool {
    let mut found = false;
    expr.visit(&mut |read| found |= read == quantity);
    found
}
