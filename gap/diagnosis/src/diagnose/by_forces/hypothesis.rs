//! A set of candidates fitted to residual forces, with its evidence.
//!
//! The variance of each equation is that of its residual; correlated motions count as fewer independent ones, and as no
//! law is exact the likelihood is coarsened: a twentieth of the mean square of an equation is one unit (J. W. Miller,
//! D. B. Dunson, *Robust Bayesian inference via coarsening*, 2019). The likelihood is that of the measured inputs u,
//! given the motion: p(u) = p(r) |det E|, where the residual r contains −E u. Without this factor an input of zero gain
//! would explain any missing force.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::super::evidence::volume;
use super::super::hardware::LN_1000;
use super::super::window_bench::TOLERANCE;
use super::motions::Motions;

/// Largest number of iterations of the variances.
const PASSES: usize = 12;
/// Smallest damping factor of a Newton step.
const SHORTEST: f64 = 1e-3;
/// Largest lag of correlations, in motions.
const LAGS: usize = 50;
/// A correlation below this is taken as zero.
const CHANCE: f64 = 0.05;

/// A free parameter of a hypothesis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Open {
    /// Its column.
    pub(super) column: usize,
    /// Prior mean and standard deviation of its difference; `None` for sizes.
    pub(super) prior: Option<[f64; 2]>,
    /// Range of its difference.
    pub(super) range: [f64; 2],
}

/// A candidate with its sizes.
pub(super) struct Member {
    /// Its index.
    pub(super) candidate: usize,
    pub(super) open: Vec<Open>,
    /// Products of its size and its shapes.
    pub(super) shapes: Vec<Open>,
    /// Whether it requires all of its sizes.
    pub(super) is_whole: bool,
}

impl Member {
    fn has(&self, column: usize) -> bool {
        self.open.iter().any(|one| one.column == column)
    }
}

/// A fitted hypothesis.
#[derive(Debug, Clone)]
pub(super) struct Hypothesis {
    /// Indices of the candidates; none for the nominal model.
    pub(super) members: Vec<usize>,
    /// Difference of every variable from its stated value.
    pub(super) changes: DVector<f64>,
    /// Standard deviation of each parameter that is free and not at a limit.
    pub(super) deviations: Vec<Option<f64>>,
    /// Residual variance of each equation.
    pub(super) variances: Vec<f64>,
    pub(super) log_likelihood: f64,
    /// Logarithm of the evidence.
    pub(super) log: f64,
}

impl Hypothesis {
    /// Change and standard deviation of a parameter, where it was free.
    pub(super) fn change(&self, motions: &Motions, parameter: usize) -> (f64, Option<f64>) {
        let Some(column) = motions.column(parameter) else {
            return (0.0, None);
        };
        let (change, deviation) = (self.changes[column], self.deviations[column]);
        let Some(shaped) = motions.variables[column].shapes else {
            return (change, deviation);
        };
        let size = motions.column(shaped.size).map(|own| self.changes[own]);
        match size.filter(|size| *size != 0.0).zip(deviation) {
            Some((size, deviation)) => (change / size, Some(deviation / size.abs())),
            None => (0.0, None),
        }
    }
}

/// The most probable values of some parameters.
pub(super) struct Solved {
    pub(super) values: DVector<f64>,
    /// The inverse of their covariance.
    pub(super) information: DMatrix<f64>,
    variances: Vec<f64>,
    /// ln |det E| relative to the nominal one, its part of the log likelihood.
    log_levers: f64,
}

/// Sums of squares over the motions.
#[derive(Debug, Clone)]
pub(super) struct Squares {
    /// For each equation, the Gram matrix of regressors and residual, the residual last.
    equations: Vec<DMatrix<f64>>,
    /// Number of motions.
    count: f64,
    levers: Vec<(usize, DMatrix<f64>)>,
    /// Effective sample size of each equation relative to the number of motions.
    pub(super) independent: Vec<f64>,
}

impl Squares {
    pub(super) fn of(motions: &Motions) -> Self {
        let columns = motions.variables.len();
        let speeds = motions.all().next().map_or(0, |one| one.residual.len());
        let mut equations = vec![DMatrix::zeros(columns + 1, columns + 1); speeds];
        let mut count = 0.0;
        let mut row = DVector::zeros(columns + 1);
        for motion in motions.all() {
            for (equation, squares) in equations.iter_mut().enumerate() {
                row.rows_mut(0, columns)
                    .copy_from(&motion.slopes.row(equation).transpose());
                row[columns] = motion.residual[equation];
                squares.ger(1.0, &row, &row, 1.0);
            }
            count += 1.0;
        }
        Self {
            independent: vec![coarse(count); equations.len()],
            equations,
            count,
            levers: motions.levers.clone(),
        }
    }

    /// ln |det E⁻¹ E(p)| with its gradient and its negative Hessian by the free parameters; `None` if E becomes
    /// singular.
    fn levers(
        &self,
        open: &[Open],
        values: &DVector<f64>,
    ) -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        let (mut slope, mut curvature) = (
            DVector::zeros(open.len()),
            DMatrix::zeros(open.len(), open.len()),
        );
        let own = |column: usize| open.iter().position(|one| one.column == column);
        let levers = self.levers.iter();
        let levers: Vec<(usize, &DMatrix<f64>)> = levers
            .filter_map(|(column, lever)| Some((own(*column)?, lever)))
            .collect();
        let Some((_, first)) = levers.first() else {
            return Some((0.0, slope, curvature));
        };
        let mut whole = DMatrix::identity(first.nrows(), first.ncols());
        for (place, lever) in &levers {
            whole += values[*place] * *lever;
        }
        let determinant = whole.determinant();
        let inverse = whole.try_inverse().filter(|_| determinant > 0.0)?;
        let turned: Vec<(usize, DMatrix<f64>)> = (levers.iter())
            .map(|(place, lever)| (*place, &inverse * *lever))
            .collect();
        for (i, own) in &turned {
            slope[*i] = own.trace();
            for (j, other) in &turned {
                curvature[(*i, *j)] = (own * other).trace();
            }
        }
        Some((determinant.ln(), slope, curvature))
    }

    /// With the autocorrelation of the residuals of a hypothesis: n motions count as n / (1 + 2 Σ ρ).
    pub(super) fn correlated(&self, motions: &Motions, fitted: &Hypothesis) -> Self {
        let mut squares = self.clone();
        for (equation, independent) in squares.independent.iter_mut().enumerate() {
            let mut sums = [0.0; LAGS];
            for (_, own) in &motions.stretches {
                let left: Vec<f64> = own
                    .iter()
                    .map(|motion| motion.left(&fitted.changes)[equation])
                    .collect();
                for (lag, sum) in sums.iter_mut().enumerate() {
                    let pairs = left.iter().zip(left.iter().skip(lag));
                    *sum += pairs.map(|(a, b)| a * b).sum::<f64>();
                }
            }
            let correlations = sums[1..].iter().map(|sum| sum / sums[0]);
            let together: f64 = correlations.take_while(|own| *own > CHANCE).sum();
            *independent = coarse(self.count).min(1.0 / (1.0 + 2.0 * together));
        }
        squares
    }

    /// The most probable values of the free parameters; those that would leave their range keep their stated values.
    /// `None` if they are not identifiable or if a member is not significant. `others` are parameters of the mechanism.
    pub(super) fn fitted(&self, members: &[Member], others: &[Open]) -> Option<Hypothesis> {
        let mut open: Vec<Open> = others.to_vec();
        open.extend(members.iter().flat_map(|member| &member.open));
        open.extend(members.iter().flat_map(|member| &member.shapes));
        loop {
            let solved = self.solved(&open)?;
            let is_against = |&i: &usize| {
                let [low, high] = open[i].range;
                !(low < solved.values[i] && solved.values[i] < high)
            };
            let Some(against) = (0..open.len()).find(is_against) else {
                return self.evaluated(members, &open, solved);
            };
            let gone = open.remove(against).column;
            if members.iter().any(|one| one.is_whole && one.has(gone)) {
                return None;
            }
        }
    }

    /// Value of a variable whose forces are as large as those that the nominal model misses.
    pub(super) fn scale(&self, column: usize) -> f64 {
        let nominal = self.variances(&[], &DVector::zeros(0));
        let equations = self.equations.iter().zip(nominal);
        let squares = equations.map(|(squares, variance)| squares[(column, column)] / variance);
        (self.equations.len() as f64 * self.count / squares.sum::<f64>()).sqrt()
    }

    fn evaluated(&self, members: &[Member], open: &[Open], solved: Solved) -> Option<Hypothesis> {
        let Solved {
            values,
            information,
            variances,
            log_levers,
        } = solved;
        let columns = self.equations.first()?.nrows() - 1;
        let (log_volume, deviations) = volume(&information);
        let mut occam = log_volume;
        let (mut changes, mut known) = (DVector::zeros(columns), vec![None; columns]);
        for (place, one) in open.iter().enumerate() {
            let (value, deviation) = (values[place], deviations[place]);
            changes[one.column] = value;
            known[one.column] = Some(deviation);
            occam += if let Some([mean, std]) = one.prior {
                -0.5 * ((value - mean) / std).powi(2) - std.ln() - 0.5 * TAU.ln()
            } else {
                let d = (value.abs() / deviation).max(1.0);
                let sides = if one.range[0] < 0.0 { 2.0_f64 } else { 1.0 };
                -(d * deviation * sides * LN_1000).ln()
            };
        }
        // A member is accepted if most of its sizes differ significantly from zero.
        let is_told = |member: &Member| {
            let is_told =
                |column: usize| known[column].is_some_and(|std| changes[column].abs() > std);
            let told = member.open.iter().filter(|one| is_told(one.column));
            2 * told.count() > member.open.len()
        };
        if !members.iter().all(is_told) {
            return None;
        }
        let logs = variances.iter().zip(&self.independent);
        let log_likelihood = log_levers
            + logs
                .map(|(variance, independent)| -0.5 * independent * self.count * variance.ln())
                .sum::<f64>();
        let log = log_likelihood + occam;
        log.is_finite().then(|| Hypothesis {
            members: members.iter().map(|member| member.candidate).collect(),
            changes,
            deviations: known,
            variances,
            log_likelihood,
            log,
        })
    }

    /// The most probable values by Newton's method, alternating with the residual variances.
    pub(super) fn solved(&self, open: &[Open]) -> Option<Solved> {
        let last = self.equations.first()?.nrows() - 1;
        let count = open.len();
        let independent: f64 = self.independent.iter().sum();
        let motions = self.count * independent / self.independent.len() as f64;
        let mut values = DVector::zeros(count);
        let mut information = DMatrix::zeros(count, count);
        let mut variances = self.variances(open, &values);
        for _ in 0..PASSES {
            let (_, slope, curvature) = self.levers(open, &values)?;
            information = motions * curvature;
            let mut right = motions * slope + &information * &values;
            for (equation, squares) in self.equations.iter().enumerate() {
                let weight = self.independent[equation] / variances[equation];
                for (i, own) in open.iter().enumerate() {
                    right[i] -= weight * squares[(own.column, last)];
                    for (j, other) in open.iter().enumerate() {
                        information[(i, j)] += weight * squares[(own.column, other.column)];
                    }
                }
            }
            for (i, own) in open.iter().enumerate() {
                if let Some([mean, std]) = own.prior {
                    information[(i, i)] += 1.0 / (std * std);
                    right[i] += mean / (std * std);
                }
            }
            let next = solve(&information, &right)?;
            // A step to a singular E is shortened.
            let mut part = 1.0;
            let near = |part: f64| &values + part * (&next - &values);
            while part > SHORTEST && self.levers(open, &near(part)).is_none() {
                part *= 0.5;
            }
            values = near(part);
            variances = self.variances(open, &values);
        }
        let (log_levers, ..) = self.levers(open, &values)?;
        Some(Solved {
            values,
            information,
            variances,
            log_levers: motions * log_levers,
        })
    }

    /// Mean squares of the residuals.
    fn variances(&self, open: &[Open], values: &DVector<f64>) -> Vec<f64> {
        let left = self.equations.iter().map(|squares| {
            let last = squares.nrows() - 1;
            let mut sum = squares[(last, last)];
            for (i, own) in open.iter().enumerate() {
                sum += 2.0 * values[i] * squares[(own.column, last)];
                for (j, other) in open.iter().enumerate() {
                    sum += values[i] * values[j] * squares[(own.column, other.column)];
                }
            }
            self.variance(sum)
        });
        left.collect()
    }

    /// The gain of a hypothesis whose residual is the noise.
    pub(super) fn beyond(&self, fitted: &Hypothesis, noise: &DVector<f64>) -> f64 {
        let equations = fitted.variances.iter().zip(noise.iter());
        let gains = equations.zip(&self.independent);
        gains
            .map(|((variance, noise), independent)| {
                let ratio = (variance / (noise * noise)).max(1.0);
                0.5 * independent * self.count * ratio.ln()
            })
            .sum()
    }

    fn variance(&self, sum: f64) -> f64 {
        (sum / self.count.max(1.0)).max(f64::MIN_POSITIVE)
    }
}

/// Likelihood weight of so many motions: coarsening for inexact laws.
fn coarse(count: f64) -> f64 {
    (2.0 / TOLERANCE / count.max(1.0)).min(1.0)
}

/// Solves the normal equations with scaled unknowns; `None` if they are singular.
fn solve(information: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    /// Smallest squared part of a column that is independent of the others.
    const NEW: f64 = 1e-8;
    if right.is_empty() {
        return Some(right.clone());
    }
    let scale = information.diagonal().map(f64::sqrt);
    let is_wrong = |scale: &f64| *scale <= 0.0 || !scale.is_finite();
    if scale.iter().any(is_wrong) {
        return None;
    }
    let scaled = DMatrix::from_fn(right.len(), right.len(), |i, j| {
        information[(i, j)] / (scale[i] * scale[j])
    });
    let factor = scaled.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    if pivots.iter().any(|pivot| pivot * pivot < NEW) {
        return None;
    }
    let solved = factor.solve(&right.component_div(&scale));
    Some(solved.component_div(&scale))
}
