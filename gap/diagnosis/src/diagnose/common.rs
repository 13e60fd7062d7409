//! Sizes of an effect at a group of sites that may be one and the same, such as the delay of all drives or of the position
//! and the rate from one encoder. The evidence of a common size against separate ones is the ratio of the posterior and
//! prior densities of their differences at zero (J. M. Dickey, *The weighted likelihood ratio, linear hypotheses on normal
//! location parameters*, The Annals of Mathematical Statistics 42, 1971).

use std::f64::consts::{LN_2, TAU};

use appell_estimate::Fit;
use nalgebra::{DMatrix, DVector};

/// Change of the log evidence if the values of a fit with these places and log prior densities may be separate or the
/// same, with the same probability; none if they are not determined.
pub(super) fn of_group(fit: &Fit, places: &[(usize, f64)]) -> f64 {
    let covariance = fit.covariance().ok();
    let gain = covariance.and_then(|own| of_common(&fit.coordinates, &own, places));
    gain.map_or(0.0, |gain| {
        gain.max(0.0) + (-gain.abs()).exp().ln_1p() - LN_2
    })
}

/// Log evidence of a common value against separate ones with these places and log prior densities.
fn of_common(
    values: &DVector<f64>,
    covariance: &DMatrix<f64>,
    places: &[(usize, f64)],
) -> Option<f64> {
    let (&(first, _), others) = places.split_first()?;
    let differences = DVector::from_iterator(
        others.len(),
        others
            .iter()
            .map(|&(other, _)| values[other] - values[first]),
    );
    let between = |i: usize, j: usize| {
        let (i, j) = (others[i].0, others[j].0);
        covariance[(i, j)] - covariance[(i, first)] - covariance[(first, j)]
            + covariance[(first, first)]
    };
    let factor = DMatrix::from_fn(others.len(), others.len(), between).cholesky()?;
    let squares = differences.dot(&factor.solve(&differences));
    let posterior = -0.5 * (others.len() as f64 * TAU.ln() + factor.ln_determinant() + squares);
    Some(posterior - others.iter().map(|(_, density)| density).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two values with unit deviations and uniform priors of width w, by the integrals themselves.
    #[test]
    fn the_ratio_of_densities_is_that_of_the_integrals() {
        let (width, covariance) = (20.0_f64, DMatrix::identity(2, 2));
        for difference in [0.0, 1.0, 4.0] {
            let values = DVector::from_vec(vec![10.0, 10.0 + difference]);
            let places = [(0, -width.ln()), (1, -width.ln())];
            let found = of_common(&values, &covariance, &places).expect("a ratio");
            let (steps, mut common) = (20_000, 0.0);
            for step in 0..steps {
                let x = width * (f64::from(step) + 0.5) / f64::from(steps);
                let squares = (x - values[0]).powi(2) + (x - values[1]).powi(2);
                common += (-0.5 * squares).exp() / f64::from(steps);
            }
            let separate = TAU / width.powi(2);
            let expected = (common / separate).ln();
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }
}
