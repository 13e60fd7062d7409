//! The size of a body, from its centre of mass and its inertia.

use appell_spec::Mechanism;
use appell_spec::expr::{Expr, Quantity};
use appell_spec::mechanism::BodyId;

/// Radius of a body whose spec gives no size.
const UNKNOWN: f64 = 1.0;

/// In m.
pub(super) struct Extent {
    /// From the origin of its frame to its centre of mass, in that frame.
    pub(super) away: [f64; 3],
    /// Root of the sum of squares of that distance and of the radius of gyration.
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
                // Coordinates that vary along the body do not count.
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
