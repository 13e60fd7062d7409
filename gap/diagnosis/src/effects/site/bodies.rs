//! Sites at bodies, with their sizes.

use appell_spec::expr::{Expr, Quantity};
use appell_spec::mechanism::BodyId;

use super::{AXES, Site, Sites, is_zero, number};

/// Radius of a body whose spec gives no size, in m.
const UNKNOWN: f64 = 1.0;

impl Sites<'_> {
    /// Of a point without mass, which is a payload of some runs, nothing is unknown.
    pub(in crate::effects) fn bodies(&self) -> Vec<Site> {
        let is_massless_point = |&body: &BodyId| {
            let body = &self.mechanism.bodies[body];
            body.frame.is_none() && self.value(&body.mass) == 0.0
        };
        let bodies = self.mechanism.bodies.ids();
        let bodies = bodies.filter(|body| !is_massless_point(body));
        bodies.map(|body| self.body(body)).collect()
    }

    pub(super) fn body(&self, index: BodyId) -> Site {
        let body = &self.mechanism.bodies[index];
        let centre = &self.mechanism.points[body.centre].name;
        let velocity = |axis: &str| format!("velocity({centre}, {axis})");
        let frame = body
            .frame
            .map_or("ground", |frame| &self.mechanism.frames[frame].name);
        let words = vec![
            ("centre", centre.clone()),
            ("frame", frame.to_owned()),
            ("speed", format!("smooth_abs(speed({centre}), 0.001 [m/s])")),
            ("velocity_x", velocity("x")),
            ("velocity_y", velocity("y")),
            ("velocity_z", velocity("z")),
        ];
        Site {
            placed_along: self.placed_along(index),
            ..Site::new(&body.name, index.index(), words)
        }
    }

    /// Axes of the frame of a body along which parameters give its centre: an error there is one of a
    /// parameter.
    fn placed_along(&self, index: BodyId) -> Vec<&'static str> {
        let body = &self.mechanism.bodies[index];
        let centre = &self.mechanism.points[body.centre];
        if Some(centre.frame) != body.frame {
            return Vec::new();
        }
        let axes = AXES.into_iter().zip(&centre.at);
        axes.filter(|(_, at)| !is_zero(at))
            .map(|(axis, _)| axis)
            .collect()
    }

    /// Bodies with a frame and their sizes, from the centre of mass and the inertia.
    pub(in crate::effects) fn rigid_bodies(&self) -> Vec<Site> {
        let bodies = self.mechanism.bodies.ids();
        let rigid = bodies.filter(|&body| self.mechanism.bodies[body].frame.is_some());
        rigid.map(|body| self.rigid_body(body)).collect()
    }

    fn rigid_body(&self, index: BodyId) -> Site {
        let body = &self.mechanism.bodies[index];
        // From the origin of its frame to its centre of mass, in that frame.
        let mut away = [0.0; 3];
        let mut next = Some(body.centre);
        while let Some(point) = next.map(|point| &self.mechanism.points[point])
            && Some(point.frame) == body.frame
        {
            for (sum, part) in away.iter_mut().zip(&point.at) {
                let part = self.value(part);
                // Coordinates that vary along the body do not count.
                *sum += if part.is_finite() { part } else { 0.0 };
            }
            next = point.from;
        }
        let moments = body.inertia.as_ref().map_or(0.0, |inertia| {
            let moments = (0..3).map(|i| self.value(&inertia.matrix[i][i]));
            moments.sum::<f64>()
        });
        let gyration = moments / (2.0 * self.value(&body.mass));
        let gyration = if gyration.is_finite() { gyration } else { 0.0 };
        let square = away.iter().map(|part| part * part).sum::<f64>() + gyration.max(0.0);
        // Root of the sum of squares of that distance and of the radius of gyration.
        let reach = if square > 0.0 { square.sqrt() } else { UNKNOWN };
        let [x, y, z] = away.map(number);
        let mut site = self.body(index);
        site.words.extend([
            ("away_x", x),
            ("away_y", y),
            ("away_z", z),
            ("reach", number(reach)),
        ]);
        site
    }

    /// Its value by the parameters of the spec; NaN if it depends on the motion.
    fn value(&self, expr: &Expr) -> f64 {
        expr.value(&|quantity| match quantity {
            Quantity::Parameter(parameter) => self.mechanism.parameters[parameter].value,
            _ => f64::NAN,
        })
    }
}
