//! Paths of points in a steady motion.
//!
//! The essential states are constant, so every point of the mechanism turns at a common rate about
//! a vertical axis, or moves straight: its path is a circle, a helix or a line.

use super::differences::derivatives;
use crate::point::Point;
use crate::term::Term;
use appell_runtime::model::Model;

/// The path of a point in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Radius in m; infinite for a straight path, 0 for a point at rest.
    pub radius: f64,
    /// Coordinates of its centre; not finite for a straight path.
    pub centre: [f64; 2],
    /// Rate at which the direction of motion turns, from the first axis to the second, in rad/s; 0
    /// for a point at rest.
    pub turn_rate: f64,
    /// In m/s.
    pub speed: f64,
}

/// Turn rates below this fraction of the largest rate of an ignorable coordinate are rounding.
const STRAIGHT: f64 = 1e-11;

/// The osculating circle of a point whose position in the plane is given by two coordinates or
/// outputs; constant in a steady motion.
pub fn circle(model: &dyn Model, point: &Point, place: [Term; 2]) -> Circle {
    let rates = point.rates(model);
    let accelerations = second_rates(model, point, &rates);
    let fastest = rates.iter().map(|rate| rate.abs()).fold(1.0, f64::max);
    // The parabola has the velocity and the acceleration of the motion.
    let at = |t: f64| {
        let mut moved = point.clone();
        for (i, x) in moved.x.iter_mut().enumerate() {
            *x += t * (rates[i] + 0.5 * t * accelerations[i]);
        }
        place.map(|term| term.value(model, &moved))
    };
    let [here, velocity, acceleration] = derivatives(at, 0.05 / fastest);
    let speed = velocity[0].hypot(velocity[1]);
    let cross = velocity[0] * acceleration[1] - velocity[1] * acceleration[0];
    let turn_rate = cross / (speed * speed);
    if speed <= f64::EPSILON * fastest {
        return Circle {
            radius: 0.0,
            centre: here,
            turn_rate: 0.0,
            speed: 0.0,
        };
    }
    if turn_rate.abs() <= STRAIGHT * fastest {
        let centre = [f64::INFINITY; 2];
        return Circle {
            radius: f64::INFINITY,
            centre,
            turn_rate: 0.0,
            speed,
        };
    }
    Circle {
        radius: speed / turn_rate.abs(),
        centre: [
            here[0] - velocity[1] / turn_rate,
            here[1] + velocity[0] / turn_rate,
        ],
        turn_rate,
        speed,
    }
}

/// ẍ = A ẋ with the inputs held.
fn second_rates(model: &dyn Model, point: &Point, rates: &[f64]) -> Vec<f64> {
    let (n, m) = (rates.len(), model.info().input_len());
    let (mut same, mut a, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
    model.jacobians(point.at(), &mut same, &mut a, &mut b);
    let row = |row: &[f64]| row.iter().zip(rates).map(|(a, x)| a * x).sum();
    a.chunks(n.max(1)).map(row).collect()
}
