//! Normal equations of some columns with nuisance parameters eliminated, which have priors, and the gains of subsets of
//! columns.

use std::f64::consts::TAU;
use std::ops::Range;

use appell_estimate::{Direction, Fit, Free, Tangent};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Relative norm of the part orthogonal to the nuisance columns below which a column is dependent on them.
const LEFT: f64 = 1e-4;
/// Relative regularisation for undetermined nuisance parameters.
const RIDGE: f64 = 1e-10;

/// Normal equations of the columns of a tangent: `SᵀS`, `Sᵀr` and `rᵀr` with the whitened innovations r, and priors.
pub(super) struct Normal {
    pub(super) squares: DMatrix<f64>,
    pub(super) scores: DVector<f64>,
    /// The sum of squares, and that of the logarithms of the variances.
    square: f64,
    pub(super) scales: f64,
}

impl Normal {
    /// With innovations `rest` and the likelihood weight of a row; the first columns have priors: how far each is off
    /// its mean in standard deviations, and the derivative of that.
    pub(super) fn of(
        tangent: &Tangent,
        rest: &DVector<f64>,
        weight: f64,
        priors: &[Option<[f64; 2]>],
    ) -> Self {
        let mut squares = weight * (&tangent.slopes * tangent.slopes.transpose());
        let mut scores = weight * (&tangent.slopes * rest);
        let mut square = weight * rest.norm_squared();
        for (place, prior) in priors.iter().enumerate() {
            if let Some([off, slope]) = prior {
                squares[(place, place)] += slope * slope;
                scores[place] += slope * off;
                square += off * off;
            }
        }
        Self {
            squares,
            scores,
            square,
            scales: weight * scales(tangent),
        }
    }

    /// The columns `own` with the columns `first` eliminated.
    pub(super) fn beside(&self, first: &[usize], own: Range<usize>) -> Gram {
        let order: Vec<usize> = first.iter().copied().chain(own).collect();
        let squares = DMatrix::from_fn(order.len(), order.len(), |i, j| {
            self.squares[(order[i], order[j])]
        });
        let scores = DVector::from_fn(order.len(), |i, _| self.scores[order[i]]);
        let (free, own) = (first.len(), order.len() - first.len());
        let whole = squares.view((free, free), (own, own)).into_owned();
        let mut rest = Gram {
            scores: scores.rows(free, own).into_owned(),
            is_imitated: vec![false; own],
            squares: whole.clone(),
            log_likelihood: -0.5 * (self.scales + self.square),
        };
        if free > 0 {
            let size = DVector::from_fn(free, |i, _| {
                squares[(i, i)].sqrt().max(f64::MIN_POSITIVE).recip()
            });
            let mut own_squares =
                DMatrix::from_fn(free, free, |i, j| size[i] * squares[(i, j)] * size[j]);
            for i in 0..free {
                own_squares[(i, i)] += RIDGE;
            }
            if let Some(factor) = own_squares.cholesky() {
                let mixed = DMatrix::from_fn(free, own, |i, j| size[i] * squares[(i, free + j)]);
                let of_own = DVector::from_fn(free, |i, _| size[i] * scores[i]);
                let along = factor.l().solve_lower_triangular(&mixed);
                let told = factor.l().solve_lower_triangular(&of_own);
                if let (Some(along), Some(told)) = (along, told) {
                    rest.squares -= along.tr_mul(&along);
                    rest.scores -= along.tr_mul(&told);
                    rest.log_likelihood += 0.5 * told.norm_squared();
                }
            }
        }
        for i in 0..own {
            let left = rest.squares[(i, i)];
            rest.is_imitated[i] = left.is_nan() || left <= LEFT * LEFT * whole[(i, i)];
        }
        rest
    }
}

/// The free values of a hypothesis that affect the predicted mean.
pub(super) fn moving(fit: &Fit) -> Vec<Direction> {
    let free = fit.free.iter();
    free.map(|free| Direction::Value(free.unknown))
        .filter(|direction| moves_the_mean(*direction))
        .collect()
}

/// Their priors.
pub(super) fn priors(fit: &Fit) -> Vec<Option<[f64; 2]>> {
    let free = fit.free.iter().zip(&fit.coordinates);
    free.filter(|(own, _)| moves_the_mean(Direction::Value(own.unknown)))
        .map(|(own, coordinate)| known(own, *coordinate))
        .collect()
}

/// The deviation of a coordinate from its prior mean, in prior standard deviations, and its derivative by the value:
/// sensitivities are by values, priors of coordinates.
pub(super) fn known(free: &Free, coordinate: f64) -> Option<[f64; 2]> {
    let [expected, deviation] = free.prior?;
    let stretch = free.stretch(free.to_value(coordinate));
    let off = coordinate - free.to_coordinate(expected);
    Some([off / deviation, (deviation * stretch).recip()])
}

pub(super) fn moves_the_mean(direction: Direction) -> bool {
    !matches!(direction, Direction::Value(unknown) if unknown.is_level())
}

/// The whitened innovations.
pub(super) fn whitened(tangent: &Tangent) -> DVector<f64> {
    let samples = tangent.samples.iter();
    let samples = samples.map(|(_, sample)| sample.whitened());
    DVector::from_iterator(tangent.samples.len(), samples)
}

/// The sum of the logarithms of their variances.
fn scales(tangent: &Tangent) -> f64 {
    let samples = tangent.samples.iter();
    samples
        .map(|(_, sample)| (TAU * sample.white_variance).ln())
        .sum()
}

/// The same by runs, where nuisance columns have common values in all of them.
pub(super) struct ByRun<'t> {
    tangent: &'t Tangent,
    weight: f64,
    /// Samples, nuisance columns, their normal equations and the innovations of each run.
    runs: Vec<OfRun>,
    /// Derivatives of the priors of the nuisances, and how far these are off, in standard deviations.
    priors: DVector<f64>,
    off: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    /// The best values of the nuisances.
    values: DVector<f64>,
    /// Log likelihood with these.
    pub(super) log_likelihood: f64,
}

struct OfRun {
    rows: Range<usize>,
    nuisances: DMatrix<f64>,
    squares: DMatrix<f64>,
    scores: DVector<f64>,
    rest: DVector<f64>,
}

impl<'t> ByRun<'t> {
    /// With the likelihood weight of a row and the nuisance columns, each with its prior, if it has one.
    pub(super) fn new(
        tangent: &'t Tangent,
        weight: f64,
        nuisances: &[(usize, Option<[f64; 2]>)],
    ) -> Option<Self> {
        let rest = whitened(tangent);
        let samples = &tangent.samples;
        let mut runs = Vec::new();
        let mut from = 0;
        while let Some((run, _)) = samples.get(from) {
            let count = samples[from..].iter().take_while(|(own, _)| own == run);
            let rows = from..from + count.count();
            let own = DMatrix::from_fn(nuisances.len(), rows.len(), |i, row| {
                tangent.slopes[(nuisances[i].0, rows.start + row)]
            });
            let rest = rest.rows(rows.start, rows.len()).into_owned();
            from = rows.end;
            runs.push(OfRun {
                squares: weight * (&own * own.transpose()),
                scores: weight * (&own * &rest),
                rows,
                nuisances: own,
                rest,
            });
        }
        let of_priors = |place: usize| {
            let known = nuisances
                .iter()
                .map(|(_, prior)| prior.map_or(0.0, |own| own[place]));
            DVector::from_iterator(nuisances.len(), known)
        };
        let (off, priors) = (of_priors(0), of_priors(1));
        let mut squares = DMatrix::from_diagonal(&priors.component_mul(&priors));
        let mut scores = priors.component_mul(&off);
        for run in &runs {
            squares += &run.squares;
            scores += &run.scores;
        }
        for i in 0..nuisances.len() {
            let own = squares[(i, i)];
            squares[(i, i)] = own + RIDGE * own.max(f64::MIN_POSITIVE);
        }
        let factor = squares.cholesky()?;
        let values = factor.solve(&scores);
        let square = weight * rest.norm_squared() + off.norm_squared() - scores.dot(&values);
        Some(Self {
            tangent,
            weight,
            runs,
            priors,
            off,
            factor,
            values,
            log_likelihood: -0.5 * (weight * scales(tangent) + square),
        })
    }

    /// Gram matrices and scores of some columns with the nuisances eliminated: of each run, and of the priors.
    pub(super) fn of(&self, columns: Range<usize>) -> Vec<(DMatrix<f64>, DVector<f64>)> {
        let raw = self.runs.iter().map(|run| {
            let own = self.tangent.slopes.view(
                (columns.start, run.rows.start),
                (columns.len(), run.rows.len()),
            );
            let turned = own.transpose();
            (
                self.weight * (own * &turned),
                self.weight * (own * &run.rest),
                self.weight * (&run.nuisances * &turned),
            )
        });
        let raw: Vec<_> = raw.collect();
        let mut mixed = DMatrix::zeros(self.priors.len(), columns.len());
        for (.., of_run) in &raw {
            mixed += of_run;
        }
        // A unit of a column moves the nuisances by so much.
        let moved = self.factor.solve(&mixed);
        let of_runs = raw.into_iter().zip(&self.runs);
        let mut all: Vec<_> = of_runs
            .map(|((squares, scores, mixed), run)| {
                let across = mixed.transpose() * &moved;
                let squares = squares - &across - across.transpose()
                    + moved.transpose() * (&run.squares * &moved);
                let left = &run.scores - &run.squares * &self.values;
                let scores = scores - mixed.transpose() * &self.values - moved.transpose() * left;
                (squares, scores)
            })
            .collect();
        let by_priors = DMatrix::from_fn(self.priors.len(), columns.len(), |i, j| {
            self.priors[i] * moved[(i, j)]
        });
        let left = &self.off - self.priors.component_mul(&self.values);
        let turned = by_priors.transpose();
        all.push((&turned * &by_priors, -(turned * left)));
        all
    }
}

/// Gram matrix and scores of the columns, projected on the complement of the nuisance columns.
pub(super) struct Gram {
    pub(super) squares: DMatrix<f64>,
    pub(super) scores: DVector<f64>,
    /// Which columns depend linearly on the nuisance columns.
    pub(super) is_imitated: Vec<bool>,
    /// Log likelihood with all sizes zero.
    pub(super) log_likelihood: f64,
}

/// The best sizes of some columns.
pub(super) struct Solved {
    pub(super) gain: f64,
    pub(super) sizes: Vec<f64>,
    pub(super) deviations: Vec<f64>,
    pub(super) log_volume: f64,
}

impl Gram {
    /// The best sizes of some columns; `None` if one depends linearly on the nuisance columns or on the others.
    pub(super) fn solved(&self, columns: &[usize]) -> Option<Solved> {
        let n = columns.len();
        if columns.iter().any(|&column| self.is_imitated[column]) {
            return None;
        }
        // Cholesky's factor by rows, of columns of length one.
        let size: Vec<f64> = columns
            .iter()
            .map(|&c| self.squares[(c, c)].sqrt())
            .collect();
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let mut rest = self.squares[(columns[i], columns[j])] / (size[i] * size[j]);
                for k in 0..j {
                    rest -= l[i * n + k] * l[j * n + k];
                }
                if i > j {
                    l[i * n + j] = rest / l[j * n + j];
                } else if rest > LEFT * LEFT {
                    l[i * n + i] = rest.sqrt();
                } else {
                    return None;
                }
            }
        }
        let forward = |right: &mut [f64]| {
            for i in 0..n {
                for k in 0..i {
                    right[i] -= l[i * n + k] * right[k];
                }
                right[i] /= l[i * n + i];
            }
        };
        let backward = |right: &mut [f64]| {
            for i in (0..n).rev() {
                for k in i + 1..n {
                    right[i] -= l[k * n + i] * right[k];
                }
                right[i] /= l[i * n + i];
            }
        };
        let mut sizes: Vec<f64> = (0..n).map(|i| -self.scores[columns[i]] / size[i]).collect();
        forward(&mut sizes);
        let gain = 0.5 * sizes.iter().map(|part| part * part).sum::<f64>();
        backward(&mut sizes);
        let deviations = (0..n).map(|i| {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            forward(&mut unit);
            unit.iter().map(|part| part * part).sum::<f64>().sqrt() / size[i]
        });
        let deviations = deviations.collect();
        let log_root: f64 = (0..n).map(|i| l[i * n + i].ln() + size[i].ln()).sum();
        for (own, size) in sizes.iter_mut().zip(&size) {
            *own /= size;
        }
        Some(Solved {
            gain,
            sizes,
            deviations,
            log_volume: 0.5 * n as f64 * TAU.ln() - log_root,
        })
    }
}
