//! Base parameters from recordings: estimates, and residuals of the equations.

use appell_estimate::HALF_WIDTH_95;
use appell_estimate::inverse::Motion;
use appell_recordings::Part;
use appell_runtime::model::Model;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::adjustment::adjust;
use super::error::BaseError;
use super::moments::{Recorded, Stretch, moment};

use super::Structure;
use super::equations::{Equations, LinearEquations};

/// The estimate of a base parameter.
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
    /// Whether the value differs significantly from zero.
    pub fn is_told(&self) -> bool {
        self.interval95[0] > 0.0 || self.interval95[1] < 0.0
    }
}

/// Residuals of the equation of a pseudo-velocity: root mean squares of forces, in SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Speed {
    /// Name of the pseudo-velocity.
    #[serde(rename = "pseudo_velocity")]
    pub name: String,
    /// The generalised force of the recorded inputs.
    pub inputs: f64,
    /// The residual with the parameters of the spec.
    pub nominal: f64,
    /// The residual with the estimates.
    pub left: f64,
}

/// Base parameters from recordings.
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
    /// The residual with the parameters of the spec.
    nominal: DVector<f64>,
    /// The generalised force of the inputs.
    inputs: DVector<f64>,
}

pub(super) fn fit(
    equations: &Equations,
    structure: &Structure,
    recorded: &Recorded<'_>,
    model: &dyn Model,
    p: &[f64],
) -> Result<Fit, BaseError> {
    let speeds = model.info().speeds;
    let leading: Vec<usize> = structure.base.iter().map(|base| base.leading).collect();
    let equation = |motion: &Motion| {
        let moment = moment(&recorded.relations, motion, p)?;
        let linear = equations.at(&moment, &moment.u, p);
        Ok(LinearEquations {
            regressor: linear.regressor.select_columns(&leading),
            ..linear
        })
    };
    let start = DVector::from_iterator(leading.len(), structure.base.iter().map(|own| own.nominal));
    let all: Vec<Rows> = (recorded.stretches.iter())
        .map(|stretch| rows(equations, &leading, stretch, model, p))
        .collect();
    if all.iter().all(|rows| rows.right.iter().all(|r| *r == 0.0)) {
        let parameters = gains(equations, structure, recorded, model, p);
        return Err(BaseError::Scale { parameters });
    }
    let adjusted = adjust(recorded, &equation, start, speeds)?;
    let training: Vec<&Rows> = all.iter().filter(|rows| rows.part == Part::Fit).collect();
    let test: Vec<&Rows> = all.iter().filter(|rows| rows.part == Part::Test).collect();
    let estimates = adjusted.values.iter().zip(adjusted.deviations.iter());
    let estimates = estimates.map(|(&value, &std)| Estimate {
        value,
        std,
        interval95: [-1.0, 1.0].map(|side| value + side * HALF_WIDTH_95 * std),
    });
    Ok(Fit {
        estimates: estimates.collect(),
        training: residuals(&training, &adjusted.values, model),
        test: residuals(&test, &adjusted.values, model),
        motions: training.iter().map(|rows| rows.right.len() / speeds).sum(),
        condition: adjusted.condition,
    })
}

/// The parameters that multiply inputs.
fn gains(
    equations: &Equations,
    structure: &Structure,
    recorded: &Recorded<'_>,
    model: &dyn Model,
    p: &[f64],
) -> Vec<String> {
    let mut moments = recorded.stretches.iter().flat_map(|own| &own.moments);
    let Some(moment) = moments.next() else {
        return Vec::new();
    };
    let columns = |input: f64| {
        let mut u = moment.u.clone();
        u[..model.info().declared_inputs].fill(input);
        equations.at(moment, &u, p).regressor
    };
    let change = columns(1.0) - columns(0.0);
    let parameters = structure.parameters.iter().zip(change.column_iter());
    parameters
        .filter(|(_, column)| column.amax() > 0.0)
        .map(|(parameter, _)| parameter.name.clone())
        .collect()
}

fn rows(
    equations: &Equations,
    leading: &[usize],
    stretch: &Stretch,
    model: &dyn Model,
    p: &[f64],
) -> Rows {
    let speeds = model.info().speeds;
    let count = stretch.moments.len() * speeds;
    let mut rows = Rows {
        part: stretch.part,
        base: DMatrix::zeros(count, leading.len()),
        right: DVector::zeros(count),
        nominal: DVector::zeros(count),
        inputs: DVector::zeros(count),
    };
    for (place, moment) in stretch.moments.iter().enumerate() {
        let linear = equations.at(moment, &moment.u, p);
        let mut without = moment.u.clone();
        without[..model.info().declared_inputs].fill(0.0);
        let free = equations.at(moment, &without, p);
        let values = DVector::from_column_slice(&linear.values);
        let nominal = &linear.regressor * values + &linear.rest;
        let first = place * speeds;
        rows.base
            .rows_mut(first, speeds)
            .copy_from(&linear.regressor.select_columns(leading));
        rows.right.rows_mut(first, speeds).copy_from(&-&linear.rest);
        rows.nominal.rows_mut(first, speeds).copy_from(&nominal);
        let inputs = free.rest - linear.rest;
        rows.inputs.rows_mut(first, speeds).copy_from(&inputs);
    }
    rows
}

/// Residuals of each equation; empty where there is no stretch.
fn residuals(stretches: &[&Rows], values: &DVector<f64>, model: &dyn Model) -> Vec<Speed> {
    let info = model.info();
    if stretches.is_empty() {
        return Vec::new();
    }
    let root_mean_square = |speed: usize, of: &dyn Fn(&Rows) -> DVector<f64>| {
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for rows in stretches {
            for f in of(rows).iter().skip(speed).step_by(info.speeds) {
                sum += f * f;
                count += 1.0;
            }
        }
        (sum / count.max(1.0)).sqrt()
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
