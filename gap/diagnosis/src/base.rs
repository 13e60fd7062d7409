//! Base parameters: the identifiable combinations of inertial parameters and of load parameters (M. Gautier,
//! *Numerical calculation of the base inertial parameters of robots*, 1991), and their estimates from recorded
//! motions with recorded inputs.
//!
//! Inverse dynamics is linear in these parameters, M ω̇ + b − Π = Y π + r, and vanishes for the true ones. Columns of
//! Y that are linearly dependent at all motions belong to the same combination. Recorded motions give equations
//! `Y_b β = −r`: splines filter coordinates and inputs alike, their noise is in `Y_b` as well as in r (`adjustment.rs`), and
//! blocks of the recordings are taken as independent of each other (K.-Y. Liang, S. L. Zeger, 1986).

mod adjustment;
mod equations;
mod error;
mod moments;
mod regression;

use appell_codegen::mechanics::{Linear, Regressor};
use appell_estimate::BaseParameters;
use appell_recordings::DataSet;
use appell_runtime::model::Model;
use nalgebra::DMatrix;

use equations::Equations;

pub use error::BaseError;
pub(crate) use moments::recorded;
pub use regression::{Estimate, Fit, Speed};

/// A column is dependent if its orthogonal remainder is smaller than this part of it.
const DEPENDENT: f64 = 1e-8;
/// A coefficient of a combination below this part of the largest is rounding.
const ROUNDING: f64 = 1e-9;
/// Number of random motions per parameter.
const MOTIONS: usize = 4;

/// A combination of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// The parameter that it is named after.
    pub leading: usize,
    /// Others with their factors, by their index.
    pub others: Vec<(usize, f64)>,
    /// Its value by the parameters of the spec, in SI.
    pub nominal: f64,
}

/// The parameters of the inverse dynamics and their identifiable combinations.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// All parameters on which they depend linearly.
    pub parameters: Vec<Linear>,
    /// Their values by the spec, in SI.
    pub values: Vec<f64>,
    /// The base parameters.
    pub base: Vec<Combination>,
    /// Inertial parameters that no motion depends on.
    pub without_effect: Vec<String>,
}

impl Structure {
    /// A combination as a sum, such as `Izz_1 + 0.25 m_2`.
    pub fn text(&self, combination: &Combination) -> String {
        let leading = &self.parameters[combination.leading].name;
        match self.others(combination).as_str() {
            "" => leading.clone(),
            others => format!("{leading} {others}"),
        }
    }

    /// The terms of a combination after its leading parameter, such as `+ 0.25 m_2`.
    pub fn others(&self, combination: &Combination) -> String {
        let others = combination.others.iter().map(|&(other, factor)| {
            let sign = if factor < 0.0 { '−' } else { '+' };
            let (name, size) = (&self.parameters[other].name, factor.abs());
            if (size - 1.0).abs() < ROUNDING {
                format!("{sign} {name}")
            } else {
                format!("{sign} {} {name}", shortened(size))
            }
        });
        others.collect::<Vec<_>>().join(" ")
    }
}

/// A number with at most six digits.
fn shortened(value: f64) -> String {
    let digits = 5.0 - value.abs().log10().floor().clamp(-12.0, 12.0);
    let scale = 10_f64.powf(digits);
    format!("{}", (value * scale).round() / scale)
}

/// Finds the base parameters with the parameters `p` of the spec, in SI.
pub fn structure(
    model: &dyn Model,
    regressor: &Regressor,
    p: &[f64],
) -> Result<Structure, BaseError> {
    let equations = Equations::new(regressor);
    let count = regressor.parameters.len();
    if count == 0 {
        return Err(BaseError::NoParameter);
    }
    let mut rows = DMatrix::zeros(0, count);
    let mut values = Vec::new();
    for moment in moments::random(model, MOTIONS * count, p) {
        let linear = equations.at(&moment, &moment.u, p);
        if linear.regressor.iter().all(|entry| entry.is_finite()) {
            let (before, more) = (rows.nrows(), linear.regressor.nrows());
            rows = rows.insert_rows(before, more, 0.0);
            rows.rows_mut(before, more).copy_from(&linear.regressor);
            values = linear.values;
        }
    }
    let found = BaseParameters::of(&rows, DEPENDENT);
    let base = found.independent.iter().enumerate().map(|(row, &leading)| {
        let factors = found.combinations.row(row);
        let others = found.dependent.iter().copied().zip(factors.iter().copied());
        let others: Vec<(usize, f64)> = others
            .filter(|&(_, factor)| factor.abs() > ROUNDING * found.combinations.amax())
            .collect();
        let shares = others.iter().map(|&(other, factor)| factor * values[other]);
        Combination {
            leading,
            nominal: values[leading] + shares.sum::<f64>(),
            others,
        }
    });
    Ok(Structure {
        parameters: regressor.parameters.clone(),
        base: base.collect(),
        values,
        without_effect: regressor.without_effect.clone(),
    })
}

/// Estimates base parameters from the recordings of a data set.
pub fn fit(
    set: &DataSet,
    model: &dyn Model,
    regressor: &Regressor,
    structure: &Structure,
) -> Result<Fit, BaseError> {
    if let Some(run) = set.runs.iter().find(|run| !run.differences.is_empty()) {
        return Err(BaseError::Differs {
            run: run.name.clone(),
        });
    }
    let p: Vec<f64> = set.parameters.iter().map(|own| own.value).collect();
    let recorded = moments::recorded(set, model, &p)?;
    regression::fit(&Equations::new(regressor), structure, &recorded, model, &p)
}
