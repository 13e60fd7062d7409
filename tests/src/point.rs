//! Places in state space.

use appell_runtime::model::{At, ModelInfo};

use appell_test_kit::Random;

/// A place in state space, in the order of the model.
#[derive(Debug, Clone)]
pub struct Point {
    /// Time in s.
    pub t: f64,
    /// State.
    pub x: Vec<f64>,
    /// Inputs and signals.
    pub u: Vec<f64>,
    /// Parameters.
    pub p: Vec<f64>,
}

impl Point {
    /// A random point inside the declared ranges. Angles and lengths without a range stay within
    /// ±1.2, velocities within ±2, inputs within ±5; parameters are up to 30 % off the spec's.
    pub fn random(info: &ModelInfo, random: &mut Random) -> Self {
        let inside = |[low, high]: [f64; 2], around: f64, width: f64| {
            [low.max(around - width), high.min(around + width)]
        };
        let mut draw = |[low, high]: [f64; 2]| random.between(low, high);
        let mut x: Vec<f64> = info
            .speed_quantities()
            .iter()
            .map(|_| draw([-2.0, 2.0]))
            .collect();
        for coordinate in info.coordinate_quantities() {
            // The middle nine tenths: at the ends of a range the equations may be singular.
            let [low, high] = coordinate.range;
            let middle = if (high - low).is_finite() {
                f64::midpoint(low, high)
            } else {
                0.0
            };
            let width = if (high - low).is_finite() {
                0.45 * (high - low)
            } else {
                1.2
            };
            x.push(draw(inside(coordinate.range, middle, width)));
        }
        let u = info.inputs.iter().map(|_| draw([-5.0, 5.0])).collect();
        let p = info
            .parameters
            .iter()
            .map(|q| draw(inside(q.range, q.value, 0.3 * q.value.abs())))
            .collect();
        let t = draw([0.0, 2.0]);
        Self { t, x, u, p }
    }

    /// The same place for the functions of a model.
    pub fn at(&self) -> At<'_> {
        At {
            t: self.t,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }
}
