//! Base parameters by weighted least squares.

use appell_estimate::HALF_WIDTH_95;
use appell_recordings::Part;
use appell_runtime::model::{At, Model};
use nalgebra::{DMatrix, DVector};

use super::error::BaseError;
use super::moments::Stretch;
use super::{Equations, Structure};

/// How often the weights are taken from the residuals.
const PASSES: usize = 3;
/// Eigenvalues of the normalised information below this part of the largest are zero.
const ZERO: f64 = 1e-12;

/// A base parameter by the recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Value in SI.
    pub value: f64,
    /// Standard deviation in SI.
    pub std: f64,
    /// 95 % interval in SI.
    pub interval95: [f64; 2],
}

impl Estimate {
    /// Whether the recordings tell the value from zero.
    pub fn is_told(&self) -> bool {
        self.interval95[0] > 0.0 || self.interval95[1] < 0.0
    }
}

/// How well the equation of a pseudo-velocity holds: root mean squares of forces, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Speed {
    /// Name of the pseudo-velocity.
    pub name: String,
    /// What the motions of the part take by the recorded inputs.
    pub inputs: f64,
    /// What is left with the parameters of the spec.
    pub nominal: f64,
    /// What is left with the estimates.
    pub left: f64,
}

/// Base parameters by recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// In the order of the structure.
    pub estimates: Vec<Estimate>,
    /// Residuals of training runs by pseudo-velocity.
    pub training: Vec<Speed>,
    /// Residuals of test runs, where there are any.
    pub test: Vec<Speed>,
    /// Motions that were used.
    pub motions: usize,
    /// Condition number of the regressor with columns of equal length.
    pub condition: f64,
}

/// The equations `Y_b β = −r` of a stretch, a row for each pseudo-velocity of each motion.
struct Rows {
    part: Part,
    base: DMatrix<f64>,
    right: DVector<f64>,
    /// What is left with the parameters of the spec.
    nominal: DVector<f64>,
    /// What the inputs do.
    inputs: DVector<f64>,
}

pub(super) fn fit(
    equations: &Equations,
    structure: &Structure,
    stretches: &[Stretch],
    model: &dyn Model,
    p: &[f64],
) -> Result<Fit, BaseError> {
    let speeds = model.info().speeds;
    let all: Vec<Rows> = (stretches.iter())
        .map(|stretch| rows(equations, structure, stretch, model, p))
        .collect();
    let training: Vec<&Rows> = all.iter().filter(|rows| rows.part == Part::Fit).collect();
    let test: Vec<&Rows> = all.iter().filter(|rows| rows.part == Part::Test).collect();
    let mut variances = DVector::repeat(speeds, 1.0);
    let mut solved = solve(&training, &variances, structure.base.len())?;
    for _ in 0..PASSES {
        variances = variances_of(&training, &solved.values, speeds);
        solved = solve(&training, &variances, structure.base.len())?;
    }
    let covariance = solved.covariance(&training, &variances);
    let estimates = (0..solved.values.len()).map(|i| {
        let (value, std) = (solved.values[i], covariance[(i, i)].sqrt());
        Estimate {
            value,
            std,
            interval95: [-1.0, 1.0].map(|side| value + side * HALF_WIDTH_95 * std),
        }
    });
    let told = |rows: &[&Rows]| match rows {
        [] => Vec::new(),
        rows => told(rows, &solved.values, model),
    };
    Ok(Fit {
        estimates: estimates.collect(),
        training: told(&training),
        test: told(&test),
        motions: training.iter().map(|rows| rows.right.len() / speeds).sum(),
        condition: solved.condition,
    })
}

fn rows(
    equations: &Equations,
    structure: &Structure,
    stretch: &Stretch,
    model: &dyn Model,
    p: &[f64],
) -> Rows {
    let speeds = model.info().speeds;
    let leading: Vec<usize> = structure.base.iter().map(|base| base.leading).collect();
    let count = stretch.moments.len() * speeds;
    let mut rows = Rows {
        part: stretch.part,
        base: DMatrix::zeros(count, leading.len()),
        right: DVector::zeros(count),
        nominal: DVector::zeros(count),
        inputs: DVector::zeros(count),
    };
    for (place, moment) in stretch.moments.iter().enumerate() {
        let at = |u| At {
            t: moment.t,
            x: &moment.x,
            u,
            p,
        };
        let linear = equations.at(at(&moment.u), &moment.accelerations);
        let mut without = moment.u.clone();
        without[..model.info().declared_inputs].fill(0.0);
        let free = equations.at(at(&without), &moment.accelerations);
        let values = DVector::from_column_slice(&linear.values);
        let nominal = &linear.regressor * values + &linear.rest;
        let first = place * speeds;
        rows.base
            .rows_mut(first, speeds)
            .copy_from(&linear.regressor.select_columns(&leading));
        rows.right.rows_mut(first, speeds).copy_from(&-&linear.rest);
        rows.nominal.rows_mut(first, speeds).copy_from(&nominal);
        let inputs = free.rest - linear.rest;
        rows.inputs.rows_mut(first, speeds).copy_from(&inputs);
    }
    rows
}

struct Solved {
    values: DVector<f64>,
    /// Inverse of the information.
    inverse: DMatrix<f64>,
    condition: f64,
}

/// Rows of a stretch with each pseudo-velocity's row over its standard deviation.
fn weighted(rows: &Rows, variances: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let (mut base, mut right) = (rows.base.clone(), rows.right.clone());
    for (i, mut row) in base.row_iter_mut().enumerate() {
        let weight = 1.0 / variances[i % variances.len()].sqrt();
        row *= weight;
        right[i] *= weight;
    }
    (base, right)
}

fn solve(stretches: &[&Rows], variances: &DVector<f64>, count: usize) -> Result<Solved, BaseError> {
    let (mut information, mut reached) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for rows in stretches {
        let (base, right) = weighted(rows, variances);
        information += base.tr_mul(&base);
        reached += base.tr_mul(&right);
    }
    // Columns of equal length, so that units do not matter.
    let scale = information.diagonal().map(|square| match square {
        square if square > 0.0 => 1.0 / square.sqrt(),
        _ => 0.0,
    });
    let scaled = DMatrix::from_fn(count, count, |i, j| {
        scale[i] * information[(i, j)] * scale[j]
    });
    let eigen = scaled.symmetric_eigen();
    let (largest, smallest) = (eigen.eigenvalues.max(), eigen.eigenvalues.min());
    let rank = (eigen.eigenvalues.iter())
        .filter(|&&value| value > ZERO * largest)
        .count();
    if rank < count {
        return Err(BaseError::TooLittle { rank, count });
    }
    let inverse = &eigen.eigenvectors
        * DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| 1.0 / value))
        * eigen.eigenvectors.transpose();
    let inverse = DMatrix::from_fn(count, count, |i, j| scale[i] * inverse[(i, j)] * scale[j]);
    Ok(Solved {
        values: &inverse * reached,
        inverse,
        condition: (largest / smallest).sqrt(),
    })
}

impl Solved {
    /// Covariance where stretches are independent of each other, whatever is correlated within them.
    fn covariance(&self, stretches: &[&Rows], variances: &DVector<f64>) -> DMatrix<f64> {
        let count = self.values.len();
        let mut spread = DMatrix::zeros(count, count);
        for rows in stretches {
            let (base, right) = weighted(rows, variances);
            let score = base.tr_mul(&(right - &base * &self.values));
            spread += &score * score.transpose();
        }
        // As many scores as stretches stand for their variance.
        let correction = stretches.len() as f64 / (stretches.len() as f64 - 1.0).max(1.0);
        &self.inverse * (spread * correction) * &self.inverse
    }
}

/// Mean square of the residuals by pseudo-velocity.
fn variances_of(stretches: &[&Rows], values: &DVector<f64>, speeds: usize) -> DVector<f64> {
    let squares = |speed| {
        let (mut sum, mut count) = (0.0, 0.0);
        for rows in stretches {
            let left = &rows.right - &rows.base * values;
            for square in left
                .iter()
                .skip(speed)
                .step_by(speeds)
                .map(|left| left * left)
            {
                sum += square;
                count += 1.0;
            }
        }
        f64::max(sum / f64::max(count, 1.0), f64::MIN_POSITIVE)
    };
    DVector::from_fn(speeds, |speed, _| squares(speed))
}

fn told(stretches: &[&Rows], values: &DVector<f64>, model: &dyn Model) -> Vec<Speed> {
    let info = model.info();
    let root_mean_square = |speed: usize, of: &dyn Fn(&Rows) -> DVector<f64>| {
        let own = stretches.iter().flat_map(|rows| {
            let all = of(rows);
            let own: Vec<f64> = all
                .iter()
                .skip(speed)
                .step_by(info.speeds)
                .copied()
                .collect();
            own
        });
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), f| (sum + f * f, count + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    };
    let speeds = info.speed_quantities().iter().enumerate();
    speeds
        .map(|(speed, quantity)| Speed {
            name: quantity.name.to_string(),
            inputs: root_mean_square(speed, &|rows| rows.inputs.clone()),
            nominal: root_mean_square(speed, &|rows| rows.nominal.clone()),
            left: root_mean_square(speed, &|rows| &rows.right - &rows.base * values),
        })
        .collect()
}
