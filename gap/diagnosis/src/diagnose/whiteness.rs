//! Effective sample size of innovations.
//!
//! Innovations are white if the model and its noise levels are right. If they are autocorrelated, n of
//! them count as n / (1 + 2 Σ ρₖ) independent ones (G. E. P. Box, G. M. Jenkins and G. C. Reinsel,
//! *Time Series Analysis*, 4th edition, 2008, section 2.1).

use appell_estimate::Innovation;

use super::{Bench, Fitted, Result};

/// Largest lag in samples.
const FARTHEST: usize = 100;
/// Significance of a correlation in standard deviations; lags after the first insignificant one do not count.
const NONE: f64 = 3.0;

/// Effective sample size relative to the number of samples, from 0 to 1.
pub(super) fn independent(bench: &Bench<'_>, fitted: &Fitted) -> Result<f64> {
    let runs = bench.innovations(fitted)?;
    let (mut counted, mut all) = (0.0, 0.0);
    for channel in 0..bench.measured.len() {
        let own = |run: &Vec<Innovation>| -> Vec<f64> {
            let own = run.iter().filter(|sample| sample.channel == channel);
            own.map(Innovation::whitened).collect()
        };
        let series: Vec<Vec<f64>> = runs.iter().map(own).collect();
        let samples = series.iter().map(Vec::len).sum::<usize>() as f64;
        counted += samples / following(&series);
        all += samples;
    }
    Ok(if all > 0.0 { counted / all } else { 1.0 })
}

/// 1 + 2 Σ ρₖ over the lags with a significant correlation.
fn following(series: &[Vec<f64>]) -> f64 {
    let together = |distance: usize| {
        let (mut sum, mut pairs) = (0.0, 0.0);
        for run in series {
            for (a, b) in run.iter().zip(run.iter().skip(distance)) {
                sum += a * b;
                pairs += 1.0;
            }
        }
        (sum, pairs)
    };
    let (energy, samples) = together(0);
    let mut sum = 1.0;
    for distance in 1..=FARTHEST {
        let (product, pairs) = together(distance);
        let correlation = product / energy * samples / f64::max(pairs, 1.0);
        if correlation.is_nan() || correlation * samples.sqrt() < NONE {
            break;
        }
        sum += 2.0 * correlation;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An autoregressive sequence of first order.
    fn kept(part: f64) -> Vec<f64> {
        let mut random = fastrand::Rng::with_seed(5);
        let mut last = 0.0;
        let mut next = || {
            last = part * last + random.f64() - 0.5;
            last
        };
        (0..20_000).map(|_| next()).collect()
    }

    #[test]
    fn samples_that_follow_each_other_count_as_fewer() {
        // 1 + 2 Σ 0.8ᵏ = (1 + 0.8) / (1 − 0.8)
        for (part, expected, error) in [(0.0, 1.0, 1e-12), (0.8, 9.0, 0.9)] {
            let found = following(&[kept(part)]);
            assert!((found - expected).abs() < error, "{found}");
        }
    }
}
