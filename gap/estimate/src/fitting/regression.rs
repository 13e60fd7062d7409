//! Parameters by inverse dynamics, from motions with known accelerations, without a filter.
//!
//! Appell's equations at a sample, M ω̇ + b − Π = 0, are linear in inertial parameters and nearly
//! so in others near their values. Which combinations occur in them at all are the base parameters
//! (M. Gautier, *Numerical calculation of the base inertial parameters of robots*, 1991). Noise in
//! the regressors biases least squares; instruments, regressors of a motion without that noise,
//! avoid the bias (A. Janot, P. O. Vandanjon and M. Gautier, *A generic instrumental variable
//! approach for industrial robot identification*, 2014).

use nalgebra::{DMatrix, DVector};

use appell_runtime::model::{At, Model};

use crate::EstimateError;

/// Step of a central difference relative to a parameter. A linear function has no truncation error.
const STEP: f64 = 1e-5;

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

/// The linear equations `regressors · change = −residuals` of a change of some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Regression {
    /// Derivatives of the residuals by the parameters: a row for each equation of each moment.
    pub regressors: DMatrix<f64>,
    /// M ω̇ + b − Π at the parameters, in the units of the equations.
    pub residuals: DVector<f64>,
}

impl Regression {
    /// The equations of some moments about parameter values `p`, for the parameters `of`.
    pub fn about(
        model: &dyn Model,
        moments: &[Moment],
        p: &[f64],
        of: &[usize],
    ) -> Result<Self, EstimateError> {
        let (info, s) = (model.info(), model.info().speeds);
        for &index in of {
            let len = info.parameter_len();
            if index >= len {
                let what = "parameter";
                return Err(EstimateError::Unknown { what, index, len });
            }
        }
        for moment in moments {
            let lengths = [
                ("state of a moment", moment.x.len(), info.state_len()),
                ("accelerations of a moment", moment.accelerations.len(), s),
                ("inputs of a moment", moment.u.len(), info.input_len()),
                ("parameters", p.len(), info.parameter_len()),
            ];
            for (what, found, columns) in lengths {
                if found != columns {
                    return Err(EstimateError::Lengths {
                        what,
                        rows: 1,
                        columns,
                        found,
                    });
                }
            }
        }
        let mut equations = Equations::new(model);
        let mut regressors = DMatrix::zeros(moments.len() * s, of.len());
        let mut residuals = DVector::zeros(moments.len() * s);
        let mut varied = p.to_vec();
        for (place, moment) in moments.iter().enumerate() {
            let rows = place * s;
            residuals
                .rows_mut(rows, s)
                .copy_from(&equations.residual(moment, p));
            for (column, &index) in of.iter().enumerate() {
                let h = STEP * p[index].abs().max(STEP);
                varied[index] = p[index] + h;
                let above = equations.residual(moment, &varied);
                varied[index] = p[index] - h;
                let slope = (above - equations.residual(moment, &varied)) / (2.0 * h);
                varied[index] = p[index];
                regressors
                    .view_mut((rows, column), (s, 1))
                    .copy_from(&slope);
            }
        }
        Ok(Self {
            regressors,
            residuals,
        })
    }

    /// The change of the parameters by least squares, with its covariance.
    pub fn least_squares(&self) -> Result<(DVector<f64>, DMatrix<f64>), EstimateError> {
        self.instrumental(&self.regressors)
    }

    /// The change of the parameters by instrumental variables, as many columns as parameters, such
    /// as regressors of a simulated motion. The covariance is that of independent heteroscedastic
    /// residuals (H. White, 1980).
    pub fn instrumental(
        &self,
        instruments: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, DMatrix<f64>), EstimateError> {
        let inverse = instruments.tr_mul(&self.regressors).try_inverse();
        let inverse = inverse.ok_or(EstimateError::Singular {
            what: "the product of instruments and regressors",
        })?;
        let change = -(&inverse * instruments.tr_mul(&self.residuals));
        let left = &self.residuals + &self.regressors * &change;
        let mut weighted = instruments.clone();
        for (mut row, left) in weighted.row_iter_mut().zip(left.iter()) {
            row *= *left;
        }
        let covariance = &inverse * weighted.tr_mul(&weighted) * inverse.transpose();
        Ok((change, covariance))
    }
}

/// The equations of motion at a moment.
struct Equations<'a> {
    model: &'a dyn Model,
    mass: Vec<f64>,
    bias: Vec<f64>,
    forces: Vec<f64>,
}

impl<'a> Equations<'a> {
    fn new(model: &'a dyn Model) -> Self {
        let s = model.info().speeds;
        Self {
            model,
            mass: vec![0.0; s * s],
            bias: vec![0.0; s],
            forces: vec![0.0; s],
        }
    }

    /// M ω̇ + b − Π.
    fn residual(&mut self, moment: &Moment, p: &[f64]) -> DVector<f64> {
        let at = At {
            t: moment.t,
            x: &moment.x,
            u: &moment.u,
            p,
        };
        let (mass, bias, forces) = (&mut self.mass, &mut self.bias, &mut self.forces);
        self.model.appell(at, mass, bias, forces);
        let s = bias.len();
        DVector::from_fn(s, |i, _| {
            let row = &self.mass[i * s..(i + 1) * s];
            let inertial = crate::matrix::dot(row, &moment.accelerations);
            inertial + self.bias[i] - self.forces[i]
        })
    }
}

/// Base parameters, and the combinations of the others that they include.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// Columns that are independent of each other, in the order in which they were found.
    pub independent: Vec<usize>,
    /// The other columns.
    pub dependent: Vec<usize>,
    /// Regressors of the dependent columns are those of the independent ones times these: a row for
    /// each independent column. Base parameter i is `p_i + Σ combinations[(i, j)] p_j`.
    pub combinations: DMatrix<f64>,
}

impl BaseParameters {
    /// Of regressors at many moments. A column counts as dependent on those before it if its remainder is less
    /// than the fraction `part` of it, such as 1e-8.
    pub fn of(regressors: &DMatrix<f64>, part: f64) -> Self {
        let mut directions: Vec<DVector<f64>> = Vec::new();
        let (mut independent, mut open) = (Vec::new(), Vec::new());
        for (place, column) in regressors.column_iter().enumerate() {
            let length = column.norm();
            let mut rest = column.into_owned();
            // Orthogonalised twice, which is enough (W. Kahan).
            for direction in directions.iter().chain(&directions) {
                rest.axpy(-direction.dot(&rest), direction, 1.0);
            }
            if rest.norm() > part * length {
                directions.push(rest.normalize());
                independent.push(place);
            } else {
                open.push(place);
            }
        }
        if independent.is_empty() {
            return Self {
                combinations: DMatrix::zeros(0, open.len()),
                dependent: open,
                independent,
            };
        }
        let basis = regressors.select_columns(&independent);
        let others = regressors.select_columns(&open);
        let qr = basis.qr();
        let right = qr.q().tr_mul(&others);
        let combinations = qr.r().solve_upper_triangular(&right).unwrap_or(right);
        Self {
            independent,
            dependent: open,
            combinations,
        }
    }
}
