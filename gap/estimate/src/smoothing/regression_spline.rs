//! Least-squares splines: polynomials of degree five between equal knots, with four continuous
//! derivatives (C. de Boor, *A Practical Guide to Splines*, 1978).
//!
//! Quantities that are sampled together share the knots. The splines are then the same linear
//! filter for all, and linear equations with constant coefficients between the quantities hold
//! between the splines, too.

use nalgebra::DMatrix;

/// Degree of the polynomials.
const DEGREE: usize = 5;
/// Functions that are not zero between two knots.
const LIVE: usize = DEGREE + 1;
/// Pivots below this fraction of the largest mean that a coefficient is undetermined.
const OPEN: f64 = 1e-10;

/// The basis functions `N_i`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Basis {
    start: f64,
    spacing: f64,
    intervals: usize,
}

impl Basis {
    /// Between two times in s, with knots about `spacing` apart; `None` unless the time between them and the spacing are
    /// positive and finite.
    pub(crate) fn between([first, last]: [f64; 2], spacing: f64) -> Option<Self> {
        let is_positive = |length: f64| length > 0.0 && length.is_finite();
        let length = last - first;
        if !is_positive(length) || !is_positive(spacing) {
            return None;
        }
        let wanted = (length / spacing).round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive; a cast to an integer saturates"
        )]
        let intervals = (wanted as usize).max(1);
        Some(Self {
            start: first,
            spacing: length / intervals as f64,
            intervals,
        })
    }

    /// Number of functions.
    const fn count(&self) -> usize {
        self.intervals.saturating_add(DEGREE)
    }

    /// The middles between the knots, in s.
    pub(crate) fn middles(&self) -> impl Iterator<Item = f64> {
        let Self { start, spacing, .. } = *self;
        (0..self.intervals).map(move |i| start + (i as f64 + 0.5) * spacing)
    }

    /// The first function that is not zero at a time, and the derivative of an order of it and of
    /// those that follow.
    pub(crate) fn at(&self, t: f64, order: usize) -> (usize, [f64; LIVE]) {
        let place = (t - self.start) / self.spacing;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the intervals"
        )]
        let interval = place.clamp(0.0, (self.intervals - 1) as f64) as usize;
        let u = place - interval as f64;
        let order = order.min(DEGREE);
        let mut value = [0.0; LIVE];
        value[0] = 1.0;
        // N_k(x) = (x N_{k−1}(x) + (k + 1 − x) N_{k−1}(x − 1)) / k, at x = u + k − j.
        for k in 1..=DEGREE - order {
            let degree = k as f64;
            for j in (0..=k).rev() {
                let before = if j == 0 { 0.0 } else { value[j - 1] };
                let same = if j == k { 0.0 } else { value[j] };
                let shift = j as f64;
                value[j] = ((u + degree - shift) * before + (1.0 + shift - u) * same) / degree;
            }
        }
        // N_k′(x) = N_{k−1}(x) − N_{k−1}(x − 1).
        for k in DEGREE - order + 1..=DEGREE {
            for j in (0..=k).rev() {
                let before = if j == 0 { 0.0 } else { value[j - 1] };
                let same = if j == k { 0.0 } else { value[j] };
                value[j] = (before - same) / self.spacing;
            }
        }
        (interval, value)
    }
}

/// Splines through samples of several quantities.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RegressionSpline {
    basis: Basis,
    /// R of the samples of the functions, B = Q R: row i holds columns i, i + 1, …
    triangle: Vec<[f64; LIVE]>,
    /// Coefficients: a row for each function, a column for each quantity.
    coefficients: DMatrix<f64>,
    /// Squares and products of the residuals.
    pub(crate) residual: DMatrix<f64>,
    /// Degrees of freedom: samples minus coefficients.
    pub(crate) freedom: usize,
}

impl RegressionSpline {
    /// Fits increasing times and their values, a row for each time. `None` if the samples do not
    /// determine the splines.
    pub(crate) fn fit(basis: Basis, times: &[f64], values: &DMatrix<f64>) -> Option<Self> {
        // Before memory is taken: knots may be many more than samples where runs have different clocks.
        if basis.count() > times.len() {
            return None;
        }
        let (n, quantities) = (basis.count(), values.ncols());
        let mut triangle = vec![[0.0; LIVE]; n];
        let mut right = DMatrix::zeros(n, quantities);
        let mut residual = DMatrix::zeros(quantities, quantities);
        for (row, &t) in times.iter().enumerate() {
            let (first, mut functions) = basis.at(t, 0);
            let mut sample = values.row(row).into_owned();
            for k in 0..LIVE {
                // Rotates the row of the sample into the rows of R from `first` on.
                let pivot = &mut triangle[first + k];
                let length = f64::hypot(pivot[0], functions[k]);
                if length <= 0.0 {
                    continue;
                }
                let (cos, sin) = (pivot[0] / length, functions[k] / length);
                for (j, pivot) in pivot.iter_mut().enumerate().take(LIVE - k) {
                    let (above, own) = (*pivot, functions[k + j]);
                    *pivot = cos * above + sin * own;
                    functions[k + j] = cos * own - sin * above;
                }
                for (quantity, own) in sample.iter_mut().enumerate() {
                    let above = right[(first + k, quantity)];
                    right[(first + k, quantity)] = cos * above + sin * *own;
                    *own = cos * *own - sin * above;
                }
            }
            residual += sample.transpose() * sample;
        }
        let largest = triangle.iter().fold(0.0, |most: f64, row| most.max(row[0]));
        if triangle.iter().any(|row| row[0] <= OPEN * largest) {
            return None;
        }
        let mut coefficients = right;
        for quantity in 0..quantities {
            for i in (0..n).rev() {
                let known: f64 = (1..LIVE.min(n - i))
                    .map(|k| triangle[i][k] * coefficients[(i + k, quantity)])
                    .sum();
                let entry = &mut coefficients[(i, quantity)];
                *entry = (*entry - known) / triangle[i][0];
            }
        }
        Some(Self {
            basis,
            triangle,
            coefficients,
            residual,
            freedom: times.len().saturating_sub(n),
        })
    }

    /// The functions.
    pub(crate) const fn basis(&self) -> Basis {
        self.basis
    }

    /// The derivative of an order of each quantity at a time.
    pub(crate) fn derivative(&self, t: f64, order: usize) -> Vec<f64> {
        let (first, functions) = self.basis.at(t, order);
        let of = |quantity: usize| {
            let functions = functions.iter().enumerate();
            functions
                .map(|(k, f)| f * self.coefficients[(first + k, quantity)])
                .sum()
        };
        (0..self.coefficients.ncols()).map(of).collect()
    }

    /// Noise of the derivative of an order at a time: a vector w, such that two derivatives have
    /// the covariance wᵀ w₂ times that of the samples.
    pub(crate) fn spread(&self, t: f64, order: usize) -> Vec<f64> {
        let n = self.basis.count();
        let (first, functions) = self.basis.at(t, order);
        let mut spread = vec![0.0; n];
        spread[first..first + LIVE].copy_from_slice(&functions);
        for i in first..n {
            let known: f64 = (1..LIVE.min(i + 1))
                .filter(|k| i - k >= first)
                .map(|k| self.triangle[i - k][k] * spread[i - k])
                .sum();
            spread[i] = (spread[i] - known) / self.triangle[i][0];
        }
        spread
    }
}
