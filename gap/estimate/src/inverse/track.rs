//! Recorded coordinates as splines, in segments with independent errors.
//!
//! All coordinates share the knots, so that the splines filter both sides of the equations alike.
//! The spacing matters little once it is small enough, as derivatives are weighted with all
//! correlations of their noise. The rule is therefore cautious: the widest spacing beyond which
//! closer knots do not reduce the residuals of any channel significantly (F test), and one step
//! closer.

use nalgebra::{DMatrix, DVector};

use super::InverseError;
use super::relation::Motion;
use crate::smoothing::regression_spline::{Basis, RegressionSpline};

/// Ratio of one knot spacing to the next closer one.
const CLOSER: f64 = 1.5;
/// Least number of samples between two knots.
const FEWEST_SAMPLES: f64 = 2.0;
/// Length of a gap, in steps, at which a record is cut.
const GAP: f64 = 6.0;
/// Largest number of knots of a segment, whose covariance is a full matrix.
const MOST_KNOTS: usize = 96;
/// Least number of knots of a segment.
const FEWEST_KNOTS: f64 = 8.0;
/// Significance, in standard deviations, of a reduction of the residuals.
const CHANCE: f64 = 3.0;

/// Samples of the measured coordinates in one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Increasing times in s.
    pub times: Vec<f64>,
    /// A row for each time, a column for each coordinate; NaN where one is missing.
    pub values: DMatrix<f64>,
}

/// Records as splines with their noise.
#[derive(Debug, Clone)]
pub struct Track {
    /// Spacing of the knots in s.
    pub spacing: f64,
    /// Covariance of the samples, from the residuals of the splines.
    pub noise: DMatrix<f64>,
    /// The parts.
    pub stretches: Vec<Stretch>,
}

/// A part of a record with independent errors.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// Its run.
    pub run: usize,
    /// The motion midway between knots.
    pub motions: Vec<Motion>,
    /// For derivatives of the orders r and s, at index 3 r + s: the covariance between the middles,
    /// times that of the samples.
    pub spread: Vec<DMatrix<f64>>,
}

/// Samples without gaps or missing values.
struct Piece {
    run: usize,
    times: Vec<f64>,
    values: DMatrix<f64>,
}

impl Piece {
    fn length(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    fn fit(&self, spacing: f64) -> Option<RegressionSpline> {
        let ends = [self.times[0], self.times[self.times.len() - 1]];
        let basis = Basis::between(ends, spacing)?;
        RegressionSpline::fit(basis, &self.times, &self.values)
    }

    /// Equal parts with at most `MOST_KNOTS` knots each.
    fn parts(&self, spacing: f64) -> Vec<Self> {
        let knots = (self.length() / spacing).max(1.0);
        let count = (knots / MOST_KNOTS as f64).ceil();
        let length = self.length() / count;
        let mut parts = Vec::new();
        let mut from = 0;
        while from < self.times.len() {
            let end = self.times[0] + (parts.len() + 1) as f64 * length;
            let last = parts.len() as f64 + 1.0 >= count;
            let to = if last {
                self.times.len()
            } else {
                self.times.partition_point(|&t| t < end).max(from + 1)
            };
            parts.push(Self {
                run: self.run,
                times: self.times[from..to].to_vec(),
                values: self.values.rows(from, to - from).into_owned(),
            });
            from = to;
        }
        parts
    }
}

/// Residuals of the splines over all pieces.
struct Left {
    squares: DMatrix<f64>,
    freedom: usize,
}

impl Left {
    fn of(pieces: &[Piece], spacing: f64) -> Option<Self> {
        let channels = pieces.first()?.values.ncols();
        let mut left = Self {
            squares: DMatrix::zeros(channels, channels),
            freedom: 0,
        };
        for piece in pieces {
            let fit = piece.fit(spacing)?;
            left.squares += fit.residual;
            left.freedom += fit.freedom;
        }
        (left.freedom > 0).then_some(left)
    }

    fn variance(&self, channel: usize) -> f64 {
        self.squares[(channel, channel)] / self.freedom as f64
    }

    /// Whether closer knots reduce the residuals of a channel significantly; the last ones are `others`.
    fn is_worse_than(&self, closer: &Self, others: usize) -> bool {
        let added = self.freedom.saturating_sub(closer.freedom).max(1) as f64;
        let chance = CHANCE * (2.0 / added).sqrt();
        (0..self.squares.ncols() - others).any(|channel| {
            let gained = self.squares[(channel, channel)] - closer.squares[(channel, channel)];
            gained > added * closer.variance(channel) * (1.0 + chance)
        })
    }
}

impl Track {
    /// Splines through records of the same coordinates.
    pub fn of(records: &[Record]) -> Result<Self, InverseError> {
        Self::beside(records, 0)
    }

    /// The same where the last columns of the records are no coordinates: they share the knots, whose spacing is
    /// chosen without them.
    pub fn beside(records: &[Record], others: usize) -> Result<Self, InverseError> {
        let runs = records.iter().enumerate();
        let pieces: Vec<Piece> = runs.flat_map(|(run, record)| cut(run, record)).collect();
        let (spacing, left) = distance(&pieces, others).ok_or(InverseError::TooShort)?;
        let mut track = Self {
            spacing,
            noise: left.squares / left.freedom as f64,
            stretches: Vec::new(),
        };
        for part in pieces.iter().flat_map(|piece| piece.parts(spacing)) {
            if let Some(spline) = part.fit(spacing) {
                track.stretches.push(Stretch::new(part.run, &spline));
            }
        }
        if track.stretches.is_empty() {
            return Err(InverseError::TooShort);
        }
        Ok(track)
    }

    /// Covariance of (q, q̇, q̈) at one of the midpoints of a segment.
    pub fn spread(&self, stretch: &Stretch, place: usize) -> DMatrix<f64> {
        let channels = self.noise.ncols();
        DMatrix::from_fn(3 * channels, 3 * channels, |i, j| {
            let share = &stretch.spread[3 * (i / channels) + j / channels];
            share[(place, place)] * self.noise[(i % channels, j % channels)]
        })
    }
}

impl Stretch {
    fn new(run: usize, spline: &RegressionSpline) -> Self {
        let middles: Vec<f64> = spline.basis().middles().collect();
        let motion = |&t: &f64| Motion {
            t,
            derivatives: [0, 1, 2].map(|order| DVector::from_vec(spline.derivative(t, order))),
        };
        let spread = [0, 1, 2].map(|order| {
            let columns = middles
                .iter()
                .map(|&t| DVector::from_vec(spline.spread(t, order)));
            DMatrix::from_columns(&columns.collect::<Vec<_>>())
        });
        let pairs = (0..9).map(|pair| spread[pair / 3].tr_mul(&spread[pair % 3]));
        Self {
            run,
            motions: middles.iter().map(motion).collect(),
            spread: pairs.collect(),
        }
    }
}

/// Complete rows of a record, cut at its gaps.
fn cut(run: usize, record: &Record) -> Vec<Piece> {
    let complete: Vec<usize> = (0..record.times.len())
        .filter(|&row| record.values.row(row).iter().all(|value| value.is_finite()))
        .collect();
    let mut steps: Vec<f64> = complete
        .windows(2)
        .map(|rows| record.times[rows[1]] - record.times[rows[0]])
        .collect();
    if steps.is_empty() {
        return Vec::new();
    }
    let middle = steps.len() / 2;
    let usual = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let parts = complete.chunk_by(|&a, &b| record.times[b] - record.times[a] <= GAP * usual);
    let whole = parts.filter(|rows| rows.len() as f64 > 2.0 * FEWEST_KNOTS * FEWEST_SAMPLES);
    let piece = |rows: &[usize]| Piece {
        run,
        times: rows.iter().map(|&row| record.times[row]).collect(),
        values: record.values.select_rows(rows),
    };
    whole.map(piece).collect()
}

/// The knot spacing in s by the rule of this file, with the residuals.
fn distance(pieces: &[Piece], others: usize) -> Option<(f64, Left)> {
    let shortest = pieces.iter().map(Piece::length).reduce(f64::min)?;
    let step = |piece: &Piece| piece.length() / (piece.times.len() - 1) as f64;
    let closest = FEWEST_SAMPLES * pieces.iter().map(step).fold(0.0, f64::max);
    let mut spacing = shortest / FEWEST_KNOTS;
    let mut found: Option<(f64, Left)> = None;
    let mut settled = 0;
    while spacing >= closest || found.is_none() {
        let Some(left) = Left::of(pieces, spacing) else {
            break;
        };
        let improved = found
            .as_ref()
            .is_none_or(|(_, wide)| wide.is_worse_than(&left, others));
        settled = if improved { 0 } else { settled + 1 };
        found = Some((spacing, left));
        // Two steps without a gain: the second may have been missed by chance.
        if settled == 2 {
            break;
        }
        spacing /= CLOSER;
    }
    found
}
