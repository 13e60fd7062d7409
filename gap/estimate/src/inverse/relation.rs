//! Input-free relations of a motion, with derivatives.
//!
//! With P the projection with P E = 0, the relations are
//!
//! ```text
//! ρ(q, q̇, q̈, p) = N₀ᵀ P e,   e = M ω̇ + b − Π₀
//! ```
//!
//! N₀ is fixed, so that they depend smoothly on the motion. Near the truth e = E û, and dρ = nᵀ d(M
//! ω̇ + b − Π(û)) with n = P N₀ and û held: a sum that [`Model::adjoint`] differentiates.

use nalgebra::{DMatrix, DVector};

use super::{InputEquations, InverseError, ZERO};
use appell_runtime::model::{At, Gradient, Model};
use appell_spectra::singular::Singular;

/// Measured coordinates of a motion with their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Time in s.
    pub t: f64,
    /// q, q̇ and q̈ in SI.
    pub derivatives: [DVector<f64>; 3],
}

/// A sample of a motion with its pseudo-accelerations, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Time in s.
    pub t: f64,
    /// State.
    pub x: Vec<f64>,
    /// Pseudo-accelerations ω̇, one per pseudo-velocity.
    pub accelerations: Vec<f64>,
    /// Inputs and signals.
    pub u: Vec<f64>,
}

/// Quantities of the equations at a motion, and their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Their values.
    pub values: DVector<f64>,
    /// Derivatives with respect to q, q̇ and q̈: a row for each quantity.
    pub by_motion: [DMatrix<f64>; 3],
    /// Derivatives with respect to the parameters.
    pub by_parameters: DMatrix<f64>,
}

/// The state of a motion, and the quantities from which it follows.
struct Place {
    x: Vec<f64>,
    u: Vec<f64>,
    accelerations: DVector<f64>,
    /// T⁺ of q̇ = T ω.
    inverse: DMatrix<f64>,
    /// ∂q̇/∂q of the measured coordinates.
    carried: DMatrix<f64>,
    /// q̇ of all coordinates.
    rates: Vec<f64>,
    equations: InputEquations,
    /// û, by least squares.
    inputs: DVector<f64>,
    /// E⁺.
    reach: DMatrix<f64>,
}

/// The relations of a model whose measured coordinates determine its motion.
pub struct Relations<'a> {
    model: &'a dyn Model,
    /// Measured coordinates, by their index among the coordinates.
    measured: Vec<usize>,
    /// N₀: a column for each relation.
    reference: DMatrix<f64>,
}

impl<'a> Relations<'a> {
    /// Of a model, about a representative motion and parameters.
    pub fn new(
        model: &'a dyn Model,
        measured: &[usize],
        motion: &Motion,
        p: &[f64],
    ) -> Result<Self, InverseError> {
        let info = model.info();
        let coordinates = info.state_len() - info.speeds;
        if let Some(&index) = measured.iter().find(|&&index| index >= coordinates) {
            return Err(InverseError::NoCoordinate { index, coordinates });
        }
        if info.explicit_time || !info.signals.is_empty() {
            return Err(InverseError::Driven);
        }
        let mut relations = Self {
            model,
            measured: measured.to_vec(),
            reference: DMatrix::zeros(info.speeds, 0),
        };
        let place = relations.place(motion, p)?;
        relations.reference = place.equations.relations().transpose();
        Ok(relations)
    }

    /// Number of relations.
    pub fn len(&self) -> usize {
        self.reference.ncols()
    }

    /// Whether there are none, as the inputs can produce any motion.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Measured coordinates, by their index among the coordinates.
    pub fn measured(&self) -> &[usize] {
        &self.measured
    }

    /// The model.
    pub fn model(&self) -> &'a dyn Model {
        self.model
    }

    /// The relations at a motion: zero for the true model.
    pub fn at(&self, motion: &Motion, p: &[f64]) -> Result<Rows, InverseError> {
        let place = self.place(motion, p)?;
        let e = place.demand();
        let residual = &e - &place.equations.inputs * &place.inputs;
        let onto = &place.equations.inputs * (&place.reach * &self.reference);
        let rows = &self.reference - onto;
        Ok(self.differentiate(&place, p, self.reference.tr_mul(&residual), &rows))
    }

    /// The inputs of each motion, by least squares weighted by the noise of the motion, with their
    /// covariance. `spread` is the covariance of (q, q̇, q̈).
    pub fn inputs(
        &self,
        motion: &Motion,
        p: &[f64],
        spread: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, DMatrix<f64>), InverseError> {
        let place = self.place(motion, p)?;
        let e = place.demand();
        let all = self.differentiate(&place, p, e.clone(), &DMatrix::identity(e.len(), e.len()));
        let [q, v, a] = &all.by_motion;
        let slopes = DMatrix::from_fn(e.len(), 3 * q.ncols(), |i, j| {
            let by = [q, v, a][j / q.ncols()];
            by[(i, j % q.ncols())]
        });
        let covariance = &slopes * spread * slopes.transpose();
        let weights = covariance.try_inverse().ok_or(InverseError::Singular)?;
        let reach = &place.equations.inputs;
        let information = reach.tr_mul(&weights) * reach;
        let covariance = information.try_inverse().ok_or(InverseError::Singular)?;
        Ok((&covariance * reach.tr_mul(&weights) * e, covariance))
    }

    /// State and pseudo-accelerations of a motion; the inputs are those that it takes.
    pub fn moment(&self, motion: &Motion, p: &[f64]) -> Result<Moment, InverseError> {
        let place = self.place(motion, p)?;
        Ok(Moment {
            t: motion.t,
            x: place.x,
            accelerations: place.accelerations.as_slice().to_vec(),
            u: place.u,
        })
    }

    /// State, pseudo-accelerations and inputs of a motion.
    fn place(&self, motion: &Motion, p: &[f64]) -> Result<Place, InverseError> {
        let info = self.model.info();
        let (n, s, m) = (info.state_len(), info.speeds, info.input_len());
        let [q, v, a] = &motion.derivatives;
        let mut x = info.initial_state();
        x[..s].fill(0.0);
        for (&index, value) in self.measured.iter().zip(q.iter()) {
            x[s + index] = *value;
        }
        let mut u = vec![0.0; m];
        let (mut rates, mut a_matrix, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
        let at = |x: &[f64], u: &[f64], rates: &mut [f64], a: &mut [f64], b: &mut [f64]| {
            let at = At {
                t: motion.t,
                x,
                u,
                p,
            };
            self.model.jacobians(at, rates, a, b);
        };
        at(&x, &u, &mut rates, &mut a_matrix, &mut b);
        let entry = |a: &[f64], i: usize, j: usize| a[(s + self.measured[i]) * n + j];
        let rows = self.measured.len();
        let turn = DMatrix::from_fn(rows, s, |i, j| entry(&a_matrix, i, j));
        let inverse = pseudo_inverse(&turn, s)?;
        for (x, speed) in x.iter_mut().zip((&inverse * v).iter()) {
            *x = *speed;
        }
        at(&x, &u, &mut rates, &mut a_matrix, &mut b);
        let by_coordinates = DMatrix::from_fn(rows, n - s, |i, j| entry(&a_matrix, i, s + j));
        let carried = by_coordinates.select_columns(&self.measured);
        let transported = by_coordinates * DVector::from_column_slice(&rates[s..]);
        let accelerations = &inverse * (a - transported);
        let here = At {
            t: motion.t,
            x: &x,
            u: &u,
            p,
        };
        let equations = InputEquations::at(self.model, here)?;
        let demand = &equations.mass * &accelerations + &equations.free;
        let singular = Singular::of(&equations.inputs);
        let rank = singular.rank(ZERO);
        if !self.reference.is_empty() && s - rank != self.len() {
            let (found, expected) = (s - rank, self.len());
            return Err(InverseError::OtherKind { found, expected });
        }
        let reach = singular.inverse(rank);
        let inputs = &reach * demand;
        u[..inputs.len()].copy_from_slice(inputs.as_slice());
        Ok(Place {
            x,
            u,
            accelerations,
            inverse,
            carried,
            rates: rates[s..].to_vec(),
            equations,
            inputs,
            reach,
        })
    }

    /// Derivatives of Nᵀ (M ω̇ + b − Π(û)) for the columns of N, with û held.
    fn differentiate(
        &self,
        place: &Place,
        p: &[f64],
        values: DVector<f64>,
        rows: &DMatrix<f64>,
    ) -> Rows {
        let (count, measured) = (rows.ncols(), self.measured.len());
        let zero = || DMatrix::zeros(count, measured);
        let mut all = Rows {
            values,
            by_motion: [zero(), zero(), zero()],
            by_parameters: DMatrix::zeros(count, p.len()),
        };
        let s = self.model.info().speeds;
        for (row, n) in rows.column_iter().enumerate() {
            // μ: derivatives with respect to q̈.
            let inertia = place.equations.mass.tr_mul(&n);
            let by_acceleration = place.inverse.tr_mul(&inertia);
            // M (ω̇ − ω̇ of the model) is M ω̇ + b − Π: its derivative in two parts.
            let weights = self.weights(place, &n.into_owned(), &inertia, &by_acceleration, p);
            let (by_x, mut by_p) = self.pull(&weights, place, p);
            let by_speed = DVector::from_column_slice(&by_x[..s]);
            let by_rate = place.inverse.tr_mul(&by_speed);
            let mut by_q = self.measured_part(&by_x[s..]);
            // ω follows from q̇ through T, which depends on q and p.
            let mut weights = vec![0.0; weights.len()];
            for (&index, weight) in self.measured.iter().zip(by_rate.iter()) {
                weights[s + index] = -weight;
            }
            let (by_x, by_p_of_rates) = self.pull(&weights, place, p);
            by_q += self.measured_part(&by_x[s..]);
            by_p += by_p_of_rates;
            let by_v = &by_rate - place.carried.tr_mul(&by_acceleration);
            all.by_motion[0].set_row(row, &by_q.transpose());
            all.by_motion[1].set_row(row, &by_v.transpose());
            all.by_motion[2].set_row(row, &by_acceleration.transpose());
            all.by_parameters.set_row(row, &by_p.transpose());
        }
        all
    }

    /// Weights of ẋ, A and M whose sum has the derivatives of nᵀ (M ω̇ + b − Π) with q̈ held.
    fn weights(
        &self,
        place: &Place,
        n: &DVector<f64>,
        inertia: &DVector<f64>,
        by_acceleration: &DVector<f64>,
        p: &[f64],
    ) -> Vec<f64> {
        let info = self.model.info();
        let (states, s) = (info.state_len(), info.speeds);
        let mut modelled = vec![0.0; states];
        self.model.rates(place.at(p), &mut modelled);
        let mass = states * (1 + states + info.input_len());
        let mut weights = vec![0.0; mass + s * s];
        for i in 0..s {
            weights[i] = -inertia[i];
            for j in 0..s {
                weights[mass + i * s + j] = n[i] * (place.accelerations[j] - modelled[j]);
            }
        }
        // q̈ = T ω̇ + (∂q̇/∂q) q̇: with q̈ held, ω̇ compensates changes of both.
        for (&index, weight) in self.measured.iter().zip(by_acceleration.iter()) {
            let row = &mut weights[states + (s + index) * states..][..states];
            for j in 0..s {
                row[j] = -weight * place.accelerations[j];
            }
            for (entry, rate) in row[s..].iter_mut().zip(&place.rates) {
                *entry = -weight * rate;
            }
        }
        weights
    }

    /// The gradient of a weighted sum with respect to the state and the parameters.
    fn pull(&self, weights: &[f64], place: &Place, p: &[f64]) -> (Vec<f64>, DVector<f64>) {
        let (mut x, mut u) = (vec![0.0; place.x.len()], vec![0.0; place.u.len()]);
        let mut by_p = DVector::zeros(p.len());
        let by = Gradient {
            x: &mut x,
            u: &mut u,
            p: by_p.as_mut_slice(),
        };
        self.model.adjoint(place.at(p), weights, by);
        (x, by_p)
    }

    fn measured_part(&self, coordinates: &[f64]) -> DVector<f64> {
        let values = self.measured.iter().map(|&index| coordinates[index]);
        DVector::from_iterator(self.measured.len(), values)
    }
}

impl Place {
    /// Where the model is evaluated.
    fn at<'a>(&'a self, p: &'a [f64]) -> At<'a> {
        At {
            t: 0.0,
            x: &self.x,
            u: &self.u,
            p,
        }
    }

    /// e.
    fn demand(&self) -> DVector<f64> {
        &self.equations.mass * &self.accelerations + &self.equations.free
    }
}

/// T⁺; an error if the rates do not determine the pseudo-velocities.
fn pseudo_inverse(turn: &DMatrix<f64>, speeds: usize) -> Result<DMatrix<f64>, InverseError> {
    let singular = Singular::of(turn);
    let rank = singular.rank(ZERO);
    if rank < speeds {
        let unknowns = speeds;
        return Err(InverseError::Undetermined { rank, unknowns });
    }
    Ok(singular.inverse(rank))
}
