//! Prediction-error fits by maximum likelihood with priors (K. J. Åström, *Maximum likelihood and
//! prediction error methods*, 1980).
//!
//! Damped quasi-Newton steps with the exact gradient. The curvature starts as the Fisher
//! information (scoring) and is updated by the steps; it is recomputed by differences when steps
//! fail and before an optimum is accepted ([`curvature`](super::curvature)). The search ends when
//! the predicted gain of a further step, half the squared Newton decrement, is negligible.

use nalgebra::{DMatrix, DVector};

use super::curvature::learn;
use super::free::{Free, Selection};
use super::posterior::{Point, Posterior, SUFFICIENT_DECREASE};
use crate::EstimateError;
use crate::estimation::Estimation;

/// Damping after the first failed step, relative to the curvature.
const DAMPING: f64 = 0.1;
/// Fraction of the predicted gain above which the damping is reduced.
const BELIEVED: f64 = 0.75;
/// Damping beyond which steps are negligible.
const MOST_DAMPING: f64 = 1e9;
/// Predicted gain in log-likelihood that may remain when damped steps fail: a tenth of a standard
/// deviation.
const CLOSE: f64 = 5e-3;
/// Damping beyond which the curvature is taken as wrong, or the optimum as reached.
const MUCH_DAMPING: f64 = 5.0;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Predicted gain in log-likelihood below which the search ends; 1/2 is one standard deviation.
    pub gain: f64,
    /// Largest number of steps.
    pub steps: usize,
    /// Log-posterior of interest: [`Fit::quick`] gives up an optimum far below it.
    pub floor: f64,
}

impl Default for Effort {
    /// To 0.001 standard deviations.
    fn default() -> Self {
        Self {
            gain: 5e-7,
            steps: 200,
            floor: f64::NEG_INFINITY,
        }
    }
}

/// An optimum.
#[derive(Debug, Clone)]
pub struct Fit {
    /// All values.
    pub values: Vec<f64>,
    /// The free values.
    pub free: Vec<Free>,
    /// Their coordinates.
    pub coordinates: DVector<f64>,
    /// Which of them are at a limit; their uncertainty is undefined.
    pub at_limit: Vec<bool>,
    /// Log-likelihood of the recordings.
    pub log_likelihood: f64,
    /// The same plus the log-prior, up to a constant.
    pub log_posterior: f64,
    /// Fisher information of the coordinates at the optimum, with that of the priors: the expected
    /// curvature of the negative log-posterior.
    pub information: DMatrix<f64>,
    /// The observed curvature, similar to the expected one if the model is correct.
    pub curvature: DMatrix<f64>,
    /// The predicted step where the search stalled; zero at an optimum.
    pub promised: DVector<f64>,
    /// Predicted gain of a further step.
    pub gain: f64,
    /// Steps taken.
    pub steps: usize,
}

impl Fit {
    /// Searches for an optimum from `start`. Values that are not free are held.
    pub fn of(
        estimation: &Estimation<'_>,
        start: &[f64],
        free: &[Free],
        effort: Effort,
    ) -> Result<Self, EstimateError> {
        let selection = Selection::new(&estimation.layout(), free)?;
        let posterior = Posterior {
            estimation,
            selection: &selection,
        };
        let mut point = posterior.at(start)?;
        let mut information = posterior.expected(&point)?;
        let mut curvature = information.clone();
        let (mut is_observed, mut damping, mut steps) = (false, 0.0, 0);
        loop {
            let (_, left) = posterior.step(&point, &curvature, 0.0);
            let most = if left <= CLOSE {
                MUCH_DAMPING
            } else {
                MOST_DAMPING
            };
            let is_over = left <= effort.gain || steps >= effort.steps || damping > most;
            if !is_observed && (is_over || damping > MUCH_DAMPING) {
                information = posterior.expected(&point)?;
                curvature = posterior.observed(&point, &information)?;
                (is_observed, damping) = (true, 0.0);
                continue;
            }
            if is_over && left > effort.gain.max(CLOSE) {
                let slope = point.gradient.amax();
                return Err(EstimateError::Stuck { steps, slope });
            }
            if is_over {
                return Ok(Self {
                    gain: left,
                    steps,
                    ..Self::at(point, free, [information, curvature])
                });
            }
            steps += 1;
            let (step, gain) = posterior.step(&point, &curvature, damping);
            let moved = posterior.moved(&point, &step).ok();
            let next = moved.filter(|next| next.objective.is_finite());
            let is_better = |next: &Point| point.is_worse_than(next, SUFFICIENT_DECREASE * gain);
            let better = next.as_ref().is_some_and(is_better);
            // A failed step updates the curvature, unless it was just recomputed.
            if let Some(next) = next.as_ref().filter(|_| better || !is_observed) {
                learn(&mut curvature, &point, next);
            }
            match next {
                Some(next) if better => {
                    if next.objective - point.objective > BELIEVED * gain {
                        let less = 0.1 * damping;
                        damping = if less < 0.1 * DAMPING { 0.0 } else { less };
                    }
                    (point, is_observed) = (next, false);
                }
                _ => damping = (6.0 * damping).max(DAMPING),
            }
        }
    }

    /// An optimum at a point, with its expected and its observed curvature.
    pub(super) fn at(point: Point, free: &[Free], curvatures: [DMatrix<f64>; 2]) -> Self {
        let [information, curvature] = curvatures;
        Self {
            values: point.values,
            free: free.to_vec(),
            coordinates: point.coordinates,
            at_limit: point.is_held,
            log_likelihood: point.log_likelihood,
            log_posterior: point.objective,
            information,
            curvature,
            promised: DVector::zeros(free.len()),
            gain: 0.0,
            steps: 0,
        }
    }

    /// Covariance of the coordinates if the model is correct: the inverse of the information.
    /// Coordinates at a limit count as known.
    pub fn covariance(&self) -> Result<DMatrix<f64>, EstimateError> {
        inverse(&self.information, &self.at_limit)
    }

    /// Whether the search converged.
    pub fn is_optimum(&self) -> bool {
        self.promised.iter().all(|step| *step == 0.0)
    }

    /// Standard deviation of a coordinate if the model is correct, enlarged by the step that was
    /// not achieved, but no larger than that of its prior.
    pub fn deviation(&self, index: usize) -> Result<f64, EstimateError> {
        let variance = self.covariance()?[(index, index)];
        let deviation = variance.sqrt().hypot(self.promised[index]);
        Ok(match self.free[index].prior {
            Some([_, prior]) => deviation.min(prior),
            None => deviation,
        })
    }
}

/// The inverse of an information matrix among the coordinates that are not held; zero elsewhere.
pub(crate) fn inverse(
    information: &DMatrix<f64>,
    held: &[bool],
) -> Result<DMatrix<f64>, EstimateError> {
    let open: Vec<usize> = (0..held.len()).filter(|&i| !held[i]).collect();
    if open.is_empty() {
        return Ok(DMatrix::zeros(held.len(), held.len()));
    }
    let part = DMatrix::from_fn(open.len(), open.len(), |i, j| {
        information[(open[i], open[j])]
    });
    let scale = part.diagonal().map(|entry| entry.sqrt().recip());
    let scaled = DMatrix::from_fn(open.len(), open.len(), |i, j| {
        part[(i, j)] * scale[i] * scale[j]
    });
    let inverse = scaled.cholesky().ok_or(EstimateError::Singular {
        what: "the information",
    })?;
    let inverse = inverse.inverse();
    let mut all = DMatrix::zeros(held.len(), held.len());
    for (i, &row) in open.iter().enumerate() {
        for (j, &column) in open.iter().enumerate() {
            all[(row, column)] = inverse[(i, j)] * scale[i] * scale[j];
        }
    }
    Ok(all)
}
