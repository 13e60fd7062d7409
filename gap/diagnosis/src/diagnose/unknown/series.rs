//! The harmonics of a variable as regressors of the force in an equation, or of the error of a channel.
//!
//! A law is linear in the amplitudes of its harmonics, so that its gain, and its evidence under a normal prior
//! of the amplitudes, have a closed form (C. E. Rasmussen and C. K. I. Williams, *Gaussian
//! Processes for Machine Learning*, 2006, chapter 2).

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::super::evidence::{NormalSizes, occam};
use super::super::gram::ByRun;
use super::dependence::WAVES;

/// Largest number of harmonics of a measured law.
const MOST_TERMS: usize = 10;
/// Sufficient part of the gain of all harmonics.
const ENOUGH: f64 = 0.98;
/// Relative regularisation for nearly constant harmonics.
const FLOOR: f64 = 1e-9;

/// Some harmonics with their amplitudes.
pub(in super::super) struct Series {
    /// Number of the harmonic, amplitudes of its sine and cosine, their prior standard deviation.
    pub(in super::super) terms: Vec<(usize, [f64; 2], f64)>,
}

/// Gain of a law, on all runs and cross-validated between runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct LawGain {
    pub(in super::super) gain: f64,
    pub(super) cross_validated: f64,
    pub(in super::super) log_bayes_factor: f64,
}

impl LawGain {
    /// The same with a constant added to the gains.
    pub(super) fn beside(self, offset: f64) -> Self {
        Self {
            gain: self.gain + offset,
            cross_validated: self.cross_validated + offset,
            log_bayes_factor: self.log_bayes_factor + offset,
        }
    }
}

/// The Gram matrices and scores of the terms of a law, by run.
pub(in super::super) struct TermScores {
    runs: Vec<(DMatrix<f64>, DVector<f64>)>,
    squares: DMatrix<f64>,
    scores: DVector<f64>,
    /// Log likelihood without any of them.
    pub(super) log_likelihood: f64,
}

impl TermScores {
    /// Of the columns of a law, in which nuisances are eliminated.
    pub(super) fn new(by_run: &ByRun<'_>, columns: Range<usize>) -> Self {
        let mut runs = by_run.of(columns);
        // Steps are against the scores.
        for (_, score) in &mut runs {
            score.neg_mut();
        }
        let squares = runs.iter().map(|(squares, _)| squares).sum();
        let scores = runs.iter().map(|(_, scores)| scores).sum();
        // The priors belong to no run.
        runs.pop();
        Self {
            runs,
            squares,
            scores,
            log_likelihood: by_run.log_likelihood,
        }
    }

    /// A law whose prior amplitudes decrease as one over the number of the harmonic, averaged over its size.
    pub(super) fn smooth(&self) -> Option<LawGain> {
        let count = self.scores.len().min(2 * WAVES);
        let fall = DVector::from_fn(count, |i, _| ((i / 2 + 1) as f64).recip());
        let scaled = self.scaled(&fall);
        let sizes = NormalSizes::of(&scaled.squares, &scaled.scores)?;
        let (gain, cross_validated) = scaled.gains(sizes.variance.recip())?;
        Some(LawGain {
            gain,
            cross_validated,
            log_bayes_factor: sizes.log_bayes_factor,
        })
    }

    /// The dominant harmonics of a smooth law, or a given one, with their prior standard deviations.
    pub(in super::super) fn series(&self, wave: Option<usize>) -> Option<Series> {
        if let Some(wave) = wave {
            let sizes = self.sizes(&[2 * wave, 2 * wave + 1])?;
            let variance = sizes.norm_squared();
            return Some(Series {
                terms: vec![(wave, [sizes[0], sizes[1]], variance.sqrt())],
            });
        }
        let count = self.scores.len().min(2 * WAVES);
        let fall = |i: usize| ((i / 2 + 1) as f64).recip();
        let scaled = self.scaled(&DVector::from_fn(count, |i, _| fall(i)));
        let variance = NormalSizes::of(&scaled.squares, &scaled.scores)?.variance;
        let gain_of = |waves: &[usize]| {
            let places: Vec<usize> = waves.iter().flat_map(|&w| [2 * w, 2 * w + 1]).collect();
            let (squares, scores) = part_of(&scaled.squares, &scaled.scores, &places);
            let sizes = solved(&squares, &scores, variance.recip())?;
            Some((gained(&sizes, &squares, &scores), sizes))
        };
        let all: Vec<usize> = (0..count / 2).collect();
        let (whole, _) = gain_of(&all)?;
        let mut chosen: Vec<usize> = Vec::new();
        let mut best = None;
        while chosen.len() < MOST_TERMS.min(all.len()) {
            let others = all.iter().filter(|wave| !chosen.contains(wave));
            let tried = others.filter_map(|&wave| {
                let waves = [chosen.as_slice(), &[wave]].concat();
                Some((gain_of(&waves)?, wave))
            });
            let ((gain, sizes), wave) = tried.max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
            chosen.push(wave);
            best = Some(sizes);
            if gain > ENOUGH * whole {
                break;
            }
        }
        let sizes = best?;
        let terms = chosen.iter().enumerate().map(|(place, &wave)| {
            let fall = fall(2 * wave);
            let own = [sizes[2 * place] * fall, sizes[2 * place + 1] * fall];
            (wave, own, variance.sqrt() * fall)
        });
        let mut terms: Vec<(usize, [f64; 2], f64)> = terms.collect();
        terms.sort_by_key(|(wave, ..)| *wave);
        Some(Series { terms })
    }

    /// A single harmonic with two amplitudes.
    pub(super) fn single(&self, wave: usize) -> Option<LawGain> {
        self.of(&[2 * wave, 2 * wave + 1])
    }

    /// Some terms only, with arbitrary amplitudes.
    pub(in super::super) fn of(&self, terms: &[usize]) -> Option<LawGain> {
        let own = self.part(terms);
        let (gain, cross_validated) = own.gains(own.floor()?)?;
        Some(LawGain {
            gain,
            cross_validated,
            log_bayes_factor: gain - terms.len() as f64 * occam(gain),
        })
    }

    /// Their amplitudes.
    pub(super) fn sizes(&self, terms: &[usize]) -> Option<DVector<f64>> {
        let own = self.part(terms);
        solved(&own.squares, &own.scores, own.floor()?)
    }

    fn part(&self, terms: &[usize]) -> Self {
        self.with_all(|squares, scores| part_of(squares, scores, terms))
    }

    /// The same change of all matrices and scores.
    fn with_all(
        &self,
        of: impl Fn(&DMatrix<f64>, &DVector<f64>) -> (DMatrix<f64>, DVector<f64>),
    ) -> Self {
        let (squares, scores) = of(&self.squares, &self.scores);
        let runs = self.runs.iter();
        Self {
            runs: runs.map(|(squares, scores)| of(squares, scores)).collect(),
            squares,
            scores,
            log_likelihood: self.log_likelihood,
        }
    }

    /// The regularisation; `None` if all terms vanish.
    fn floor(&self) -> Option<f64> {
        let size = self.squares.diagonal().max();
        (size > 0.0).then_some(FLOOR * size)
    }

    fn scaled(&self, by: &DVector<f64>) -> Self {
        self.with_all(|squares, scores| {
            let squares =
                DMatrix::from_fn(by.len(), by.len(), |i, j| by[i] * squares[(i, j)] * by[j]);
            (squares, by.component_mul(&scores.rows(0, by.len())))
        })
    }

    /// The gain of the most probable amplitudes, and the sum over the runs of the gains of those fitted to all other
    /// runs; `held` is the inverse of their prior variance.
    fn gains(&self, held: f64) -> Option<(f64, f64)> {
        let sizes = solved(&self.squares, &self.scores, held)?;
        let gain = gained(&sizes, &self.squares, &self.scores);
        if self.runs.len() < 2 {
            return Some((gain, gain));
        }
        let mut cross_validated = 0.0;
        for (squares, scores) in &self.runs {
            let sizes = solved(&(&self.squares - squares), &(&self.scores - scores), held)?;
            cross_validated += gained(&sizes, squares, scores);
        }
        Some((gain, cross_validated))
    }
}

/// The matrix and the scores of some terms.
fn part_of(
    squares: &DMatrix<f64>,
    scores: &DVector<f64>,
    terms: &[usize],
) -> (DMatrix<f64>, DVector<f64>) {
    let square = |i: usize, j: usize| squares[(terms[i], terms[j])];
    (
        DMatrix::from_fn(terms.len(), terms.len(), square),
        DVector::from_fn(terms.len(), |i, _| scores[terms[i]]),
    )
}

fn gained(sizes: &DVector<f64>, squares: &DMatrix<f64>, scores: &DVector<f64>) -> f64 {
    sizes.dot(scores) - 0.5 * sizes.dot(&(squares * sizes))
}

fn solved(squares: &DMatrix<f64>, scores: &DVector<f64>, held: f64) -> Option<DVector<f64>> {
    let mut squares = squares.clone();
    for i in 0..squares.nrows() {
        squares[(i, i)] += held;
    }
    Some(squares.cholesky()?.solve(scores))
}
