//! Links: points with their reference points, frames with points.

use appell_spec::mechanism::{
    BodyId, Connection, Constraint, ConstraintKind, FrameId, GROUND, Load, LoadKind, Mechanism,
    ORIGIN, Point, PointId,
};
use serde::Serialize;

/// A line between two points.
pub struct Link {
    /// Its kind.
    pub kind: LinkKind,
    /// Its ends.
    pub ends: [PointId; 2],
    /// Its description.
    pub about: String,
}

/// Kind of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LinkKind {
    /// Coordinates from the origin; not a part of the mechanism.
    Way,
    /// A part of the mechanism.
    Rod,
    /// A spring between two points.
    Spring,
    /// A damper between two points.
    Damper,
}

/// Links from each point to its reference point, and springs and dampers.
pub(super) fn links(mechanism: &Mechanism) -> impl Iterator<Item = Link> {
    let placed = |(id, point): (PointId, &Point)| {
        let from = point.from?;
        let leads_only = from == ORIGIN && point.frame == GROUND;
        Some(Link {
            kind: if leads_only {
                LinkKind::Way
            } else {
                LinkKind::Rod
            },
            ends: [from, id],
            about: format!("{} from {}", point.name, mechanism.points[from].name),
        })
    };
    let connection = |load: &Load| {
        let LoadKind::SpringDamper {
            between: Connection::Points(a, b),
            spring,
            ..
        } = &load.kind
        else {
            return None;
        };
        let (kind, word) = match spring {
            Some(_) => (LinkKind::Spring, "spring"),
            None => (LinkKind::Damper, "damper"),
        };
        Some(Link {
            kind,
            ends: [*a, *b],
            about: format!("{word} {}", load.name),
        })
    };
    let placed = mechanism.points.entries().filter_map(placed);
    placed.chain(mechanism.loads.iter().filter_map(connection))
}

/// The point at which a constraint holds a body, and the body, where it is given.
pub(super) fn held(constraint: &Constraint) -> Option<(Option<BodyId>, PointId)> {
    match constraint.kind {
        ConstraintKind::Rolling { body, contact, .. } => Some((Some(body), contact)),
        ConstraintKind::FixedVelocity { body, point, .. } => Some((body, point)),
        ConstraintKind::Velocity { .. } | ConstraintKind::Position { .. } => None,
    }
}

/// The point at which the axes of a frame are drawn: the centre of its body, or the point from
/// which it places another.
pub(super) fn seat(mechanism: &Mechanism, frame: FrameId) -> Option<PointId> {
    let of_body = mechanism.bodies.iter().find(|b| b.frame == Some(frame));
    let placing = mechanism.points.iter().find(|p| p.frame == frame);
    match frame {
        GROUND => Some(ORIGIN),
        _ => of_body
            .map(|body| body.centre)
            .or(placing.and_then(|point| point.from)),
    }
}
