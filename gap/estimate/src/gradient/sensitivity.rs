//! Derivatives of all innovations with respect to the values: scores sample by sample, and Fisher
//! information.

use nalgebra::DMatrix;

use crate::EstimateError;
use crate::estimation::Estimation;
use crate::fitting::free::{Free, Selection};
use crate::kalman::filter::Innovation;

/// Derivatives of the whitened samples with respect to the coordinates of some values.
///
/// By central differences of the filter, to about eight digits, which suffices for information,
/// screening and covariances. Optima are found with the exact gradient.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// The samples, run by run, in the order of rows and channels; with the run of each.
    pub samples: Vec<(usize, Innovation)>,
    /// Derivatives of the white residuals, each divided by the standard deviation of its sample: a
    /// row for each sample, a column for each value.
    pub residuals: DMatrix<f64>,
    /// Derivatives of the logarithms of the white variances, divided by √2.
    pub variances: DMatrix<f64>,
}

impl Sensitivity {
    /// About some values.
    pub fn of(
        estimation: &Estimation<'_>,
        values: &[f64],
        free: &[Free],
    ) -> Result<Self, EstimateError> {
        let selection = Selection::new(&estimation.layout(), free)?;
        let samples = ordered(estimation, values)?;
        let (rows, columns) = (samples.len(), free.len());
        let mut residuals = DMatrix::zeros(rows, columns);
        let mut variances = DMatrix::zeros(rows, columns);
        for column in 0..columns {
            let (ends, width) = differences(estimation, &selection, values, column)?;
            for (row, (_, sample)) in samples.iter().enumerate() {
                let [below, above] = [ends[0][row].1, ends[1][row].1];
                let by_residual = (above.white_residual - below.white_residual) / width;
                let by_variance = (above.white_variance / below.white_variance).ln() / width;
                residuals[(row, column)] = by_residual / sample.white_variance.sqrt();
                variances[(row, column)] = by_variance / std::f64::consts::SQRT_2;
            }
        }
        Ok(Self {
            samples,
            residuals,
            variances,
        })
    }

    /// Fisher information of the data: the expected curvature of the negative log-likelihood.
    pub fn information(&self) -> DMatrix<f64> {
        self.residuals.tr_mul(&self.residuals) + self.variances.tr_mul(&self.variances)
    }

    /// Gradient of the log-likelihood of each sample: a row for each.
    pub fn scores(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.samples.len(), self.residuals.ncols(), |row, column| {
            let e = self.samples[row].1.whitened();
            let by_variance = (e * e - 1.0) / std::f64::consts::SQRT_2;
            by_variance * self.variances[(row, column)] - e * self.residuals[(row, column)]
        })
    }
}

/// All samples in the order of runs, rows and channels: delays may change the order in time.
fn ordered(
    estimation: &Estimation<'_>,
    values: &[f64],
) -> Result<Vec<(usize, Innovation)>, EstimateError> {
    let runs = estimation.innovations(values)?.into_iter().enumerate();
    let mut samples: Vec<_> = runs
        .flat_map(|(run, samples)| samples.into_iter().map(move |sample| (run, sample)))
        .collect();
    samples.sort_by_key(|(run, sample)| (*run, sample.row, sample.channel));
    Ok(samples)
}

type Ends = [Vec<(usize, Innovation)>; 2];

/// The samples on both sides of a coordinate; on one side at a limit of the admissible values.
fn differences(
    estimation: &Estimation<'_>,
    selection: &Selection<'_>,
    values: &[f64],
    index: usize,
) -> Result<(Ends, f64), EstimateError> {
    let change = selection.free[index].small_change(selection.value(values, index));
    let at = |change: f64| ordered(estimation, &selection.changed(values, index, change));
    let above = at(change)?;
    match at(-change) {
        Ok(below) => Ok(([below, above], 2.0 * change)),
        Err(_) => Ok(([at(0.0)?, above], change)),
    }
}
