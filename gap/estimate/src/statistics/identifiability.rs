//! Combinations of values that the data determine.

use nalgebra::{DMatrix, DVector};

use appell_spectra::singular::Singular;

use crate::fitting::free::{Coordinate, Free};

/// A combination of values that the data determine independently of all others.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// Components of the values in units of their scales; a vector of length 1.
    pub parts: DVector<f64>,
    /// Standard deviation of the combination from the data alone, in the scales of the values;
    /// infinite if undetermined.
    pub deviation: f64,
}

impl Combination {
    /// Whether the data determine it better than the scales (priors).
    pub fn is_known(&self) -> bool {
        self.deviation < 1.0
    }
}

/// Identifiability of some values.
#[derive(Debug, Clone, PartialEq)]
pub struct Identifiability {
    /// Scale of each value in its coordinate: its prior standard deviation, or else its magnitude.
    pub scales: DVector<f64>,
    /// Combinations, the best determined first.
    pub combinations: Vec<Combination>,
}

impl Identifiability {
    /// Of the values `free`, which are `values` in SI, one each.
    ///
    /// From derivatives of whitened samples ([`Sensitivity`](crate::Sensitivity)): the singular
    /// values of all of them, column by column in the scales of the values. Singular values of the
    /// derivatives have twice as many digits as eigenvalues of the information.
    pub fn of(sensitivity: &crate::Sensitivity, values: &[f64], free: &[Free]) -> Self {
        let scale = |(free, &value): (&Free, &f64)| match (free.prior, free.coordinate) {
            (Some([_, deviation]), _) => deviation,
            (None, Coordinate::Logarithm) => 1.0,
            (None, Coordinate::Plain) => value.abs().max(f64::MIN_POSITIVE),
        };
        let scales = DVector::from_iterator(free.len(), free.iter().zip(values).map(scale));
        let (residuals, variances) = (&sensitivity.residuals, &sensitivity.variances);
        let rows = residuals.nrows();
        let slopes = DMatrix::from_fn(2 * rows, free.len(), |i, j| {
            let part = if i < rows { residuals } else { variances };
            part[(i % rows, j)] * scales[j]
        });
        // A decomposition of the triangular factor is cheaper than one of all samples.
        let singular = Singular::of(&slopes.qr().r());
        let combinations = singular.values.iter().enumerate();
        let combinations = combinations.map(|(k, &value)| Combination {
            parts: singular.right.column(k).into_owned(),
            deviation: value.recip(),
        });
        Self {
            combinations: combinations.collect(),
            scales,
        }
    }

    /// Number of combinations that the data determine better than the scales.
    pub fn rank(&self) -> usize {
        let combinations = self.combinations.iter();
        combinations
            .filter(|combination| combination.is_known())
            .count()
    }
}
