//! The noise level of samples, without a model of the measured quantity.
//!
//! Both methods assume white noise. For sensors with internal filtering the estimated level is too
//! small, and smoothing with it too weak.

use super::samples::Samples;

/// Highest order of the differences.
const MOST_ORDER: usize = 10;
/// Least number of differences.
const FEWEST: usize = 12;
/// Largest number of differences used.
const MOST: usize = 100_000;
/// Significance, in standard deviations, of a difference of two levels. One suffices, as levels of
/// neighbouring orders are correlated.
const CHANCE: f64 = 1.0;
/// One in this many differences, the largest, is left out, as it may be an impact.
const LEFT_OUT: usize = 10;
/// Mean square of the smallest nine tenths of standard normal numbers.
const NORMAL_TRIMMED: f64 = 0.623_01;
/// Ratio of the variances of a trimmed and a full mean square.
const TRIMMED_SPREAD: f64 = 1.3;

/// A noise level from differences.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Differences {
    /// Standard deviation.
    pub std: f64,
    /// Its relative standard deviation.
    pub relative_error: f64,
    /// Whether differences of the order below agree. Otherwise the motion is too fast for the
    /// sampling, and the level an upper bound.
    pub settled: bool,
}

/// The level from differences of neighbouring samples; `None` if there are too few.
///
/// A difference of order k takes out polynomials of degree k − 1 and, scaled, keeps the variance of
/// white noise. The order is raised until the level no longer falls significantly. The largest
/// tenth of the differences is left out, as a protection against impacts.
pub fn from_differences(records: &[Samples<'_>]) -> Option<Differences> {
    let records: Vec<(Vec<f64>, Vec<f64>)> = records.iter().map(|r| r.present().unzip()).collect();
    let mut found = level(&records, 1)?;
    for order in 2..=MOST_ORDER {
        let Some(next) = level(&records, order) else {
            break;
        };
        let chance = CHANCE * found.relative_error.hypot(next.relative_error);
        let settled = next.std >= found.std * (1.0 - chance);
        found = Differences { settled, ..next };
        if settled {
            break;
        }
    }
    Some(found)
}

fn level(records: &[(Vec<f64>, Vec<f64>)], order: usize) -> Option<Differences> {
    let all: usize = records.iter().map(|(times, _)| times.len()).sum();
    let every = all.div_ceil(MOST).max(1);
    let mut sizes: Vec<f64> = Vec::new();
    for (times, values) in records {
        for start in (0..times.len().saturating_sub(order)).step_by(every) {
            let range = start..=start + order;
            let size = difference(&times[range.clone()], &values[range]).abs();
            if size.is_finite() {
                sizes.push(size);
            }
        }
    }
    if sizes.len() < FEWEST {
        return None;
    }
    let count = sizes.len();
    let kept = count - count / LEFT_OUT;
    sizes.select_nth_unstable_by(kept - 1, f64::total_cmp);
    let mean_square = sizes[..kept].iter().map(|x| x * x).sum::<f64>() / kept as f64;
    // Neighbouring differences share samples; Σρ² gives their effective number.
    let shared = choose(4 * order, 2 * order) / choose(2 * order, order).powi(2);
    Some(Differences {
        std: (mean_square / NORMAL_TRIMMED).sqrt(),
        relative_error: TRIMMED_SPREAD * (0.5 * shared / count as f64).sqrt(),
        settled: false,
    })
}

/// The divided difference over all samples, scaled so that the squares of its weights sum to one.
fn difference(times: &[f64], values: &[f64]) -> f64 {
    let unit = (times[times.len() - 1] - times[0]) / times.len() as f64;
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let others = times.iter().enumerate().filter(|(j, _)| *j != i);
        let weight: f64 = others.map(|(_, t)| unit / (times[i] - t)).product();
        sum += weight * (value - values[0]);
        squares += weight * weight;
    }
    sum / squares.sqrt()
}

/// Binomial coefficient.
fn choose(n: usize, k: usize) -> f64 {
    (1..=k).map(|i| (n - k + i) as f64 / i as f64).product()
}

/// Number of samples of a segment that is tested for standstill.
const STRETCH: usize = 40;
/// The ratio of J. von Neumann (1941) is 2 for white noise and falls with every motion; for a segment
/// of 40 samples its standard deviation is 0.3.
const AT_REST: f64 = 1.4;
/// Least number of segments at rest.
const FEWEST_STRETCHES: usize = 4;

/// The level at standstill: the standard deviation in segments whose samples vary like white noise
/// about a constant. `None` if there are too few.
pub fn at_standstill(records: &[Samples<'_>]) -> Option<f64> {
    let (mut stretches, mut squares) = (0, 0.0);
    for record in records {
        let values: Vec<f64> = record.present().map(|(_, value)| value).collect();
        for stretch in values.chunks_exact(STRETCH) {
            let mean = stretch.iter().sum::<f64>() / STRETCH as f64;
            let about_mean: f64 = stretch.iter().map(|y| (y - mean).powi(2)).sum();
            let steps: f64 = stretch.windows(2).map(|y| (y[1] - y[0]).powi(2)).sum();
            if steps >= AT_REST * about_mean {
                stretches += 1;
                squares += about_mean;
            }
        }
    }
    let free = (stretches * (STRETCH - 1)) as f64;
    (stretches >= FEWEST_STRETCHES).then(|| (squares / free).sqrt())
}
