//! Results of an identification: intervals, correlation, determined combinations.

use appell_estimate::{
    Consistency, Coordinate, Estimation, Fit, Free, HALF_WIDTH_95, Sensitivity, Unknown,
    robust_covariance,
};
use appell_runtime::model::Quantity;
use appell_spectra::singular::Singular;
use nalgebra::DMatrix;
use serde::Serialize;

use super::IdentifyError;
use super::drift::Course;
use super::held_out::{HeldOut, Trace};
use super::problem::Problem;
use super::repeatability::Repeatability;
use appell_recordings::DataSet;

/// Length of the blocks of scores in s, beyond the correlation of errors of a mechanism.
const BLOCK: f64 = 1.0;
/// An estimated parameter.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Name, sentence and unit.
    pub quantity: Quantity,
    /// Nominal value in SI.
    pub nominal: f64,
    /// Prior standard deviation (tolerance) in SI, if any.
    pub tolerance: Option<f64>,
    /// Most likely value in SI.
    pub value: f64,
    /// Standard deviation in SI if the model is correct.
    pub std: f64,
    /// Robust (sandwich) standard deviation in SI.
    pub robust_std: f64,
    /// Whether the value is at a limit of its range; its uncertainty is undefined.
    pub at_limit: bool,
    /// Posterior standard deviation relative to the tolerance; near one the recordings are
    /// uninformative.
    pub left: Option<f64>,
}

impl Estimate {
    /// The wider of the two standard deviations.
    pub fn wider_std(&self) -> f64 {
        self.std.max(self.robust_std)
    }

    /// 95 % interval in SI, within the range of the quantity.
    pub fn interval95(&self) -> [f64; 2] {
        let [low, high] = self.quantity.range;
        let end = |sign| self.value + sign * HALF_WIDTH_95 * self.wider_std();
        [-1.0, 1.0].map(|sign| end(sign).max(low).min(high))
    }
}

/// A level of noise, before and after the parameters were fitted.
#[derive(Debug, Clone, Serialize)]
pub struct Level {
    /// Column or pseudo-velocity.
    pub name: String,
    /// Of the nominal model, in SI.
    pub nominal: f64,
    /// Of the fitted model, in SI.
    pub fitted: f64,
}

/// A combination of parameters, in units of their tolerances, and its uncertainty.
#[derive(Debug, Clone, Serialize)]
pub struct Known {
    /// Parts of the parameters, in the order of the estimates.
    pub parts: Vec<f64>,
    /// Standard deviation from the recordings alone, in units of the tolerance.
    #[serde(rename = "deviation_in_tolerances")]
    pub deviation: f64,
}

/// Result of an identification.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Whether the search ended at an optimum. If not, the last step, which was not taken, enlarges the deviations.
    pub is_optimum: bool,
    /// Parameters in the requested order.
    pub parameters: Vec<Estimate>,
    /// Correlation of their errors.
    pub correlation: DMatrix<f64>,
    /// Combinations of parameters, the best determined first.
    pub combinations: Vec<Known>,
    /// Noise of the channels.
    pub noise: Vec<Level>,
    /// Process noise: standard deviations of its integral over one second.
    pub disturbances: Vec<Level>,
    /// Log-likelihood of the nominal model with fitted noise, and of the fitted one.
    pub log_likelihoods: [f64; 2],
    /// Test of the innovations of each channel for whiteness.
    pub whiteness: Vec<(String, Consistency)>,
    /// Parameters in the single training runs; empty if there is only one run.
    pub repeatability: Vec<Repeatability>,
    /// Drifting parameters along the training runs.
    pub courses: Vec<Course>,
    /// Prediction errors on held-out runs; empty without any.
    pub held_out: Vec<HeldOut>,
    /// Channels of these runs with predictions.
    pub traces: Vec<Trace>,
}

impl Answer {
    pub(super) fn of(
        set: &DataSet,
        estimation: &Estimation<'_>,
        problem: &Problem,
        nominal: &Fit,
        fit: &Fit,
    ) -> Result<Self, IdentifyError> {
        let info = estimation.setup().model.info();
        let layout = estimation.layout();
        let count = problem.wanted.len();
        let sensitivity = Sensitivity::of(estimation, &fit.values, &fit.free)?;
        let covariance = fit.covariance()?;
        let robust = robust_covariance(fit, &sensitivity, block(estimation))?;
        let mut parameters = Vec::new();
        let wanted = problem.wanted.iter().zip(&problem.quantities);
        for (place, (free, quantity)) in wanted.enumerate() {
            let std = fit.deviation(place)?;
            let tolerance = free.prior.map(|[_, deviation]| deviation);
            parameters.push(Estimate {
                quantity: quantity.clone(),
                nominal: quantity.value,
                tolerance,
                value: fit.values[layout.place(free.unknown)?],
                std,
                robust_std: robust[(place, place)].sqrt(),
                at_limit: fit.at_limit[place],
                left: tolerance.map(|tolerance| std / tolerance),
            });
        }
        let correlation = DMatrix::from_fn(count, count, |i, j| {
            let size = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
            if size > 0.0 {
                covariance[(i, j)] / size
            } else {
                0.0
            }
        });
        let levels = |names: &[String], of: fn(usize) -> Unknown| {
            let levels = names.iter().enumerate().map(|(index, name)| {
                let place = layout.place(of(index))?;
                Ok(Level {
                    name: name.clone(),
                    nominal: nominal.values[place],
                    fitted: fit.values[place],
                })
            });
            levels.collect::<Result<Vec<Level>, IdentifyError>>()
        };
        let measured = set.measured(info);
        let columns: Vec<String> = measured.iter().map(|(c, _)| c.column.clone()).collect();
        let speeds = info.speed_quantities().iter();
        let speeds: Vec<String> = speeds.map(|speed| speed.name.to_string()).collect();
        Ok(Self {
            is_optimum: fit.is_optimum(),
            combinations: combinations(&sensitivity, &problem.wanted, fit.coordinates.as_slice()),
            noise: levels(&columns, Unknown::Noise)?,
            disturbances: levels(&speeds, Unknown::Disturbance)?,
            log_likelihoods: [nominal.log_likelihood, fit.log_likelihood],
            whiteness: whiteness(estimation, fit, &columns)?,
            repeatability: Vec::new(),
            courses: Vec::new(),
            held_out: Vec::new(),
            traces: Vec::new(),
            parameters,
            correlation,
        })
    }
}

/// Rows of a block.
fn block(estimation: &Estimation<'_>) -> usize {
    let runs = estimation.recordings().iter();
    let steps = runs.map(|run| {
        let times = run.times();
        (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64
    });
    let step = steps.fold(f64::INFINITY, f64::min);
    // Both are counts of rows in memory.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let rows = (BLOCK / step).ceil() as usize;
    rows.max(1)
}

/// Combinations of the parameters at fixed noise levels: the variances of innovations determine the levels
/// independently of the parameters.
///
/// From derivatives of whitened samples: the singular values of all of them, column by column in the scales of
/// the parameters. They have twice as many digits as eigenvalues of the information.
fn combinations(sensitivity: &Sensitivity, parameters: &[Free], coordinates: &[f64]) -> Vec<Known> {
    let places = parameters.iter().zip(coordinates);
    let scales: Vec<f64> = places
        .map(|(free, &coordinate)| match (free.prior, free.coordinate) {
            (Some([_, deviation]), _) => deviation,
            (None, Coordinate::Logarithm) => 1.0,
            (None, Coordinate::Plain) => free.to_value(coordinate).abs().max(f64::MIN_POSITIVE),
        })
        .collect();
    let (residuals, variances) = (&sensitivity.residuals, &sensitivity.variances);
    let rows = residuals.nrows();
    let slopes = DMatrix::from_fn(2 * rows, scales.len(), |i, j| {
        let part = if i < rows { residuals } else { variances };
        part[(i % rows, j)] * scales[j]
    });
    // A decomposition of the triangular factor is cheaper than one of all samples.
    let singular = Singular::of(&slopes.qr().r());
    let known = singular.values.iter().zip(singular.right.column_iter());
    let known = known.map(|(&value, parts)| Known {
        parts: parts.iter().copied().collect(),
        deviation: value.recip(),
    });
    known.collect()
}

fn whiteness(
    estimation: &Estimation<'_>,
    fit: &Fit,
    columns: &[String],
) -> Result<Vec<(String, Consistency)>, IdentifyError> {
    let runs = estimation.innovations(&fit.values)?;
    let of_channel = |(channel, column): (usize, &String)| {
        let all = runs.iter().flatten();
        let own = all.filter(|innovation| innovation.channel == channel);
        (column.clone(), Consistency::of(own, 0.99))
    };
    Ok(columns.iter().enumerate().map(of_channel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_data_cannot_tell_is_told_as_a_combination() {
        // The sum p + 2 q alone matters.
        let sensitivity = Sensitivity {
            samples: Vec::new(),
            residuals: DMatrix::from_fn(3, 2, |i, j| (i + 1) as f64 * (j + 1) as f64),
            variances: DMatrix::zeros(3, 2),
        };
        let free = [0, 1].map(|index| Free {
            coordinate: Coordinate::Logarithm,
            ..Free::of(Unknown::Parameter(index))
        });
        let told = combinations(&sensitivity, &free, &[0.0, 0.0]);
        let [known, unknown] = told.as_slice() else {
            panic!("{told:?}");
        };
        assert!(
            (known.deviation * 70f64.sqrt() - 1.0).abs() < 1e-9,
            "{known:?}"
        );
        assert!(unknown.deviation > 1e12, "{unknown:?}");
        let along = (2.0 * unknown.parts[0] - unknown.parts[1]) / 5f64.sqrt();
        assert!((along.abs() - 1.0).abs() < 1e-9, "{unknown:?}");
    }
}
