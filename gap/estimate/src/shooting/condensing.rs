//! Least squares of segments with gaps: the states are eliminated one after the other by orthogonal
//! transformations, forwards along the motion, until only the free values remain.
//!
//! ```text
//! residuals   r_k + C_k δs_k + D_k δθ                       of the samples of segment k
//! gaps        (s_{k+1} − φ_k − F_k δs_k − P_k δθ + δs_{k+1}) / gap
//! ```
//!
//! No product of transition matrices is formed: unstable directions are determined from the end of
//! a segment, the others from its beginning.

use nalgebra::{DMatrix, DVector};

use super::segment::Segment;
use crate::EstimateError;

/// Weight that holds a state in a step, relative to its scale, so that undetermined states do not
/// move. It does not affect the optimum.
const STAYS: f64 = 1e-4;

/// Weights of the gaps.
pub(super) struct Weights<'t> {
    /// States at the nodes, run by run.
    pub(super) states: &'t [Vec<DVector<f64>>],
    /// Sizes of the states.
    pub(super) sizes: &'t [f64],
    /// Gap relative to the scales.
    pub(super) gap: f64,
    /// Number of free values.
    pub(super) free: usize,
}

/// A state from the next one and the free values: `pivot δs_k + rest (δs_{k+1}, δθ) + right = 0`.
struct Eliminated {
    pivot: DMatrix<f64>,
    rest: DMatrix<f64>,
    right: DVector<f64>,
}

/// The least squares of the free values.
pub(super) struct Condensed {
    runs: Vec<Vec<Eliminated>>,
    /// Rows and right sides that remain, of all runs.
    rows: DMatrix<f64>,
    right: DVector<f64>,
    /// Half of the squares eliminated with the states.
    gained: f64,
}

impl Condensed {
    pub(super) fn of(
        pieces: &[Vec<Segment>],
        weights: &Weights<'_>,
    ) -> Result<Self, EstimateError> {
        let q = weights.free;
        let (mut runs, mut remainders) = (Vec::new(), Vec::new());
        let mut gained = 0.0;
        for (run, pieces) in pieces.iter().enumerate() {
            let mut carried = DMatrix::zeros(0, weights.sizes.len() + q + 1);
            let mut eliminated = Vec::with_capacity(pieces.len());
            for place in 0..pieces.len() {
                let block = block(pieces, run, place, &carried, weights);
                let (pivots, next) = eliminate(block, weights.sizes.len());
                gained += 0.5 * pivots.right.norm_squared();
                eliminated.push(pivots);
                carried = next;
            }
            runs.push(eliminated);
            remainders.push(carried);
        }
        let count = remainders.iter().map(DMatrix::nrows).sum();
        let mut all = DMatrix::zeros(count, q + 1);
        let mut row = 0;
        for remainder in remainders {
            all.rows_mut(row, remainder.nrows()).copy_from(&remainder);
            row += remainder.nrows();
        }
        if all.iter().any(|entry| !entry.is_finite()) {
            let what = "a segment of the motion";
            return Err(EstimateError::Singular { what });
        }
        Ok(Self {
            runs,
            right: all.column(q).into_owned(),
            rows: all.columns(0, q).into_owned(),
            gained,
        })
    }

    /// Information of the free values.
    pub(super) fn information(&self) -> DMatrix<f64> {
        self.rows.tr_mul(&self.rows)
    }

    /// Direction of steepest descent of the free values, the states following.
    pub(super) fn downhill(&self) -> DVector<f64> {
        -self.rows.tr_mul(&self.right)
    }

    /// First-order decrease of half the sum of squares with a change of the free values and the
    /// states that follow.
    pub(super) fn gain(&self, change: &DVector<f64>) -> f64 {
        let after = &self.right + &self.rows * change;
        self.gained + 0.5 * (self.right.norm_squared() - after.norm_squared())
    }

    /// Changes of the states that follow from one of the free values.
    pub(super) fn states(
        &self,
        change: &DVector<f64>,
    ) -> Result<Vec<Vec<DVector<f64>>>, EstimateError> {
        let of_run = |run: &Vec<Eliminated>| {
            let mut states: Vec<DVector<f64>> = Vec::with_capacity(run.len());
            for segment in run.iter().rev() {
                let next = states.last().map_or(&[][..], |state| state.as_slice());
                let known = DVector::from_iterator(
                    next.len() + change.len(),
                    next.iter().chain(change).copied(),
                );
                let right = -(&segment.right + &segment.rest * known);
                let state = segment.pivot.solve_upper_triangular(&right);
                let what = "a segment of the motion";
                states.push(state.ok_or(EstimateError::Singular { what })?);
            }
            states.reverse();
            Ok(states)
        };
        self.runs.iter().map(of_run).collect()
    }

    /// Half the sum of squares.
    pub(super) fn objective(pieces: &[Vec<Segment>], weights: &Weights<'_>) -> f64 {
        let mut sum = 0.0;
        for (run, pieces) in pieces.iter().enumerate() {
            for (place, piece) in pieces.iter().enumerate() {
                let residuals = piece.rows.column(piece.rows.ncols() - 1);
                sum += 0.5 * residuals.norm_squared();
                if place + 1 < pieces.len() {
                    sum +=
                        0.5 * gap(piece, &weights.states[run][place + 1], weights).norm_squared();
                }
            }
        }
        sum
    }
}

/// The gap after a segment in units of the admitted one.
fn gap(piece: &Segment, next: &DVector<f64>, weights: &Weights<'_>) -> DVector<f64> {
    let mut gap = next - &piece.end;
    for (gap, size) in gap.iter_mut().zip(weights.sizes) {
        *gap /= size * weights.gap;
    }
    gap
}

/// All rows that contain the state of a segment: columns of this state, of the next one unless it
/// is the last, of the free values, and the right side.
fn block(
    pieces: &[Segment],
    run: usize,
    place: usize,
    carried: &DMatrix<f64>,
    weights: &Weights<'_>,
) -> DMatrix<f64> {
    let (n, q, piece) = (weights.sizes.len(), weights.free, &pieces[place]);
    let next = if place + 1 < pieces.len() { n } else { 0 };
    let samples = piece.rows.nrows();
    let mut block = DMatrix::zeros(next + carried.nrows() + samples + n, n + next + q + 1);
    if next > 0 {
        // Rows with large weights first, for accuracy of the others.
        let gap = gap(piece, &weights.states[run][place + 1], weights);
        for i in 0..n {
            let weight = 1.0 / (weights.sizes[i] * weights.gap);
            for j in 0..n {
                block[(i, j)] = -weight * piece.by[(i, j)];
            }
            block[(i, n + i)] = weight;
            for j in 0..q {
                block[(i, 2 * n + j)] = -weight * piece.by[(i, n + j)];
            }
            block[(i, 2 * n + q)] = gap[i];
        }
    }
    let mut first = next;
    for rows in [carried, &piece.rows] {
        let initial = block.view_mut((first, 0), (rows.nrows(), n));
        { initial }.copy_from(&rows.columns(0, n));
        let others = block.view_mut((first, n + next), (rows.nrows(), q + 1));
        { others }.copy_from(&rows.columns(n, q + 1));
        first += rows.nrows();
    }
    for i in 0..n {
        block[(first + i, i)] = STAYS / weights.sizes[i];
    }
    block
}

/// The first `n` columns by the others; what remains without them.
fn eliminate(block: DMatrix<f64>, n: usize) -> (Eliminated, DMatrix<f64>) {
    let columns = block.ncols();
    let r = block.qr().unpack_r();
    // The row of the right side alone is the residual.
    let rows = r.nrows().min(columns - 1);
    let others = columns - n - 1;
    let eliminated = Eliminated {
        pivot: r.view((0, 0), (n, n)).into_owned(),
        rest: r.view((0, n), (n, others)).into_owned(),
        right: r.view((0, columns - 1), (n, 1)).column(0).into_owned(),
    };
    let rest = r.view((n, n), (rows - n, columns - n)).into_owned();
    (eliminated, rest)
}
