//! Parameters by adjustment of recorded motions to the equations: errors in variables.
//!
//! The equations of a motion x = (q, q̇, q̈, u) are `e(x, β) = Y_b(x) β + r(x) = 0`. The recorded motion x₀ has errors of
//! covariance C, which the splines give. Their sum of squares, weighted by C⁻¹, is minimised under the equations
//! (Gauss–Helmert model): about a motion x and values β with J = ∂e/∂x
//!
//! ```text
//! w = e(x, β) + J (x₀ − x),   V = J C Jᵀ + τ²,   Yᵀ V⁻¹ Y δβ = −Yᵀ V⁻¹ w
//! λ = V⁻¹ (w + Y δβ),   x ← x₀ − C Jᵀ λ
//! ```
//!
//! Least squares of Y(x₀) β = −r(x₀) are biased towards zero where noisy accelerations are regressors (attenuation);
//! here Y is that of the adjusted motion. τ² is the variance of unmodelled forces, where e exceeds the noise.

use std::ops::Range;

use appell_estimate::inverse::Motion;
use appell_estimate::{HALF_WIDTH_95, in_parallel};
use appell_recordings::Part;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::equations::LinearEquations;
use super::error::BaseError;
use super::moments::{Recorded, Stretch};

/// Largest number of equations whose covariance is a full matrix.
const MOST_ROWS: usize = 192;
/// Largest number of adjustments of the motion, and of τ between two of them.
const ADJUSTMENTS: usize = 20;
const LEVELS: usize = 3;
/// The search ends within this part of a standard deviation.
const SETTLED: f64 = 1e-2;
/// Significance, in standard deviations, of unmodelled forces.
const CHANCE: f64 = 3.0;
/// First τ², relative to the mean square of e.
const FIRST_LEVEL: f64 = 1e-2;
/// Relative step of a difference.
const DIFFERENCE: f64 = 1e-5;
/// Eigenvalues of the normalised information below this part of the largest are zero.
const ZERO: f64 = 1e-12;
/// Length of a block of correlated residuals in s, and the least number of blocks.
const BLOCK_S: f64 = 1.0;
const FEWEST_BLOCKS: f64 = 10.0;

/// The equations of a motion, by all of its columns, with the base parameters alone.
pub(super) type Equations<'e> = &'e (dyn Fn(&Motion) -> Result<LinearEquations, BaseError> + Sync);

/// Adjusted parameters.
pub(super) struct Adjusted {
    pub(super) values: DVector<f64>,
    /// Half widths of 95 % intervals over that of a standard normal distribution.
    pub(super) deviations: DVector<f64>,
    /// Condition number of the regressor with columns of equal length.
    pub(super) condition: f64,
}

/// A part of a stretch, and its motion as adjusted so far.
struct Piece<'s> {
    stretch: &'s Stretch,
    rows: Range<usize>,
    motions: Vec<Motion>,
}

/// The equations about a motion.
struct Linear {
    base: DMatrix<f64>,
    w: DVector<f64>,
    v: DMatrix<f64>,
    /// C Jᵀ without the correlation between motions: by the order of the derivative.
    noise: Vec<[DMatrix<f64>; 3]>,
}

struct Whitened {
    cholesky: Cholesky<f64, Dyn>,
    base: DMatrix<f64>,
    w: DVector<f64>,
}

/// The solution of the normal equations.
struct Solved {
    change: DVector<f64>,
    inverse: DMatrix<f64>,
    condition: f64,
}

pub(super) fn adjust(
    recorded: &Recorded<'_>,
    equations: Equations<'_>,
    start: DVector<f64>,
    speeds: usize,
) -> Result<Adjusted, BaseError> {
    let mut pieces = pieces(recorded, speeds);
    let sizes = sizes(recorded);
    let mut values = start;
    let mut levels = DVector::zeros(speeds);
    for adjustment in 1.. {
        let linear = in_parallel(&pieces, |piece| {
            linearise(piece, equations, &values, &recorded.noise, &sizes)
        });
        let linear: Vec<Linear> = linear.into_iter().collect::<Result<_, _>>()?;
        let mut whitened = whiten(&linear, &levels)?;
        let mut solved = solve(&whitened)?;
        if levels.max() <= 0.0 && adjustment > 1 && is_more_than_noise(&whitened, &solved) {
            levels = first_levels(&linear, &solved.change, speeds);
        }
        if levels.max() > 0.0 {
            for _ in 0..LEVELS {
                whitened = whiten(&linear, &levels)?;
                solved = solve(&whitened)?;
                update_levels(&mut levels, &whitened, &solved.change);
            }
        }
        let multipliers: Vec<DVector<f64>> = (whitened.iter())
            .map(|own| own.multipliers(&solved.change))
            .collect();
        for ((piece, linear), lambda) in pieces.iter_mut().zip(&linear).zip(&multipliers) {
            piece.adjust(linear, lambda, speeds);
        }
        values += &solved.change;
        let found = Adjusted::new(&pieces, &linear, &multipliers, &whitened, &values, &solved);
        let is_settled = (solved.change.iter().zip(found.deviations.iter()))
            .all(|(change, deviation)| change.abs() <= SETTLED * deviation);
        if is_settled && adjustment > 1 || adjustment == ADJUSTMENTS {
            return Ok(found);
        }
    }
    Err(BaseError::NotFinite)
}

/// Parts of the training stretches whose equations are few enough.
fn pieces<'s>(recorded: &'s Recorded<'_>, speeds: usize) -> Vec<Piece<'s>> {
    let training = recorded
        .stretches
        .iter()
        .filter(|own| own.part == Part::Fit);
    let cut = training.flat_map(|stretch| {
        let rows = stretch.motions.len();
        let count = (rows * speeds).div_ceil(MOST_ROWS).max(1);
        (0..count).map(move |part| {
            let rows = part * rows / count..(part + 1) * rows / count;
            Piece {
                stretch,
                motions: stretch.motions[rows.clone()].to_vec(),
                rows,
            }
        })
    });
    cut.collect()
}

/// Root mean squares of all columns and their derivatives.
fn sizes(recorded: &Recorded<'_>) -> [DVector<f64>; 3] {
    let motions = || recorded.stretches.iter().flat_map(|own| &own.motions);
    let count = motions().count().max(1) as f64;
    [0, 1, 2].map(|order| {
        let mut squares = DVector::zeros(recorded.noise.nrows());
        for motion in motions() {
            squares += motion.derivatives[order].map(|value| value * value);
        }
        squares.map(|square: f64| (square / count).sqrt().max(DIFFERENCE))
    })
}

fn linearise(
    piece: &Piece<'_>,
    equations: Equations<'_>,
    values: &DVector<f64>,
    noise: &DMatrix<f64>,
    sizes: &[DVector<f64>; 3],
) -> Result<Linear, BaseError> {
    let e = |motion: &Motion| {
        let own = equations(motion)?;
        let e = &own.regressor * values + &own.rest;
        Ok::<_, BaseError>((own.regressor, e))
    };
    let columns = noise.nrows();
    let (mut bases, mut w, mut jacobians) = (Vec::new(), Vec::new(), Vec::new());
    for (motion, row) in piece.motions.iter().zip(piece.rows.clone()) {
        let (base, mut own) = e(motion)?;
        let mut by = [0, 1, 2].map(|_| DMatrix::zeros(own.len(), columns));
        let recorded = &piece.stretch.motions[row];
        for (order, by) in by.iter_mut().enumerate() {
            // Of inputs only the value counts.
            let count = if order == 0 {
                columns
            } else {
                piece.stretch.coordinates
            };
            for column in 0..count {
                let h = DIFFERENCE * sizes[order][column];
                let at = |sign: f64| {
                    let mut moved = motion.clone();
                    moved.derivatives[order][column] += sign * h;
                    Ok::<_, BaseError>(e(&moved)?.1)
                };
                by.set_column(column, &((at(1.0)? - at(-1.0)?) / (2.0 * h)));
            }
            own += &*by * (&recorded.derivatives[order] - &motion.derivatives[order]);
        }
        bases.push(base);
        w.extend_from_slice(own.as_slice());
        jacobians.push(by);
    }
    let w = DVector::from_vec(w);
    if !w.iter().all(|entry| entry.is_finite()) {
        return Err(BaseError::NotFinite);
    }
    let spread: Vec<[DMatrix<f64>; 3]> = (jacobians.iter())
        .map(|by| by.each_ref().map(|by| noise * by.transpose()))
        .collect();
    Ok(Linear {
        base: stacked(&bases),
        w,
        v: piece.covariance(&jacobians, &spread),
        noise: spread,
    })
}

fn stacked(blocks: &[DMatrix<f64>]) -> DMatrix<f64> {
    let (rows, columns) = blocks.first().map_or((0, 0), DMatrix::shape);
    let mut whole = DMatrix::zeros(rows * blocks.len(), columns);
    for (place, block) in blocks.iter().enumerate() {
        whole.rows_mut(place * rows, rows).copy_from(block);
    }
    whole
}

impl Piece<'_> {
    /// From the first motion to the last in s.
    fn length(&self) -> f64 {
        match &self.motions[..] {
            [first, .., last] => last.t - first.t,
            _ => 0.0,
        }
    }

    /// J C Jᵀ.
    fn covariance(
        &self,
        jacobians: &[[DMatrix<f64>; 3]],
        noise: &[[DMatrix<f64>; 3]],
    ) -> DMatrix<f64> {
        let speeds = jacobians.first().map_or(0, |by| by[0].nrows());
        let mut v = DMatrix::zeros(speeds * jacobians.len(), speeds * jacobians.len());
        for (i, by) in jacobians.iter().enumerate() {
            for (j, noise) in noise.iter().enumerate().take(i + 1) {
                let mut block = DMatrix::zeros(speeds, speeds);
                for (r, by) in by.iter().enumerate() {
                    for (s, noise) in noise.iter().enumerate() {
                        block.gemm(self.share(r, s, [i, j]), by, noise, 1.0);
                    }
                }
                v.view_mut((i * speeds, j * speeds), (speeds, speeds))
                    .copy_from(&block);
                v.view_mut((j * speeds, i * speeds), (speeds, speeds))
                    .tr_copy_from(&block);
            }
        }
        v
    }

    /// The covariance between derivatives of two motions, times that of the samples.
    fn share(&self, r: usize, s: usize, [i, j]: [usize; 2]) -> f64 {
        let first = self.rows.start;
        self.stretch.shares[3 * r + s][(first + i, first + j)]
    }

    /// x ← x₀ − C Jᵀ λ.
    fn adjust(&mut self, linear: &Linear, lambda: &DVector<f64>, speeds: usize) {
        let pushed: Vec<[DVector<f64>; 3]> = (linear.noise.iter().enumerate())
            .map(|(j, noise)| {
                let own = lambda.rows(j * speeds, speeds);
                noise.each_ref().map(|noise| noise * own)
            })
            .collect();
        for i in 0..self.motions.len() {
            let recorded = &self.stretch.motions[self.rows.start + i];
            for r in 0..3 {
                let mut value = recorded.derivatives[r].clone();
                for (j, pushed) in pushed.iter().enumerate() {
                    for (s, pushed) in pushed.iter().enumerate() {
                        value.axpy(-self.share(r, s, [i, j]), pushed, 1.0);
                    }
                }
                self.motions[i].derivatives[r] = value;
            }
        }
    }
}

/// Rows of unit covariance.
fn whiten(linear: &[Linear], levels: &DVector<f64>) -> Result<Vec<Whitened>, BaseError> {
    let whitened = in_parallel(linear, |own: &Linear| {
        let rows = own.w.len();
        // Rounding of nearly dependent rows.
        let floor =
            1e-12 * own.v.trace() / rows as f64 + 1e-14 * own.w.norm_squared() / rows as f64;
        let mut v = own.v.clone();
        for row in 0..rows {
            v[(row, row)] += levels[row % levels.len()] + floor.max(f64::MIN_POSITIVE);
        }
        let cholesky = Cholesky::new(v)?;
        let lower = cholesky.l_dirty();
        Some(Whitened {
            base: lower.solve_lower_triangular(&own.base)?,
            w: lower.solve_lower_triangular(&own.w)?,
            cholesky,
        })
    });
    let whitened: Option<Vec<Whitened>> = whitened.into_iter().collect();
    whitened.ok_or(BaseError::NotFinite)
}

fn solve(whitened: &[Whitened]) -> Result<Solved, BaseError> {
    let count = whitened.first().map_or(0, |own| own.base.ncols());
    let (mut information, mut reached) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for own in whitened {
        information += own.base.tr_mul(&own.base);
        reached -= own.base.tr_mul(&own.w);
    }
    // Columns of equal length, so that units do not matter.
    let scale = information.diagonal().map(|square| match square {
        square if square > 0.0 => 1.0 / square.sqrt(),
        _ => 0.0,
    });
    let scaled = DMatrix::from_fn(count, count, |i, j| {
        scale[i] * information[(i, j)] * scale[j]
    });
    if !scaled.iter().all(|entry| entry.is_finite()) {
        return Err(BaseError::NotFinite);
    }
    let eigen = scaled.symmetric_eigen();
    let (largest, smallest) = (eigen.eigenvalues.max(), eigen.eigenvalues.min());
    let rank = (eigen.eigenvalues.iter())
        .filter(|&&value| value > ZERO * largest)
        .count();
    if rank < count {
        return Err(BaseError::TooLittle { rank, count });
    }
    let inverse = &eigen.eigenvectors
        * DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| 1.0 / value))
        * eigen.eigenvectors.transpose();
    let inverse = DMatrix::from_fn(count, count, |i, j| scale[i] * inverse[(i, j)] * scale[j]);
    Ok(Solved {
        change: &inverse * reached,
        inverse,
        condition: (largest / smallest).sqrt(),
    })
}

/// Mean square of the whitened residuals, and their degrees of freedom.
fn normalised_square(whitened: &[Whitened], change: &DVector<f64>) -> (f64, f64) {
    let squares = |own: &Whitened| (&own.w + &own.base * change).norm_squared();
    let rows: usize = whitened.iter().map(|own| own.w.len()).sum();
    let freedom = rows.saturating_sub(change.len()).max(1) as f64;
    (whitened.iter().map(squares).sum::<f64>() / freedom, freedom)
}

fn is_more_than_noise(whitened: &[Whitened], solved: &Solved) -> bool {
    let (square, freedom) = normalised_square(whitened, &solved.change);
    square > 1.0 + CHANCE * (2.0 / freedom).sqrt()
}

/// First τ² of each pseudo-velocity.
fn first_levels(linear: &[Linear], change: &DVector<f64>, speeds: usize) -> DVector<f64> {
    let mut squares = DVector::zeros(speeds);
    let mut count: f64 = 0.0;
    for own in linear {
        let left = &own.w + &own.base * change;
        for (row, left) in left.iter().enumerate() {
            squares[row % speeds] += left * left;
        }
        count += left.len() as f64 / speeds as f64;
    }
    squares * (FIRST_LEVEL / count.max(1.0))
}

/// τ² by the squares of λ over their expectation, the diagonal of V⁻¹.
fn update_levels(levels: &mut DVector<f64>, whitened: &[Whitened], change: &DVector<f64>) {
    let speeds = levels.len();
    // A column of the squares, and one of their expectations.
    let parts = in_parallel(whitened, |own: &Whitened| {
        let lambda = own.multipliers(change);
        let inverse = own.cholesky.inverse();
        let mut sums = DMatrix::zeros(speeds, 2);
        for row in 0..lambda.len() {
            sums[(row % speeds, 0)] += lambda[row] * lambda[row];
            sums[(row % speeds, 1)] += inverse[(row, row)];
        }
        sums
    });
    let sums: DMatrix<f64> = (parts.iter()).fold(DMatrix::zeros(speeds, 2), |sum, own| sum + own);
    for (level, sums) in levels.iter_mut().zip(sums.row_iter()) {
        *level *= sums[0] / sums[1].max(f64::MIN_POSITIVE);
    }
}

impl Whitened {
    /// λ = V⁻¹ (w + Y δβ).
    fn multipliers(&self, change: &DVector<f64>) -> DVector<f64> {
        let left = &self.w + &self.base * change;
        let lower = self.cholesky.l_dirty();
        lower.tr_solve_lower_triangular(&left).unwrap_or(left)
    }
}

impl Adjusted {
    /// The wider of two intervals: by the noise, and by the scores of blocks, which are valid whatever the correlation
    /// within a block.
    fn new(
        pieces: &[Piece<'_>],
        linear: &[Linear],
        multipliers: &[DVector<f64>],
        whitened: &[Whitened],
        values: &DVector<f64>,
        solved: &Solved,
    ) -> Self {
        let count = values.len();
        let (square, _) = normalised_square(whitened, &solved.change);
        let length: f64 = pieces.iter().map(Piece::length).sum();
        let block = BLOCK_S.min(length / FEWEST_BLOCKS);
        let (mut spread, mut blocks) = (DMatrix::zeros(count, count), 0.0);
        for ((piece, linear), lambda) in pieces.iter().zip(linear).zip(multipliers) {
            let speeds = lambda.len() / piece.motions.len().max(1);
            let parts = (piece.length() / block).round().max(1.0);
            let start = piece.motions.first().map_or(0.0, |motion| motion.t);
            let part = |motion: &Motion| {
                let passed = (motion.t - start) / piece.length().max(f64::MIN_POSITIVE);
                (passed * parts).floor().min(parts - 1.0)
            };
            let mut row = 0;
            for own in piece
                .motions
                .chunk_by(|a, b| part(a).total_cmp(&part(b)).is_eq())
            {
                let rows = own.len() * speeds;
                let score = linear.base.rows(row, rows).tr_mul(&lambda.rows(row, rows));
                spread += &score * score.transpose();
                blocks += 1.0;
                row += rows;
            }
        }
        // The variance of the scores has as many samples as there are blocks.
        let freedom = f64::max(blocks - 1.0, 1.0);
        let robust = &solved.inverse * (spread * (blocks / freedom)) * &solved.inverse;
        let wider = student_half_width_95(freedom) / HALF_WIDTH_95;
        let deviation = |i: usize| {
            let by_noise = (solved.inverse[(i, i)] * f64::max(square, 1.0)).sqrt();
            by_noise.max(wider * robust[(i, i)].max(0.0).sqrt())
        };
        Self {
            values: values.clone(),
            deviations: DVector::from_fn(count, |i, _| deviation(i)),
            condition: solved.condition,
        }
    }
}

/// Half the width of a 95 % interval of Student's distribution (R. A. Fisher and E. A. Cornish, 1960).
fn student_half_width_95(freedom: f64) -> f64 {
    let z = HALF_WIDTH_95;
    let square = z * z;
    let first = z * (square + 1.0) / 4.0;
    let second = z * ((5.0 * square + 16.0) * square + 3.0) / 96.0;
    let third = z * (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0;
    z + (first + (second + third / freedom) / freedom) / freedom
}

#[cfg(test)]
mod tests {
    use super::student_half_width_95;

    #[test]
    fn intervals_of_few_blocks_are_those_of_student() {
        // Tables.
        for (freedom, wanted) in [(9.0, 2.262), (20.0, 2.086), (1e6, 1.960)] {
            let found = student_half_width_95(freedom);
            assert!((found - wanted).abs() < 1e-3, "{freedom}: {found}");
        }
    }
}
