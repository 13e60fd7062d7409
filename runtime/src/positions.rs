//! Position constraints f(q, t) = 0: consistent states and projection.
//!
//! The equations of motion keep the derivative of f at zero, so f itself drifts by the integration error. After every
//! step the coordinates are projected orthogonally onto f = 0 (Hairer, Lubich and Wanner, Geometric Numerical
//! Integration, section IV.4). The error estimate of the step stays unchanged: the correction is no longer than the
//! error.

use crate::dense::solved_in_place;
use crate::model::{At, Model, ModelInfo};

/// Maximum number of Newton steps.
const MOST_STEPS: usize = 20;
/// Tolerance of the residuals, in units of rounding of the coordinates.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Dependent coordinates whose entry in ∂f/∂q is below this fraction of the largest one are replaced.
const POOR: f64 = 0.2;

/// Coordinates that are adjusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moving {
    /// The dependent ones: the others keep their values.
    Dependent,
    /// All, with the smallest correction in SI.
    All,
}

/// No configuration that satisfies the position constraints was found.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "no configuration near this one satisfies the position constraints: off by {residual:.1e} in SI"
)]
pub struct Inconsistent {
    /// Largest residual where the search ended, in SI.
    pub residual: f64,
    /// The dependent coordinate of the constraint with that residual, as a state index.
    pub state: usize,
}

impl Inconsistent {
    /// The error and its remedy, in the names of a model.
    pub fn describe(&self, info: &ModelInfo) -> String {
        format!(
            "no value of `{}` near its initial one satisfies the position constraint that determines it (off by \
             {:.2} in SI units): the mechanism cannot be assembled there; correct the lengths, or the initial \
             values of the other coordinates",
            info.states[self.state].name, self.residual
        )
    }
}

/// The position constraints of a model, with work arrays.
#[derive(Debug, Clone)]
pub struct Positions {
    count: usize,
    coordinates: usize,
    /// The dependent coordinates, one per constraint.
    dependent: Vec<usize>,
    residual: Vec<f64>,
    jacobian: Vec<f64>,
    matrix: Vec<f64>,
}

impl Positions {
    /// For a model; `None` if it has no position constraints.
    pub fn of(model: &dyn Model) -> Option<Self> {
        let count = model.dependent_coordinates().len();
        let coordinates = model.info().states.len() - model.info().speeds;
        (count > 0).then(|| Self {
            count,
            coordinates,
            dependent: model.dependent_coordinates().to_vec(),
            residual: vec![0.0; count],
            jacobian: vec![0.0; count * coordinates],
            matrix: vec![0.0; count * count],
        })
    }

    /// Chooses the dependent coordinates that are best conditioned at a point: of a unit quaternion no component is
    /// everywhere. Returns them, one per constraint.
    pub fn choose_dependent(&mut self, model: &dyn Model, at: At<'_>) -> &[usize] {
        model.position_constraints(at, &mut self.residual, &mut self.jacobian);
        self.dependent = followers(
            &self.jacobian,
            self.coordinates,
            model.dependent_coordinates(),
        );
        &self.dependent
    }

    /// Adjusts coordinates of `x` until the constraints hold up to rounding. `u` are inputs and signals at time `t`.
    pub fn restore(
        &mut self,
        model: &dyn Model,
        t: f64,
        x: &mut [f64],
        u: &[f64],
        p: &[f64],
        moving: Moving,
    ) -> Result<(), Inconsistent> {
        let speeds = model.info().speeds;
        let mut last = f64::INFINITY;
        let mut worst = 0;
        for _ in 0..MOST_STEPS {
            let at = At { t, x, u, p };
            model.position_constraints(at, &mut self.residual, &mut self.jacobian);
            let size = largest(&self.residual);
            let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
            worst = (self.residual.iter().enumerate().max_by(by_size)).map_or(0, |(row, _)| row);
            let scale = largest(&x[speeds..]).max(1.0);
            // Below rounding, or stagnating close to it.
            if size <= ROUNDING * scale || (size >= last && size <= 1e3 * ROUNDING * scale) {
                return Ok(());
            }
            last = size;
            if !size.is_finite() || !self.step(&mut x[speeds..], moving) {
                break;
            }
        }
        Err(Inconsistent {
            residual: last,
            state: speeds + self.dependent[worst],
        })
    }

    /// One Newton step; false if the Jacobian is singular.
    fn step(&mut self, q: &mut [f64], moving: Moving) -> bool {
        let row = |i: usize| i * self.coordinates..(i + 1) * self.coordinates;
        let dependent = &self.dependent;
        for i in 0..self.count {
            for j in 0..self.count {
                self.matrix[i * self.count + j] = match moving {
                    Moving::Dependent => self.jacobian[i * self.coordinates + dependent[j]],
                    Moving::All => {
                        let pairs = self.jacobian[row(i)].iter().zip(&self.jacobian[row(j)]);
                        pairs.map(|(a, b)| a * b).sum()
                    }
                };
            }
        }
        if !solved_in_place(&mut self.matrix, &mut self.residual, self.count) {
            return false;
        }
        for (j, &multiplier) in self.residual.iter().enumerate() {
            match moving {
                Moving::Dependent => q[dependent[j]] -= multiplier,
                Moving::All => {
                    let row = &self.jacobian[j * self.coordinates..][..self.coordinates];
                    for (q, entry) in q.iter_mut().zip(row) {
                        *q -= entry * multiplier;
                    }
                }
            }
        }
        true
    }
}

/// The dependent coordinates for a Jacobian ∂f/∂q, row by row: the declared ones, or others that are much better
/// conditioned here.
pub(crate) fn followers(jacobian: &[f64], coordinates: usize, declared: &[usize]) -> Vec<usize> {
    let mut rows = jacobian.to_vec();
    let mut chosen: Vec<usize> = Vec::with_capacity(declared.len());
    for (place, &own) in declared.iter().enumerate() {
        let (_, rest) = rows.split_at_mut(place * coordinates);
        let (row, below) = rest.split_at_mut(coordinates);
        let size = |&q: &usize| row[q] * row[q];
        let open = (0..coordinates).filter(|q| !chosen.contains(q));
        let best = open
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .unwrap_or(own);
        let keeps = !chosen.contains(&own) && size(&own) >= POOR * POOR * size(&best);
        let follows = if keeps { own } else { best };
        chosen.push(follows);
        for other in below.chunks_exact_mut(coordinates) {
            let factor = other[follows] / row[follows];
            for (entry, own) in other.iter_mut().zip(row.iter()) {
                *entry -= factor * own;
            }
        }
    }
    chosen
}

fn largest(values: &[f64]) -> f64 {
    // A NaN propagates.
    let max = |a: f64, b: &f64| {
        if b.abs() > a || b.is_nan() {
            b.abs()
        } else {
            a
        }
    };
    values.iter().fold(0.0, max)
}
