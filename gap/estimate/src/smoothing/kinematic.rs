//! Smoothing of integrated white noise: a motion whose derivative of order m is white noise.
//!
//! With m = 2 the acceleration is white, with m = 3 the jerk. Given noisy samples the mean of such
//! a motion is a smoothing spline of degree 2m − 1 (G. Wahba, 1978), with natural ends and a
//! diffuse initial state. It is found with its covariance by the square-root information smoother
//! (C. Paige and M. Saunders, 1977): one least-squares problem
//!
//! ```text
//! samples   (y_i − x_i) / σ                    one row where a value is there
//! motion    L_i⁻¹ (x_{i+1} − F_i x_i)          m rows, L Lᵀ = Q(step)
//! ```
//!
//! in the states x = (y, ẏ, …), made triangular from left to right by Householder reflections and
//! solved from right to left. Cost and memory are linear in the number of samples.

use super::samples::{Estimate, Samples, SamplesError, positive, within};

/// Highest order of the white derivative.
pub const MOST_ORDER: usize = 4;

/// Integrated white noise, measured with white noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematic {
    /// Order of the derivative that is white noise.
    order: usize,
    /// Standard deviation of the samples.
    std: f64,
    /// Intensity of the white noise, in squared units of the samples times s^(1 − 2 order).
    intensity: f64,
}

/// The smoothed motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Value and derivatives below the white one, at the times of the samples.
    pub estimate: Estimate,
    /// Log-likelihood of the samples, up to a constant, with a diffuse initial state.
    pub log_likelihood: f64,
}

impl Kinematic {
    /// A motion of a given intensity.
    pub fn new(order: usize, std: f64, intensity: f64) -> Result<Self, SamplesError> {
        Ok(Self {
            order: within("order", order, [1, MOST_ORDER])?,
            std: positive("noise level", std)?,
            intensity: positive("intensity", intensity)?,
        })
    }

    /// A motion by its smoothing time τ in s: the smoother scales a sine of angular frequency ω by
    /// 1/(1 + (ωτ)^2m).
    pub fn with_smoothing_time(
        order: usize,
        std: f64,
        tau: f64,
        samples: Samples<'_>,
    ) -> Result<Self, SamplesError> {
        let order = within("order", order, [1, MOST_ORDER])?;
        let tau = positive("smoothing time", tau)?;
        let present = samples.at_least(order + 1)?;
        let steps = samples.times().len() - 1;
        let step = samples.mean_step() * steps as f64 / (present - 1) as f64;
        Self::new(order, std, std * std * step / tau.powi(2 * exponent(order)))
    }

    /// The maximum-likelihood motion: its intensity, and the noise level if `std` is not given.
    ///
    /// The maximum is sought among smoothing times from a quarter of a step to the whole record.
    pub fn most_likely(
        order: usize,
        std: Option<f64>,
        samples: Samples<'_>,
    ) -> Result<Self, SamplesError> {
        let of = |tau: f64| Self::with_smoothing_time(order, std.unwrap_or(1.0), tau, samples);
        let free = samples.at_least(order + 2)? - order;
        let cost = |tau: f64| -> Result<f64, SamplesError> {
            let sweep = of(tau)?.sweep(samples, |_| ())?;
            Ok(match std {
                Some(_) => -sweep.log_likelihood(),
                None => sweep.cost_without_level(free),
            })
        };
        let tau = best_smoothing_time(samples, cost)?;
        let best = of(tau)?;
        if std.is_some() {
            return Ok(best);
        }
        let level = (best.sweep(samples, |_| ())?.squares / free as f64).sqrt();
        of(tau)?.scaled(level)
    }

    /// The same motion in samples `level` times as large.
    pub(super) fn scaled(self, level: f64) -> Result<Self, SamplesError> {
        Self::new(self.order, self.std * level, self.intensity * level * level)
    }

    /// Standard deviation of the samples.
    pub const fn std(&self) -> f64 {
        self.std
    }

    /// Intensity of the white noise.
    pub const fn intensity(&self) -> f64 {
        self.intensity
    }

    /// The motion at the times of the samples, also where values are missing.
    pub fn smooth(&self, samples: Samples<'_>) -> Result<Smoothed, SamplesError> {
        let mut rows: Vec<f64> = Vec::new();
        let sweep = self.sweep(samples, |row| rows.extend_from_slice(row))?;
        let estimate = self.backwards(samples, &rows)?;
        Ok(Smoothed {
            estimate,
            log_likelihood: sweep.log_likelihood(),
        })
    }

    /// Makes the least-squares problem triangular from left to right. `keep` sees the rows of each
    /// time, `[R S z]` of `R x_i + S x_{i+1} = z`, m rows of 2m + 1 columns.
    fn sweep(
        &self,
        samples: Samples<'_>,
        mut keep: impl FnMut(&[f64]),
    ) -> Result<Sweep, SamplesError> {
        let m = self.order;
        samples.at_least(m)?;
        let (times, values) = (samples.times(), samples.values());
        let (columns, rows) = (2 * m + 1, 2 * m + 1);
        let unit = unit_of(samples);
        let step_model = Step::new(m, self.intensity * unit.powi(2 * exponent(m) - 1));
        let mut a = vec![0.0; rows * columns];
        let mut sweep = Sweep::default();
        for row in 0..times.len() {
            // Rows 0…m hold the information of the past on x_i; row m the sample; the rest the
            // motion.
            a[m * columns..].fill(0.0);
            if !values[row].is_nan() {
                a[m * columns] = 1.0 / self.std;
                a[m * columns + 2 * m] = values[row] / self.std;
                sweep.log_weights -= self.std.ln();
            }
            if let Some(next) = times.get(row + 1) {
                let step = (next - times[row]) / unit;
                sweep.log_weights += step_model.fill(&mut a[(m + 1) * columns..], columns, step);
            }
            triangularise(&mut a, rows, columns, 2 * m);
            for k in 0..m {
                sweep.log_pivots += a[k * columns + k].abs().ln();
            }
            if !sweep.log_pivots.is_finite() {
                return Err(SamplesError::NotFinite { t: times[row] });
            }
            keep(&a[..m * columns]);
            sweep.squares += a[2 * m * columns + 2 * m].powi(2);
            if row + 1 == times.len() {
                // At the end all rows below are residuals.
                let rest = (m..2 * m).map(|k| a[k * columns + 2 * m].powi(2));
                sweep.squares += rest.sum::<f64>();
            }
            for k in 0..m {
                for j in 0..m {
                    a[k * columns + j] = a[(m + k) * columns + m + j];
                    a[k * columns + m + j] = 0.0;
                }
                a[k * columns + 2 * m] = a[(m + k) * columns + 2 * m];
            }
        }
        Ok(sweep)
    }

    /// Solves the triangular problem from right to left, with covariances.
    fn backwards(&self, samples: Samples<'_>, rows: &[f64]) -> Result<Estimate, SamplesError> {
        let m = self.order;
        let columns = 2 * m + 1;
        let times = samples.times();
        let unit = unit_of(samples);
        let mut estimate = Estimate::zeros(times.len(), m - 1);
        let (mut x, mut c) = (vec![0.0; m], vec![0.0; m * m]);
        for row in (0..times.len()).rev() {
            let a = &rows[row * m * columns..][..m * columns];
            // z − S x₊ and I + S C₊ Sᵀ; at the last time S is zero.
            let s = |i: usize, j: usize| a[i * columns + m + j];
            let mut right: Vec<f64> = (0..m).map(|i| a[i * columns + 2 * m]).collect();
            let mut spread = vec![0.0; m * m];
            for i in 0..m {
                for k in 0..m {
                    right[i] -= s(i, k) * x[k];
                }
                for j in 0..m {
                    let mut sum = f64::from(u8::from(i == j));
                    for k in 0..m {
                        for l in 0..m {
                            sum += s(i, k) * c[k * m + l] * s(j, l);
                        }
                    }
                    spread[i * m + j] = sum;
                }
            }
            back_substitute(a, columns, m, &mut right, 1);
            back_substitute(a, columns, m, &mut spread, m);
            transpose(&mut spread, m);
            back_substitute(a, columns, m, &mut spread, m);
            (x, c) = (right, spread);
            let (mean, covariance) = estimate.entry(row);
            let scale = |r: usize| unit.powi(-exponent(r));
            for i in 0..m {
                mean[i] = x[i] * scale(i);
                for j in 0..m {
                    // Symmetric despite rounding.
                    let entry = 0.5 * (c[i * m + j] + c[j * m + i]);
                    covariance[i * m + j] = entry * scale(i + j);
                }
            }
            if mean.iter().chain(&*covariance).any(|x| !x.is_finite()) {
                return Err(SamplesError::NotFinite { t: times[row] });
            }
        }
        Ok(estimate)
    }
}

/// Unit of time in s in which the numbers of a sweep are near one.
fn unit_of(samples: Samples<'_>) -> f64 {
    let step = samples.mean_step();
    if step > 0.0 { step } else { 1.0 }
}

fn exponent(order: usize) -> i32 {
    i32::try_from(order).unwrap_or(0)
}

/// Sums of a sweep.
#[derive(Default)]
struct Sweep {
    /// Remaining sum of squares.
    squares: f64,
    /// Logarithms of the pivots.
    log_pivots: f64,
    /// Logarithms of the determinants of the weights.
    log_weights: f64,
}

impl Sweep {
    fn log_likelihood(&self) -> f64 {
        self.log_weights - self.log_pivots - 0.5 * self.squares
    }

    /// Minus the logarithm of the likelihood at the best noise level, up to a constant.
    fn cost_without_level(&self, free: usize) -> f64 {
        self.log_pivots - self.log_weights + 0.5 * free as f64 * self.squares.ln()
    }
}

/// The rows of the motion over one step: L⁻¹ (x₊ − F x), with Q = L Lᵀ.
///
/// Q(h) = q D Q̂ D with D = diag(h^(m − 1/2 − a)) and a Q̂ independent of the step.
struct Step {
    m: usize,
    /// q.
    intensity: f64,
    /// L̂⁻¹ of Q̂ = L̂ L̂ᵀ, lower triangular.
    inverse: Vec<f64>,
}

impl Step {
    fn new(m: usize, intensity: f64) -> Self {
        let q = |a: usize, b: usize| {
            1.0 / (factorial(m - 1 - a) * factorial(m - 1 - b) * (2 * m - 1 - a - b) as f64)
        };
        let mut factor = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i * m + k] * factor[j * m + k]).sum();
                factor[i * m + j] = if i == j {
                    (q(i, i) - known).sqrt()
                } else {
                    (q(i, j) - known) / factor[j * m + j]
                };
            }
        }
        let mut inverse = vec![0.0; m * m];
        for column in 0..m {
            for i in column..m {
                let unit = f64::from(u8::from(i == column));
                let known: f64 = (column..i)
                    .map(|k| factor[i * m + k] * inverse[k * m + column])
                    .sum();
                inverse[i * m + column] = (unit - known) / factor[i * m + i];
            }
        }
        Self {
            m,
            intensity,
            inverse,
        }
    }

    /// Writes the rows; returns the logarithm of the determinant of L⁻¹.
    fn fill(&self, rows: &mut [f64], columns: usize, step: f64) -> f64 {
        let m = self.m;
        let root = self.intensity.sqrt();
        let mut log_determinant = 0.0;
        let weight = |i: usize, a: usize| {
            let power = step.powi(exponent(m) - exponent(a)) / step.sqrt();
            self.inverse[i * m + a] / (root * power)
        };
        for i in 0..m {
            for b in 0..m {
                rows[i * columns + m + b] = weight(i, b);
                let carried: f64 = (0..=b)
                    .map(|a| weight(i, a) * step.powi(exponent(b - a)) / factorial(b - a))
                    .sum();
                rows[i * columns + b] = -carried;
            }
            log_determinant += weight(i, i).ln();
        }
        log_determinant
    }
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// Makes the first `pivots` columns of a matrix upper triangular by Householder reflections.
fn triangularise(a: &mut [f64], rows: usize, columns: usize, pivots: usize) {
    for k in 0..pivots {
        let norm = (k..rows)
            .map(|i| a[i * columns + k].powi(2))
            .sum::<f64>()
            .sqrt();
        if norm <= 0.0 {
            continue;
        }
        let pivot = a[k * columns + k];
        let target = if pivot > 0.0 { -norm } else { norm };
        a[k * columns + k] = pivot - target;
        let beta = -1.0 / (target * (pivot - target));
        for j in k + 1..columns {
            let product: f64 = (k..rows)
                .map(|i| a[i * columns + k] * a[i * columns + j])
                .sum();
            for i in k..rows {
                a[i * columns + j] -= beta * product * a[i * columns + k];
            }
        }
        a[k * columns + k] = target;
        for i in k + 1..rows {
            a[i * columns + k] = 0.0;
        }
    }
}

/// Solves R X = B for B of `width` columns; R is stored in the first columns of the rows.
fn back_substitute(rows: &[f64], columns: usize, m: usize, b: &mut [f64], width: usize) {
    for j in 0..width {
        for i in (0..m).rev() {
            let known: f64 = (i + 1..m)
                .map(|k| rows[i * columns + k] * b[k * width + j])
                .sum();
            b[i * width + j] = (b[i * width + j] - known) / rows[i * columns + i];
        }
    }
}

fn transpose(a: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..i {
            a.swap(i * n + j, j * n + i);
        }
    }
}

/// Smoothing times tried per decade.
const TRIED_PER_DECADE: f64 = 4.0;
/// Golden-section steps: the smoothing time is found to a part in a thousand.
const SECTIONS: usize = 14;

/// The smoothing time in s with the smallest cost, from a quarter of a step to the whole record.
pub(super) fn best_smoothing_time(
    samples: Samples<'_>,
    cost: impl Fn(f64) -> Result<f64, SamplesError>,
) -> Result<f64, SamplesError> {
    let step = positive("record", samples.mean_step())?;
    let steps = (samples.times().len() - 1) as f64;
    let (low, high) = ((step / 4.0).ln(), (step * steps).ln());
    let spacing = 10f64.ln() / TRIED_PER_DECADE;
    let (mut best, mut at) = ((f64::INFINITY, low), low);
    while at < high + spacing {
        let found = cost(at.exp())?;
        if found < best.0 {
            best = (found, at);
        }
        at += spacing;
    }
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut left, mut right) = (best.1 - spacing, best.1 + spacing);
    let mut inner = [
        right - golden * (right - left),
        left + golden * (right - left),
    ];
    let mut costs = [cost(inner[0].exp())?, cost(inner[1].exp())?];
    for _ in 0..SECTIONS {
        if costs[0] < costs[1] {
            right = inner[1];
            inner = [right - golden * (right - left), inner[0]];
            costs = [cost(inner[0].exp())?, costs[0]];
        } else {
            left = inner[0];
            inner = [inner[1], left + golden * (right - left)];
            costs = [costs[1], cost(inner[1].exp())?];
        }
    }
    Ok((0.5 * (left + right)).exp())
}
