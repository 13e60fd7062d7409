//! The log-posterior of the free values: the log-likelihood of recordings plus the log-prior, as a
//! function of coordinates within limits.

use nalgebra::{DMatrix, DVector};

use super::free::{Coordinate, Free, Selection};
use crate::EstimateError;
use crate::estimation::Estimation;
use crate::gradient::direction::Direction;
use crate::gradient::kept::{Kept, Slopes};

/// Largest change of a logarithm in one step, for levels whose optimum is zero.
const REACH: f64 = 3.0;
/// Sufficient decrease: least part of the predicted gain at which a step is accepted.
pub(super) const SUFFICIENT_DECREASE: f64 = 0.05;
/// Largest factor of the number of steps of the motion between two points of a search.
const STIFFER: usize = 4;
/// Rounding of a log-likelihood, relative to its magnitude.
const ROUNDING: f64 = 1e-12;

/// The log-posterior.
#[derive(Clone, Copy)]
pub(crate) struct Posterior<'o, 'e> {
    pub(crate) estimation: &'o Estimation<'e>,
    pub(crate) selection: &'o Selection<'o>,
}

/// Its value and gradient at a point.
#[derive(Clone)]
pub(crate) struct Point {
    /// All values in SI.
    pub(crate) values: Vec<f64>,
    /// Coordinates of the free values.
    pub(crate) coordinates: DVector<f64>,
    /// Log-likelihood.
    pub(crate) log_likelihood: f64,
    /// Log-posterior.
    pub(crate) objective: f64,
    /// Its gradient with respect to the coordinates.
    pub(crate) gradient: DVector<f64>,
    /// Whether a coordinate is at a limit beyond which the objective increases.
    pub(crate) is_held: Vec<bool>,
    /// Fisher information of the coordinates that affect means, if it was computed with the gradient.
    pub(crate) means: Option<DMatrix<f64>>,
    /// Number of steps of each run.
    pub(crate) steps: Vec<usize>,
}

impl Posterior<'_, '_> {
    /// At some values, clamped to their limits.
    pub(crate) fn at(&self, values: &[f64]) -> Result<Point, EstimateError> {
        self.kept(self.clamped(values)?, &[])
    }

    /// The same with the information of the means.
    pub(crate) fn with_means(&self, values: &[f64]) -> Result<Point, EstimateError> {
        self.kept(self.clamped(values)?, &self.selection.directions())
    }

    /// After a step from a point.
    pub(crate) fn moved(&self, point: &Point, step: &DVector<f64>) -> Result<Point, EstimateError> {
        self.kept(self.stepped(point, step), &[])
    }

    /// At values with their coordinates, with the information of the means along some directions.
    fn kept(
        &self,
        (values, coordinates): (Vec<f64>, DVector<f64>),
        directions: &[Direction],
    ) -> Result<Point, EstimateError> {
        let kept = self.estimation.kept(&values, directions, &[])?;
        Ok(self.point(&values, coordinates, kept))
    }

    /// The same with the information of the means, if the objective rises by more than `gain`, without many more steps of
    /// the motion. Most other points are rejected before their gradient is computed, and where that `is_likely`, before
    /// their information is.
    pub(crate) fn bettered(
        &self,
        point: &Point,
        step: &DVector<f64>,
        gain: f64,
        is_likely: bool,
    ) -> Option<Point> {
        let (values, coordinates) = self.stepped(point, step);
        let (prior, _) = self.selection.prior(&coordinates);
        let may_be = |likelihood: f64| {
            let rise = likelihood + prior - point.objective;
            rise > gain || point.is_rounding(rise)
        };
        let most_steps: Vec<usize> = point.steps.iter().map(|steps| STIFFER * steps).collect();
        if is_likely {
            let estimation = self.estimation;
            let likelihood = estimation.log_likelihood_within(&values, &most_steps);
            likelihood.ok().filter(|&likelihood| may_be(likelihood))?;
        }
        let directions = self.selection.directions();
        let kept = self
            .estimation
            .kept(&values, &directions, &most_steps)
            .ok()?;
        let next = may_be(kept.log_likelihood()).then(|| self.point(&values, coordinates, kept))?;
        (next.objective.is_finite() && point.is_worse_than(&next, gain)).then_some(next)
    }

    /// Values within their limits, and their coordinates.
    fn clamped(&self, values: &[f64]) -> Result<(Vec<f64>, DVector<f64>), EstimateError> {
        let coordinates = self.selection.coordinates(values)?;
        let mut values = values.to_vec();
        self.selection.write(&coordinates, &mut values);
        Ok((values, coordinates))
    }

    /// Values and coordinates after a step from a point, within their limits.
    fn stepped(&self, point: &Point, step: &DVector<f64>) -> (Vec<f64>, DVector<f64>) {
        let mut values = point.values.clone();
        let mut coordinates = &point.coordinates + step;
        for (coordinate, [low, high]) in coordinates.iter_mut().zip(self.selection.limits()) {
            *coordinate = coordinate.max(low).min(high);
        }
        self.selection.write(&coordinates, &mut values);
        (values, coordinates)
    }

    /// The point of a pass that is kept.
    fn point(&self, values: &[f64], coordinates: DVector<f64>, kept: Kept<'_, '_>) -> Point {
        let (log_likelihood, steps) = (kept.log_likelihood(), kept.steps());
        let Slopes { gradient, means } = kept.slopes();
        let (prior, by_prior) = self.selection.prior(&coordinates);
        let gradient = self.selection.gradient(values, &gradient) + by_prior;
        let has_means = means.nrows() == self.selection.len();
        let limits = self.selection.limits();
        let all = coordinates.iter().zip(&gradient).zip(limits);
        let is_held = all.map(|((&x, &slope), [low, high])| {
            x <= low && slope <= 0.0 || x >= high && slope >= 0.0
        });
        Point {
            is_held: is_held.collect(),
            means: has_means.then(|| self.selection.stretched(means, values)),
            steps,
            objective: log_likelihood + prior,
            log_likelihood,
            gradient,
            coordinates,
            values: values.to_vec(),
        }
    }

    /// The step for a curvature from a point, and its predicted gain. Coordinates at their limits
    /// are held; none exceeds its limits or its largest step, and the others are optimised given
    /// that.
    pub(crate) fn step(
        &self,
        point: &Point,
        curvature: &DMatrix<f64>,
        damping: f64,
    ) -> (DVector<f64>, f64) {
        let held = point.is_held.iter();
        let mut fixed: Vec<Option<f64>> = held.map(|&held| held.then_some(0.0)).collect();
        let mut step = free_step(point, curvature, damping, &fixed);
        let too_far =
            |free: &Free, step: f64| free.coordinate == Coordinate::Logarithm && step.abs() > REACH;
        let mut is_too_far = false;
        for (i, free) in self.selection.free.iter().enumerate() {
            if too_far(free, step[i]) {
                fixed[i] = Some(REACH.copysign(step[i]));
                is_too_far = true;
            }
        }
        if is_too_far {
            step = free_step(point, curvature, damping, &fixed);
        }
        let gain = point.gradient.dot(&step) - 0.5 * step.dot(&(curvature * &step));
        (step, gain)
    }
}

impl Point {
    /// Whether a rise of the objective is no more than its rounding.
    fn is_rounding(&self, rise: f64) -> bool {
        rise.abs() <= ROUNDING * self.objective.abs()
    }

    /// Whether the objective of another point is larger by more than `gain`; if the difference is rounding, the
    /// directional derivatives decide.
    pub(crate) fn is_worse_than(&self, other: &Point, gain: f64) -> bool {
        let rise = other.objective - self.objective;
        if !self.is_rounding(rise) {
            return rise > gain;
        }
        let moved = &other.coordinates - &self.coordinates;
        let [before, after] = [self, other].map(|point| point.gradient.dot(&moved));
        after.abs() < before.abs()
    }
}

/// The damped step of the coordinates that are not held.
pub(super) fn free_step(
    point: &Point,
    curvature: &DMatrix<f64>,
    damping: f64,
    fixed: &[Option<f64>],
) -> DVector<f64> {
    let mut step =
        DVector::from_iterator(fixed.len(), fixed.iter().map(|fixed| fixed.unwrap_or(0.0)));
    let slope = &point.gradient - curvature * &step;
    // Coordinates without curvature are not scaled.
    let open: Vec<usize> = (0..fixed.len())
        .filter(|&i| fixed[i].is_none() && curvature[(i, i)] > 0.0)
        .collect();
    if open.is_empty() {
        return step;
    }
    let scale: Vec<f64> = open
        .iter()
        .map(|&i| curvature[(i, i)].sqrt().recip())
        .collect();
    let mut scaled = DMatrix::from_fn(open.len(), open.len(), |i, j| {
        curvature[(open[i], open[j])] * scale[i] * scale[j]
    });
    for i in 0..open.len() {
        // A small multiple of the diagonal regularises directions without information.
        scaled[(i, i)] += damping + 1e-12;
    }
    let right = DVector::from_fn(open.len(), |i, _| slope[open[i]] * scale[i]);
    let solved = match scaled.cholesky() {
        Some(factor) => factor.solve(&right),
        None => right,
    };
    for (i, &place) in open.iter().enumerate() {
        step[place] = solved[i] * scale[i];
    }
    step
}
