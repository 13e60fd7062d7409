//! How many innovations tell something of their own.
//!
//! Innovations are white where the model and its levels are right. Where they follow each other, n of
//! them tell as much as n / (1 + 2 Σ ρₖ) that do not (G. E. P. Box, G. M. Jenkins and G. C. Reinsel,
//! *Time Series Analysis*, 4th edition, 2008, section 2.1).

use appell_estimate::{Estimation, Innovation};

use super::DiagnoseError;
use super::bench::Bench;
use super::evidence::Fitted;

/// Longest distance in samples over which they are compared.
const FARTHEST: usize = 100;
/// A correlation below so many of its standard deviations is none, nor is any farther on.
const NONE: f64 = 3.0;

/// Part of the samples that counts, from 0 to 1.
pub(super) fn independent(bench: &Bench<'_>, fitted: &Fitted) -> Result<f64, DiagnoseError> {
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let runs = estimation.innovations(&fitted.fit.values)?;
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

/// 1 + 2 Σ ρₖ over the distances at which samples follow each other.
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

    /// A sequence in which each number keeps a part of the one before it.
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
    fn white_samples_all_count() {
        let one = following(&[kept(0.0)]);
        assert!((one - 1.0).abs() < 1e-12, "{one}");
    }

    #[test]
    fn samples_that_follow_each_other_count_as_fewer() {
        // 1 + 2 Σ 0.8ᵏ = (1 + 0.8) / (1 − 0.8)
        let nine = following(&[kept(0.8)]);
        assert!((nine - 9.0).abs() < 0.9, "{nine}");
    }
}
