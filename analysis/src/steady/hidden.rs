//! What the hidden coordinates do in a steady motion: the paths of points.
//!
//! The essential states rest, so every point of the mechanism turns at one rate about one upright
//! axis, or moves straight: its path is a circle, a helix or a line.

use crate::point::Point;
use crate::term::Term;
use appell_runtime::model::Model;

/// The path of a point in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Radius in m; infinite for a straight path, 0 for a point at rest.
    pub radius: f64,
    /// Where its centre is, in the coordinates of the point; not finite for a straight path.
    pub centre: [f64; 2],
    /// Rate at which the direction of motion turns, from the first axis to the second, in rad/s; 0
    /// for a point at rest.
    pub turn_rate: f64,
    /// In m/s.
    pub speed: f64,
}

/// Turn rates below this part of the largest rate of a hidden coordinate are rounding.
const STRAIGHT: f64 = 1e-11;

/// The path of a point whose place in the plane are two coordinates or outputs. Works for any motion;
/// in a steady one the circle stays the same.
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

/// Value, first and second derivative at zero, by central differences of order eight.
fn derivatives(at: impl Fn(f64) -> [f64; 2], step: f64) -> [[f64; 2]; 3] {
    const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    const SECOND: [f64; 4] = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
    let here = at(0.0);
    let (mut first, mut second) = ([0.0; 2], [0.0; 2]);
    for k in 0..4 {
        let away = step * (k + 1) as f64;
        let (before, after) = (at(-away), at(away));
        for i in 0..2 {
            first[i] += FIRST[k] * (after[i] - before[i]) / step;
            second[i] += SECOND[k] * (after[i] - here[i] + (before[i] - here[i])) / (step * step);
        }
    }
    [here, first, second]
}
