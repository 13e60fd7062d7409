//! The values that minimise the inconsistency of recorded motions, with their intervals.
//!
//! An interval holds the values at which the score is not significant (F. Kleibergen, *Pivotal
//! statistics for testing structural parameters in instrumental variables regression*, 2002).
//! Unlike a quadratic approximation it remains valid for weakly identified values: it widens, and
//! in the limit is unbounded.

use nalgebra::{DMatrix, DVector};

use super::InverseError;
use super::consistency::{Consistency, Inconsistency, Sought};
use crate::statistics::chi_squared::HALF_WIDTH_95;

/// Steps of scoring.
const MOST_STEPS: usize = 60;
/// Step, relative to the scale, at which the search ends.
const SETTLED: f64 = 1e-9;
/// Halvings of a step that raises the inconsistency.
const MOST_HALVINGS: usize = 30;
/// Doublings away from the optimum after which an interval counts as unbounded.
const MOST_DOUBLINGS: usize = 8;
/// Secant steps towards an end of an interval, and the tolerance of its statistic.
const MOST_SECANTS: usize = 8;
const CLOSE: f64 = 0.01;
/// Factors of the nominal value at which the search for one parameter begins.
const STARTS: [f64; 5] = [0.4, 0.7, 1.0, 1.5, 2.5];
/// Least change of the relations, in standard deviations, for a relative change of 1 of a value;
/// less is rounding.
const LEAST_SENSITIVITY: f64 = 1e-4;

/// Result of the search.
#[derive(Debug, Clone)]
pub struct Found {
    /// The values in SI.
    pub values: DVector<f64>,
    /// Their covariance from the noise of the samples.
    pub covariance: DMatrix<f64>,
    /// The same from the scores of segments (robust).
    pub robust: DMatrix<f64>,
    /// 95 % intervals; infinite at an unbounded end.
    pub intervals: Vec<[f64; 2]>,
    /// Q at the optimum.
    pub cost: f64,
    /// Number of relations.
    pub count: usize,
}

impl Found {
    /// Mean square of the whitened relations; near 1 if model and noise are correct.
    pub fn normalised_square(&self) -> f64 {
        2.0 * self.cost / self.count.saturating_sub(self.values.len()).max(1) as f64
    }
}

impl Consistency<'_> {
    /// The least inconsistent values.
    pub fn least(&self) -> Result<DVector<f64>, InverseError> {
        let start = self.start()?;
        let (here, scales) = (self.at(&start)?, self.scales());
        let is_determined = |index: usize| {
            here.information[(index, index)].sqrt() * scales[index] > LEAST_SENSITIVITY
        };
        let all: Vec<usize> = (0..scales.len()).collect();
        if !all.iter().all(|&index| is_determined(index)) {
            return Err(InverseError::Singular);
        }
        self.minimise(start, &all)
    }

    /// The least inconsistent values with their intervals.
    pub fn find(&self) -> Result<Found, InverseError> {
        let all: Vec<usize> = (0..self.sought().len()).collect();
        let values = self.least()?;
        let best = self.at(&values)?;
        let covariance = best.information.clone().try_inverse();
        let covariance = covariance.ok_or(InverseError::Singular)?;
        let intervals = all.iter().map(|&index| {
            let std = covariance[(index, index)].sqrt();
            let below = self.end(&values, index, -std)?;
            let above = self.end(&values, index, std)?;
            Ok([below, above])
        });
        Ok(Found {
            intervals: intervals.collect::<Result<_, InverseError>>()?,
            robust: &covariance * &best.squares * &covariance,
            covariance,
            cost: best.cost,
            count: best.count,
            values,
        })
    }

    /// Q at given values of one sought value, minimised over the others.
    pub fn profile(&self, index: usize, at: &[f64]) -> Result<Vec<f64>, InverseError> {
        let mut values = self.nominal();
        let costs = at.iter().map(|&value| {
            values[index] = value;
            values = self.minimise(values.clone(), &self.others(index))?;
            self.cost(&values)
        });
        costs.collect()
    }

    /// The nominal values; for a single parameter the best of several.
    fn start(&self) -> Result<DVector<f64>, InverseError> {
        let nominal = self.nominal();
        if !matches!(self.sought(), [Sought::Parameter(_)]) || nominal[0] == 0.0 {
            return Ok(nominal);
        }
        let mut best = (f64::INFINITY, nominal.clone());
        for factor in STARTS {
            let values = &nominal * factor;
            let cost = self.cost(&values)?;
            if cost < best.0 {
                best = (cost, values);
            }
        }
        Ok(best.1)
    }

    fn others(&self, index: usize) -> Vec<usize> {
        (0..self.sought().len()).filter(|&i| i != index).collect()
    }

    /// Scoring with steps that are halved until the inconsistency falls; some values are free.
    fn minimise(
        &self,
        mut values: DVector<f64>,
        free: &[usize],
    ) -> Result<DVector<f64>, InverseError> {
        if free.is_empty() {
            return Ok(values);
        }
        let scales = self.scales();
        for _ in 0..MOST_STEPS {
            let here = self.at(&values)?;
            let information = here.information.select_rows(free).select_columns(free);
            let step = information.cholesky().ok_or(InverseError::Singular)?;
            let step = step.solve(&here.score.select_rows(free));
            let mut part = 1.0;
            let mut moved = 0.0_f64;
            for _ in 0..MOST_HALVINGS {
                let mut next = values.clone();
                moved = 0.0;
                for (&index, step) in free.iter().zip(step.iter()) {
                    next[index] -= part * step;
                    moved = moved.max((part * step / scales[index]).abs());
                }
                if self.cost(&next).is_ok_and(|cost| cost <= here.cost) {
                    values = next;
                    break;
                }
                part *= 0.5;
            }
            if moved < SETTLED {
                break;
            }
        }
        Ok(values)
    }

    /// End of the interval of a value on the side of `std`, where its score becomes significant.
    fn end(&self, best: &DVector<f64>, index: usize, std: f64) -> Result<f64, InverseError> {
        let others = self.others(index);
        let mut start = best.clone();
        let mut statistic = |offset: f64| -> Result<f64, InverseError> {
            start[index] = best[index] + offset;
            start = self.minimise(start.clone(), &others)?;
            Ok(scored(&self.at(&start)?, index, &others))
        };
        // The square root of the statistic grows almost linearly from zero at the optimum.
        let bound = HALF_WIDTH_95;
        let (mut near, mut far) = ([0.0, -bound], [0.0, 0.0]);
        let mut offset = bound * std;
        for doubling in 0.. {
            far = [offset, statistic(offset)?.sqrt() - bound];
            if far[1] >= 0.0 {
                break;
            }
            if doubling == MOST_DOUBLINGS {
                return Ok(f64::INFINITY.copysign(std));
            }
            (near, offset) = (far, 2.0 * offset);
        }
        for _ in 0..MOST_SECANTS {
            offset = near[0] + (far[0] - near[0]) * near[1] / (near[1] - far[1]);
            let here = statistic(offset)?.sqrt() - bound;
            if here.abs() < CLOSE {
                break;
            }
            *(if here < 0.0 { &mut near } else { &mut far }) = [offset, here];
        }
        Ok(best[index] + offset)
    }
}

/// Squared score of one value over its variance, the others fitted.
fn scored(here: &Inconsistency, index: usize, others: &[usize]) -> f64 {
    let information = &here.information;
    let mut variance = information[(index, index)];
    if !others.is_empty() {
        let across = information.select_rows(others).column(index).into_owned();
        let among = information.select_rows(others).select_columns(others);
        if let Some(among) = among.cholesky() {
            variance -= across.dot(&among.solve(&across));
        }
    }
    here.score[index].powi(2) / variance.max(f64::MIN_POSITIVE)
}
