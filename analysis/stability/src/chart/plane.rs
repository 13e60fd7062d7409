//! Steady motions over a plane of two prescribed quantities.

use nalgebra::{DMatrix, DVector};

use crate::steady::equations::SteadyEquations;
use crate::steady::newton::{self, Equations};
use crate::steady::{Condition, SteadyProblem};
use crate::term::Term;

/// A quantity with its range and the number of its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub term: Term,
    /// First and last value in SI.
    pub range: [f64; 2],
    /// Number of values, both ends included.
    pub count: usize,
}

impl Axis {
    /// A value by its number.
    pub fn value(&self, i: usize) -> f64 {
        let part = i as f64 / self.count.saturating_sub(1).max(1) as f64;
        self.range[0] + part * self.length()
    }

    /// From the first value to the last.
    pub(crate) fn length(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    /// Number of the nearest value.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the count"
    )]
    pub(crate) fn nearest(&self, value: f64) -> usize {
        let last = self.count.saturating_sub(1) as f64;
        let part = (value - self.range[0]) / self.length();
        (part * last).round().clamp(0.0, last) as usize
    }

    /// How far a value is inside the range; negative outside.
    pub(crate) fn margin(&self, value: f64) -> f64 {
        let [from, to] = self.range;
        (value - from.min(to)).min(from.max(to) - value)
    }
}

/// The motions that satisfy a problem's conditions, over the values of two axes.
pub(crate) struct Plane<'a> {
    pub(crate) problem: &'a SteadyProblem<'a>,
    pub(crate) axes: [Axis; 2],
    /// The equations of all motions, with the quantities of the axes in units of their ranges.
    pub(crate) equations: SteadyEquations<'a>,
    /// The same with the quantities of the axes as residuals.
    placed: SteadyEquations<'a>,
}

/// The equations of the motions at a point of the plane.
struct At<'a> {
    plane: &'a Plane<'a>,
    place: [f64; 2],
}

impl Equations for At<'_> {
    fn evaluate(&self, z: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let (mut f, jacobian) = self.plane.placed.evaluate(z);
        let rows = f.len();
        for (f, wanted) in f.rows_mut(rows - 2, 2).iter_mut().zip(self.place) {
            *f -= wanted;
        }
        (f, jacobian)
    }
}

impl<'a> Plane<'a> {
    pub(crate) fn new(problem: &'a SteadyProblem<'a>, axes: [Axis; 2]) -> Self {
        let mut equations = problem.equations();
        for (term, scale) in equations.unknowns.iter().zip(&mut equations.scales) {
            for axis in axes.iter().filter(|axis| axis.term == *term) {
                *scale = 0.5 * axis.length().abs();
            }
        }
        let mut placed = equations.clone();
        let nothing = |axis: Axis| Condition {
            term: axis.term,
            value: 0.0,
        };
        placed.conditions.extend(axes.map(nothing));
        Self {
            problem,
            axes,
            equations,
            placed,
        }
    }

    /// The values of the axes in a motion.
    pub(crate) fn coordinates(&self, z: &DVector<f64>) -> [f64; 2] {
        let point = self.equations.point(z);
        self.axes
            .map(|axis| axis.term.value(self.equations.model, &point))
    }

    /// Whether a motion lies within the axes.
    pub(crate) fn holds(&self, z: &DVector<f64>) -> bool {
        let mut places = self.axes.iter().zip(self.coordinates(z));
        places.all(|(axis, value)| axis.margin(value) >= 0.0)
    }

    /// The motion at a point of the plane that is near another motion, by plain Newton steps.
    pub(crate) fn near(&self, place: [f64; 2], start: &DVector<f64>) -> Option<DVector<f64>> {
        /// Steps; two are usual.
        const STEPS: usize = 8;
        /// After a step as short as this the next would be rounding.
        const SHORT: f64 = 1e-7;
        /// A longer step, relative to the motion, leads to another motion.
        const FAR: f64 = 1.0;
        /// Scaled unknowns that exceed this diverge.
        const INFINITE: f64 = 1e4;
        /// Ratio of pivots below which the motion belongs to a family.
        const REGULAR: f64 = 1e-9;
        let equations = At { plane: self, place };
        let mut z = start.clone();
        for _ in 0..STEPS {
            let (f, jacobian) = equations.evaluate(&z);
            let weights = newton::weights(&jacobian);
            let qr = newton::weighted(&jacobian, &weights).qr();
            let mut target = -f.component_mul(&weights);
            qr.q_tr_mul(&mut target);
            let r = qr.r();
            let diagonal = r.diagonal();
            let regular = diagonal.amin() > REGULAR * diagonal.amax();
            if !regular {
                return None;
            }
            let step = r.solve_upper_triangular(&target.rows(0, r.ncols()))?;
            z += &step;
            let size = step.norm() / (1.0 + z.norm());
            if size.is_nan() || size > FAR || z.norm() > INFINITE {
                return None;
            }
            if size <= SHORT {
                let inside = self.problem.in_range(&self.equations.point(&z));
                return inside.then_some(z);
            }
        }
        None
    }

    /// Continues a motion from one point of the plane to another, in as many steps as it needs.
    pub(crate) fn approach(
        &self,
        from: [f64; 2],
        start: &DVector<f64>,
        to: [f64; 2],
    ) -> Option<DVector<f64>> {
        /// The shortest step, as a fraction of the distance.
        const SHORTEST: f64 = 1.0 / 64.0;
        let (mut z, mut done, mut step) = (start.clone(), 0.0, 1.0);
        // Steps are halves of halves, so that the last one ends at 1.
        while done < 1.0 {
            match self.near(between(from, to, done + step), &z) {
                Some(found) => (z, done) = (found, done + step),
                None if step > SHORTEST => step *= 0.5,
                None => return None,
            }
        }
        Some(z)
    }
}

/// A point between two others.
pub(crate) fn between(from: [f64; 2], to: [f64; 2], part: f64) -> [f64; 2] {
    [0, 1].map(|k: usize| from[k] + part * (to[k] - from[k]))
}
