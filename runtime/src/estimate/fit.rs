//! The values that make recordings most likely: prediction-error fits by maximum likelihood, with
//! what is known beforehand (K. J. Åström, *Maximum likelihood and prediction error methods*, 1980).
//!
//! Damped quasi-Newton steps with the exact gradient. The curvature starts as Fisher's information
//! (scoring), learns from the gradients (BFGS with Powell's damping; J. Nocedal and S. J. Wright,
//! *Numerical Optimization*, 2006, procedure 18.2), and is computed anew where steps fail. An optimum
//! is where no step promises to gain anything: half of Newton's decrement is the gain that is left,
//! in units of log-likelihood.

use nalgebra::{DMatrix, DVector};

use super::EstimateError;
use super::estimation::Estimation;
use super::free::{Coordinate, Free, Selection};
use super::sensitivity::Sensitivity;

/// Part of the promised gain that makes a step worth it.
const ENOUGH: f64 = 0.05;
/// Steps that are damped more than this move nothing.
const MOST_DAMPING: f64 = 1e6;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Gain in log-likelihood that is not worth a step; 1/2 is one standard deviation.
    pub gain: f64,
    /// Most steps.
    pub steps: usize,
}

impl Default for Effort {
    /// To a thousandth of a standard deviation.
    fn default() -> Self {
        Self {
            gain: 5e-7,
            steps: 60,
        }
    }
}

/// An optimum.
#[derive(Debug, Clone)]
pub struct Fit {
    /// All values.
    pub values: Vec<f64>,
    /// Those that were looked for.
    pub free: Vec<Free>,
    /// Their coordinates.
    pub coordinates: DVector<f64>,
    /// Which of them stand at a limit: nothing is said about their spread.
    pub at_limit: Vec<bool>,
    /// Log-likelihood of the recordings.
    pub log_likelihood: f64,
    /// The same with the density beforehand, up to a constant.
    pub log_posterior: f64,
    /// Fisher's information of the coordinates at the optimum, with what is known beforehand.
    pub information: DMatrix<f64>,
    /// Gain that a further step promises.
    pub gain: f64,
    /// Steps taken.
    pub steps: usize,
}

impl Fit {
    /// Looks for an optimum from `start`. Values that are not free stay as they are.
    pub fn of(
        estimation: &Estimation<'_>,
        start: &[f64],
        free: &[Free],
        effort: Effort,
    ) -> Result<Self, EstimateError> {
        let selection = Selection::new(&estimation.layout(), free)?;
        let within = Within::of(&selection);
        let mut point = Point::of(estimation, &selection, start)?;
        let mut curvature = curvature(estimation, &selection, &point.values)?;
        let mut is_fresh = true;
        let (mut damping, mut steps) = (0.0, 0);
        loop {
            let (_, promise) = point.step(&curvature, 0.0, &within);
            if promise <= effort.gain && is_fresh {
                return Ok(point.fit(free, &within.limits, (curvature, promise, steps)));
            }
            if !is_fresh && (promise <= effort.gain || damping > 0.0) {
                // Curvature that was learned on the way cannot judge an optimum or a failure.
                curvature = self::curvature(estimation, &selection, &point.values)?;
                (is_fresh, damping) = (true, 0.0);
                continue;
            }
            if steps >= effort.steps || damping > MOST_DAMPING {
                let slope = point.gradient.amax();
                return Err(EstimateError::Stuck { steps, slope });
            }
            steps += 1;
            let (step, gain) = point.step(&curvature, damping, &within);
            let next = point.moved(estimation, &selection, &step, &within.limits);
            match next.filter(|next| next.objective > point.objective + ENOUGH * gain) {
                Some(next) => {
                    let moved = &next.coordinates - &point.coordinates;
                    learn(&mut curvature, &moved, &(&point.gradient - &next.gradient));
                    point = next;
                    (is_fresh, damping) = (false, 0.0);
                }
                None => damping = (6.0 * damping).max(0.1),
            }
        }
    }

    /// Covariance of the coordinates if the model is right: the inverse of the information. What
    /// stands at a limit counts as known.
    pub fn covariance(&self) -> Result<DMatrix<f64>, EstimateError> {
        inverse(&self.information, &self.at_limit)
    }

    /// Limits, in SI, between which a value lies with 95 % if the model is right.
    pub fn interval95(&self, index: usize) -> Result<[f64; 2], EstimateError> {
        const QUANTILE: f64 = 1.959_963_984_540_054;
        let deviation = self.covariance()?[(index, index)].sqrt();
        let (free, centre) = (self.free[index], self.coordinates[index]);
        Ok([-1.0, 1.0].map(|sign| free.to_value(centre + sign * QUANTILE * deviation)))
    }
}

/// The inverse of an information matrix among the coordinates that are not held; zero elsewhere.
pub(super) fn inverse(
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

/// Expected curvature of the negative objective.
fn curvature(
    estimation: &Estimation<'_>,
    selection: &Selection<'_>,
    values: &[f64],
) -> Result<DMatrix<f64>, EstimateError> {
    let data = Sensitivity::of(estimation, values, selection.free)?.information();
    Ok(data + DMatrix::from_diagonal(&selection.prior_information()))
}

/// Powell's damped update: `curvature` stays positive definite.
fn learn(curvature: &mut DMatrix<f64>, moved: &DVector<f64>, change: &DVector<f64>) {
    let expected = &*curvature * moved;
    let (bent, along) = (moved.dot(&expected), moved.dot(change));
    if bent <= 0.0 {
        return;
    }
    let part = if along >= 0.2 * bent {
        1.0
    } else {
        0.8 * bent / (bent - along)
    };
    let change = change * part + &expected * (1.0 - part);
    let along = moved.dot(&change);
    *curvature += &change * change.transpose() / along - &expected * expected.transpose() / bent;
}

/// Where a search may go.
struct Within {
    /// Lowest and highest coordinates.
    limits: Vec<[f64; 2]>,
    /// Longest change in one step: a level that is better at zero falls by this factor in every step,
    /// until nothing is gained by it any more.
    reach: Vec<f64>,
}

impl Within {
    fn of(selection: &Selection<'_>) -> Self {
        let reach = |free: &Free| match free.coordinate {
            Coordinate::Plain => f64::INFINITY,
            Coordinate::Logarithm => 3.0,
        };
        Self {
            limits: selection.limits(),
            reach: selection.free.iter().map(reach).collect(),
        }
    }
}

/// A point of the search.
struct Point {
    values: Vec<f64>,
    coordinates: DVector<f64>,
    log_likelihood: f64,
    /// Log-likelihood with the density beforehand.
    objective: f64,
    gradient: DVector<f64>,
}

impl Point {
    fn of(
        estimation: &Estimation<'_>,
        selection: &Selection<'_>,
        values: &[f64],
    ) -> Result<Self, EstimateError> {
        let coordinates = selection.coordinates(values)?;
        let mut values = values.to_vec();
        selection.write(&coordinates, &mut values);
        let (log_likelihood, by_values) = estimation.gradient(&values)?;
        let (prior, by_prior) = selection.prior(&coordinates);
        Ok(Self {
            objective: log_likelihood + prior,
            gradient: selection.gradient(&values, &by_values) + by_prior,
            log_likelihood,
            coordinates,
            values,
        })
    }

    /// Where coordinates stand at a limit and the objective grows beyond it.
    fn held(&self, limits: &[[f64; 2]]) -> Vec<bool> {
        let all = self.coordinates.iter().zip(&self.gradient).zip(limits);
        all.map(|((&x, &slope), &[low, high])| {
            x <= low && slope <= 0.0 || x >= high && slope >= 0.0
        })
        .collect()
    }

    /// The step of a curvature, and the gain that it promises. Coordinates at their limits stay; no
    /// coordinate moves farther than it can reach, and the others make the best of that.
    fn step(&self, curvature: &DMatrix<f64>, damping: f64, within: &Within) -> (DVector<f64>, f64) {
        let held = self.held(&within.limits);
        let mut fixed: Vec<Option<f64>> = held.iter().map(|&held| held.then_some(0.0)).collect();
        let mut step = self.free_step(curvature, damping, &fixed);
        let far = |(step, reach): (&f64, &f64)| step.abs() > *reach;
        if step.iter().zip(&within.reach).any(far) {
            for (i, &reach) in within.reach.iter().enumerate() {
                if step[i].abs() > reach {
                    fixed[i] = Some(reach.copysign(step[i]));
                }
            }
            step = self.free_step(curvature, damping, &fixed);
        }
        let gain = self.gradient.dot(&step) - 0.5 * step.dot(&(curvature * &step));
        (step, gain)
    }

    /// The damped step of the coordinates that are not fixed.
    fn free_step(
        &self,
        curvature: &DMatrix<f64>,
        damping: f64,
        fixed: &[Option<f64>],
    ) -> DVector<f64> {
        let mut step =
            DVector::from_iterator(fixed.len(), fixed.iter().map(|fixed| fixed.unwrap_or(0.0)));
        let slope = &self.gradient - curvature * &step;
        // A coordinate without curvature cannot be judged.
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
            // A little of the diagonal keeps directions without information in place.
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

    /// The point after a step, if the filter runs there.
    fn moved(
        &self,
        estimation: &Estimation<'_>,
        selection: &Selection<'_>,
        step: &DVector<f64>,
        limits: &[[f64; 2]],
    ) -> Option<Self> {
        let mut values = self.values.clone();
        let mut coordinates = &self.coordinates + step;
        for (coordinate, &[low, high]) in coordinates.iter_mut().zip(limits) {
            *coordinate = coordinate.max(low).min(high);
        }
        selection.write(&coordinates, &mut values);
        let next = Self::of(estimation, selection, &values).ok()?;
        next.objective.is_finite().then_some(next)
    }

    fn fit(
        self,
        free: &[Free],
        limits: &[[f64; 2]],
        (information, gain, steps): (DMatrix<f64>, f64, usize),
    ) -> Fit {
        Fit {
            at_limit: self.held(limits),
            values: self.values,
            free: free.to_vec(),
            coordinates: self.coordinates,
            log_likelihood: self.log_likelihood,
            log_posterior: self.objective,
            information,
            gain,
            steps,
        }
    }
}
