//! Inconsistency of recorded motions with a model, for any inputs, and the parameters that minimise
//! it.
//!
//! The relations ρ of a segment have the covariance C = J Σ Jᵀ from the noise of the samples; J is
//! their exact Jacobian with respect to the motion, which depends on the parameters θ, and Σ is the
//! covariance of the motion with all correlations in time. The inconsistency is
//!
//! ```text
//! Q(θ) = ½ ρᵀ C(θ)⁻¹ ρ
//! ```
//!
//! the smallest weighted noise that makes the motion possible (total least squares). Its derivative
//! is
//!
//! ```text
//! dQ/dθ = Dᵀ C⁻¹ ρ,   D = ∂ρ/∂θ − (∂J/∂θ) Σ Jᵀ C⁻¹ ρ
//! ```
//!
//! D is the part of ∂ρ/∂θ that is uncorrelated with ρ, so that the mean of dQ/dθ is zero at the
//! truth although both sides of the equations are noisy.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::InverseError;
use super::relation::{Motion, Relations};
use super::track::{Stretch, Track};

/// Relative step of a central difference of exact derivatives.
const STEP: f64 = 1e-4;

/// A sought value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sought {
    /// A parameter of the model, by its index.
    Parameter(usize),
    /// Bias of a measured coordinate, by its index among the measured ones.
    Bias(usize),
}

/// Q with its derivatives.
#[derive(Debug, Clone)]
pub struct Inconsistency {
    /// Q.
    pub cost: f64,
    /// dQ/dθ.
    pub score: DVector<f64>,
    /// Dᵀ C⁻¹ D: the covariance of the score if the model is correct.
    pub information: DMatrix<f64>,
    /// The same from block scores, robust against wrong noise and model.
    pub squares: DMatrix<f64>,
    /// Number of relations at all times.
    pub count: usize,
}

/// Recorded motions and a model.
pub struct Consistency<'a> {
    relations: Relations<'a>,
    track: Track,
    /// Parameters in SI; those that are sought are nominal.
    parameters: Vec<f64>,
    sought: Vec<Sought>,
}

/// The relations of a segment: rows for each relation of each time.
struct Evaluated {
    values: DVector<f64>,
    by_motion: [DMatrix<f64>; 3],
    by_parameters: DMatrix<f64>,
}

impl<'a> Consistency<'a> {
    /// Of motions in the coordinates of `relations`.
    pub fn new(
        relations: Relations<'a>,
        track: Track,
        parameters: Vec<f64>,
        sought: Vec<Sought>,
    ) -> Result<Self, InverseError> {
        if relations.is_empty() {
            return Err(InverseError::NoRelation);
        }
        Ok(Self {
            relations,
            track,
            parameters,
            sought,
        })
    }

    /// The motions.
    pub const fn track(&self) -> &Track {
        &self.track
    }

    /// The relations.
    pub const fn relations(&self) -> &Relations<'a> {
        &self.relations
    }

    /// The sought values.
    pub fn sought(&self) -> &[Sought] {
        &self.sought
    }

    /// Start of the search: nominal parameters without bias.
    pub fn nominal(&self) -> DVector<f64> {
        let values = self.sought.iter().map(|sought| match *sought {
            Sought::Parameter(index) => self.parameters[index],
            Sought::Bias(_) => 0.0,
        });
        DVector::from_iterator(self.sought.len(), values)
    }

    /// Scales of the values: the magnitudes of the parameters, and the noise of a channel.
    pub fn scales(&self) -> DVector<f64> {
        let scales = self.sought.iter().map(|sought| match *sought {
            Sought::Parameter(index) => match self.parameters[index].abs() {
                size if size > 0.0 => size,
                _ => 1.0,
            },
            Sought::Bias(index) => self.track.noise[(index, index)].sqrt().max(STEP),
        });
        DVector::from_iterator(self.sought.len(), scales)
    }

    /// The parameters of the model for some values.
    pub fn parameters(&self, values: &DVector<f64>) -> Vec<f64> {
        let mut parameters = self.parameters.clone();
        for (sought, value) in self.sought.iter().zip(values.iter()) {
            if let Sought::Parameter(index) = *sought {
                parameters[index] = *value;
            }
        }
        parameters
    }

    /// A recorded motion without its biases.
    pub fn corrected(&self, motion: &Motion, values: &DVector<f64>) -> Motion {
        let mut motion = motion.clone();
        for (sought, value) in self.sought.iter().zip(values.iter()) {
            if let Sought::Bias(index) = *sought {
                motion.derivatives[0][index] -= value;
            }
        }
        motion
    }

    /// Q.
    pub fn cost(&self, values: &DVector<f64>) -> Result<f64, InverseError> {
        let stretches = self.track.stretches.iter();
        let costs = stretches.map(|stretch| {
            let here = self.evaluate(stretch, values)?;
            let factor = self.factor(stretch, &here)?;
            let white = whitened(&factor, &here.values);
            Ok(0.5 * white.norm_squared())
        });
        costs.sum()
    }

    /// Q with its derivatives.
    pub fn at(&self, values: &DVector<f64>) -> Result<Inconsistency, InverseError> {
        let count = self.sought.len();
        let mut all = Inconsistency {
            cost: 0.0,
            score: DVector::zeros(count),
            information: DMatrix::zeros(count, count),
            squares: DMatrix::zeros(count, count),
            count: 0,
        };
        for stretch in &self.track.stretches {
            let here = self.evaluate(stretch, values)?;
            let factor = self.factor(stretch, &here)?;
            let slopes = self.slopes(stretch, values, &here, &factor)?;
            let white = whitened(&factor, &here.values);
            let slopes = factor.l_dirty().solve_lower_triangular(&slopes);
            let slopes = slopes.ok_or(InverseError::Singular)?;
            let score = slopes.tr_mul(&white);
            all.cost += 0.5 * white.norm_squared();
            all.information += slopes.tr_mul(&slopes);
            all.count += white.len();
            // Neighbours within a segment may be correlated; segments are not.
            all.squares += &score * score.transpose();
            all.score += score;
        }
        Ok(all)
    }

    /// Relations at all times of a segment.
    fn evaluate(
        &self,
        stretch: &Stretch,
        values: &DVector<f64>,
    ) -> Result<Evaluated, InverseError> {
        let p = self.parameters(values);
        let (each, measured) = (self.relations.len(), self.relations.measured().len());
        let rows = each * stretch.motions.len();
        let zero = || DMatrix::zeros(rows, measured);
        let mut all = Evaluated {
            values: DVector::zeros(rows),
            by_motion: [zero(), zero(), zero()],
            by_parameters: DMatrix::zeros(rows, p.len()),
        };
        for (place, motion) in stretch.motions.iter().enumerate() {
            let here = self.relations.at(&self.corrected(motion, values), &p)?;
            let at = place * each;
            all.values.rows_mut(at, each).copy_from(&here.values);
            all.by_parameters
                .rows_mut(at, each)
                .copy_from(&here.by_parameters);
            for (all, here) in all.by_motion.iter_mut().zip(&here.by_motion) {
                all.rows_mut(at, each).copy_from(here);
            }
        }
        if all.values.iter().all(|value| value.is_finite()) {
            Ok(all)
        } else {
            Err(InverseError::NotFinite)
        }
    }

    /// C = L Lᵀ.
    fn factor(
        &self,
        stretch: &Stretch,
        here: &Evaluated,
    ) -> Result<Cholesky<f64, Dyn>, InverseError> {
        let each = self.relations.len();
        let rows = here.values.len();
        let noisy = here
            .by_motion
            .each_ref()
            .map(|slopes| slopes * &self.track.noise);
        let mut c = DMatrix::zeros(rows, rows);
        for (pair, share) in stretch.spread.iter().enumerate() {
            let (left, right) = (&here.by_motion[pair / 3], &noisy[pair % 3]);
            let products = left * right.transpose();
            for j in 0..rows {
                for i in j..rows {
                    c[(i, j)] += share[(i / each, j / each)] * products[(i, j)];
                }
            }
        }
        c.fill_upper_triangle_with_lower_triangle();
        Cholesky::new(c).ok_or(InverseError::Singular)
    }

    /// D: a column for each sought value.
    fn slopes(
        &self,
        stretch: &Stretch,
        values: &DVector<f64>,
        here: &Evaluated,
        factor: &Cholesky<f64, Dyn>,
    ) -> Result<DMatrix<f64>, InverseError> {
        let noise = self.least_noise(stretch, here, &factor.solve(&here.values));
        let scales = self.scales();
        let mut slopes = DMatrix::zeros(here.values.len(), self.sought.len());
        for (column, sought) in self.sought.iter().enumerate() {
            let h = STEP * values[column].abs().max(scales[column]);
            let varied = |sign: f64| {
                let mut values = values.clone();
                values[column] += sign * h;
                self.evaluate(stretch, &values)
            };
            let (above, below) = (varied(1.0)?, varied(-1.0)?);
            let mut slope = match *sought {
                Sought::Parameter(index) => here.by_parameters.column(index).into_owned(),
                Sought::Bias(index) => -here.by_motion[0].column(index).into_owned(),
            };
            for (order, noise) in noise.iter().enumerate() {
                let change = &above.by_motion[order] - &below.by_motion[order];
                for row in 0..slope.len() {
                    slope[row] -= change.row(row).dot(&noise.row(row)) / (2.0 * h);
                }
            }
            slopes.set_column(column, &slope);
        }
        Ok(slopes)
    }

    /// Σ Jᵀ w: the noise of q, q̇ and q̈ at each row that makes the relations ρ = C w.
    fn least_noise(
        &self,
        stretch: &Stretch,
        here: &Evaluated,
        w: &DVector<f64>,
    ) -> [DMatrix<f64>; 3] {
        let each = self.relations.len();
        let (times, channels) = (stretch.motions.len(), self.track.noise.ncols());
        let weighted = here.by_motion.each_ref().map(|slopes| {
            let mut sum = DMatrix::zeros(times, channels);
            for (row, w) in w.iter().enumerate() {
                let mut at = sum.row_mut(row / each);
                at += slopes.row(row) * *w;
            }
            sum * &self.track.noise
        });
        [0, 1, 2].map(|order| {
            let mut noise = DMatrix::zeros(times, channels);
            for (other, weighted) in weighted.iter().enumerate() {
                noise += &stretch.spread[3 * order + other] * weighted;
            }
            DMatrix::from_fn(times * each, channels, |row, channel| {
                noise[(row / each, channel)]
            })
        })
    }
}

/// L⁻¹ ρ.
fn whitened(factor: &Cholesky<f64, Dyn>, values: &DVector<f64>) -> DVector<f64> {
    let mut white = values.clone();
    factor.l_dirty().solve_lower_triangular_mut(&mut white);
    white
}
