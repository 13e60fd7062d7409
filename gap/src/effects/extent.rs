//! How far a body reaches, by what its drawing says of it.

use appell_spec::Mechanism;
use appell_spec::expr::{Expr, Quantity};
use appell_spec::mechanism::BodyId;

/// Of a body that a drawing gives no size.
const UNKNOWN: f64 = 1.0;

/// In m.
pub(super) struct Extent {
    /// From where the body is held to its centre of mass, in its frame.
    pub(super) away: [f64; 3],
    /// That distance and the radius of gyration together.
    pub(super) reach: f64,
}

impl Extent {
    pub(super) fn of(mechanism: &Mechanism, body: BodyId) -> Self {
        let body = &mechanism.bodies[body];
        let value = |expr: &Expr| {
            expr.value(&|quantity| match quantity {
                Quantity::Parameter(parameter) => mechanism.parameters[parameter].value,
                _ => f64::NAN,
            })
        };
        let mut away = [0.0; 3];
        let mut next = Some(body.centre);
        while let Some(point) = next.map(|point| &mechanism.points[point])
            && Some(point.frame) == body.frame
        {
            for (sum, part) in away.iter_mut().zip(&point.at) {
                let part = value(part);
                // What moves along the body has no place.
                *sum += if part.is_finite() { part } else { 0.0 };
            }
            next = point.from;
        }
        let moments = body.inertia.as_ref().map_or(0.0, |inertia| {
            (0..3).map(|i| value(&inertia.matrix[i][i])).sum::<f64>()
        });
        let gyration = moments / (2.0 * value(&body.mass));
        let gyration = if gyration.is_finite() { gyration } else { 0.0 };
        let square = away.iter().map(|part| part * part).sum::<f64>() + gyration.max(0.0);
        Self {
            away,
            reach: if square > 0.0 { square.sqrt() } else { UNKNOWN },
        }
    }
}
