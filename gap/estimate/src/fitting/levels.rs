//! Steps of levels of noise in a search by scoring.
//!
//! The log-likelihood of a level σ is about −r/2 (σ₀/σ)² − n ln σ, with n innovations whose variance is r/n
//! times the expected one: far from quadratic in ln σ where the model is wrong. Its optimum from the slope
//! r − n at σ₀ and the expected curvature 2 n is ln σ = ln σ₀ + ½ ln(r/n), in one step.

use nalgebra::{DMatrix, DVector};

use super::free::{Coordinate, Free};
use super::posterior::{Point, Posterior, free_step};
use crate::EstimateError;

/// Change of the logarithm of a level up to which its information is reused.
const NEAR: f64 = 0.3;
/// Largest residual in the information of levels, in standard deviations.
const LARGEST: f64 = 3.0;
/// Smallest ratio of variances that a step corrects at once.
const LEAST: f64 = 0.05;
/// Number of parts of a step that are tried, each half of the one before.
const PARTS: usize = 4;

/// The information of levels, and the point at which it was computed.
#[derive(Default)]
pub(super) struct Levels {
    known: Option<(Vec<f64>, DMatrix<f64>)>,
}

impl Levels {
    /// Expected curvature at a point. The information of logarithms of levels hardly depends on the
    /// levels.
    pub(super) fn information(
        &mut self,
        posterior: &Posterior<'_, '_>,
        point: &Point,
    ) -> Result<DMatrix<f64>, EstimateError> {
        let (estimation, selection) = (posterior.estimation, posterior.selection);
        let free = selection.free;
        let all = free.iter().zip(point.coordinates.iter());
        let levels: Vec<f64> = all
            .filter(|(free, _)| free.unknown.is_level())
            .map(|(_, &coordinate)| coordinate)
            .collect();
        let is_near = |old: &[f64]| {
            let mut moved = old.iter().zip(&levels).map(|(old, new)| (old - new).abs());
            moved.all(|moved| moved < NEAR)
        };
        let of_levels = match self.known.take().filter(|(old, _)| is_near(old)) {
            Some(known) => known,
            None => (
                levels,
                estimation.information_of_levels(&point.values, free, LARGEST)?,
            ),
        };
        let mut information = match &point.means {
            Some(means) => means.clone(),
            None => estimation.information_of_means(&point.values, free)?,
        };
        information += &of_levels.1;
        information += DMatrix::from_diagonal(&selection.prior_information());
        self.known = Some(of_levels);
        for (i, free) in free.iter().enumerate() {
            // Far below the optimum of a logarithm, the curvature of the likelihood is as large as its
            // slope, and much larger than expected at the optimum.
            if free.coordinate == Coordinate::Logarithm && !free.unknown.is_level() {
                information[(i, i)] += point.gradient[i].abs();
            }
        }
        Ok(information)
    }
}

/// Whether a coordinate is the logarithm of a level.
fn is_logarithm(free: &Free) -> bool {
    free.unknown.is_level() && free.coordinate == Coordinate::Logarithm
}

/// The step for an expected curvature from a point, and its predicted gain. Means and levels have no
/// cross-information.
pub(super) fn step(
    posterior: &Posterior<'_, '_>,
    point: &Point,
    information: &DMatrix<f64>,
    damping: f64,
) -> (DVector<f64>, f64) {
    let free = posterior.selection.free;
    let levels: Vec<usize> = (0..free.len())
        .filter(|&i| is_logarithm(&free[i]))
        .collect();
    let mut means = point.clone();
    for &i in &levels {
        means.gradient[i] = 0.0;
    }
    let (mut step, gain) = posterior.step(&means, information, damping);
    let is_open = |i: usize| is_logarithm(&free[i]) && !point.is_held[i];
    let fixed: Vec<Option<f64>> = (0..free.len())
        .map(|i| (!is_open(i)).then_some(0.0))
        .collect();
    let newton = free_step(point, information, damping, &fixed);
    // A part of the step rises where its logarithms turn it away from the gradient.
    let mut part = 1.0;
    for _ in 0..PARTS {
        for &i in &levels {
            step[i] = 0.5 * (1.0 + 2.0 * part * newton[i]).max(LEAST).ln();
        }
        let rise = rise(point, information, &levels, &step);
        if rise > 0.0 {
            return (step, gain + rise);
        }
        part *= 0.5;
    }
    for &i in &levels {
        step[i] = 0.0;
    }
    (step, gain)
}

/// Predicted gain of a step of the levels.
fn rise(point: &Point, information: &DMatrix<f64>, levels: &[usize], step: &DVector<f64>) -> f64 {
    let of_one = |&i: &usize| {
        let (expected, change) = (0.5 * information[(i, i)], step[i]);
        let squares = expected + point.gradient[i];
        let others = levels.iter().filter(|&&j| j != i);
        let with_others: f64 = others
            .map(|&j| information[(i, j)] * change * step[j])
            .sum();
        0.5 * squares * (1.0 - (-2.0 * change).exp()) - expected * change - 0.5 * with_others
    };
    levels.iter().map(of_one).sum()
}
