//! Which combinations of values the data determine, and which they do not.

use nalgebra::{DMatrix, DVector};

use appell_spectra::singular::Singular;

use crate::fitting::free::{Coordinate, Free};

/// A combination of values that the data know independently of all others.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// Parts of the values, each in its own scale; of length 1 together.
    pub parts: DVector<f64>,
    /// Standard deviation to which the data alone determine the combination, in the scales of the
    /// values; infinite where they do not.
    pub deviation: f64,
}

impl Combination {
    /// Whether the data say more about it than the scales do.
    pub fn is_known(&self) -> bool {
        self.deviation < 1.0
    }
}

/// What data say about some values.
#[derive(Debug, Clone, PartialEq)]
pub struct Identifiability {
    /// Scale of each value in its coordinate: what is known of it beforehand, or else its size.
    pub scales: DVector<f64>,
    /// Combinations, the best known first.
    pub combinations: Vec<Combination>,
}

impl Identifiability {
    /// Of the values `free`, which are `values` in SI, one each.
    ///
    /// From derivatives of whitened samples ([`Sensitivity`](crate::Sensitivity)): the singular
    /// values of all of them, column by column in the scales of the values. Singular values of the
    /// derivatives themselves tell twice as many digits as those of the information.
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
        // Rotations of a triangle are cheaper than those of all samples.
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

    /// How many combinations the data determine better than the scales.
    pub fn rank(&self) -> usize {
        let combinations = self.combinations.iter();
        combinations
            .filter(|combination| combination.is_known())
            .count()
    }
}
