//! Stability charts over two quantities: steady motions with their eigenvalues, and stability
//! boundaries.

pub(crate) mod boundary;
pub(crate) mod grid;
pub(crate) mod grid_continuation;
pub(crate) mod level;
pub(crate) mod plane;

use crate::branch::BranchError;
use crate::branch::continuation::End;
use crate::point::Point;
use crate::stability::Verdict;
use crate::stability::critical::Change;
use crate::steady::SteadyError;
use crate::term::Term;
use appell_runtime::linearise::Undetermined;
use appell_spectra::spectrum::{Complex, SpectrumError};
use plane::Axis;

/// Largest number of values of one axis.
pub(super) const MOST: usize = 4000;

/// A steady motion of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// The essential states and the other unknowns, in SI, in the order of [`Chart::unknowns`].
    pub unknowns: Vec<f64>,
    /// Eigenvalues without the zeros, largest real part first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// The verdict. A grid takes real parts below a millionth of the largest eigenvalue as zero; the
    /// boundaries are exact to rounding.
    pub verdict: Verdict,
    /// Whether the requirements hold.
    pub feasible: bool,
}

/// A stability chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// The horizontal and the vertical quantity.
    pub axes: [Axis; 2],
    /// The quantities of [`Cell::unknowns`].
    pub unknowns: Vec<Term>,
    /// The motions of each grid point, row by row, the horizontal quantity varying fastest: none if
    /// no steady motion was found, several if branches overlap.
    pub cells: Vec<Vec<Cell>>,
    /// Where eigenvalues reach the imaginary axis, as curves.
    pub boundaries: Vec<Boundary>,
    /// Where requirements begin or cease to hold, as curves.
    pub edges: Vec<Edge>,
}

/// A curve over two quantities on which stability may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// What eigenvalues do there.
    pub change: Change,
    /// Values of the two quantities in SI, in order.
    pub points: Vec<[f64; 2]>,
    /// For each point whether stability changes there: no other mode is unstable.
    pub decides: Vec<bool>,
    /// Points where one of the two quantities turns back, to rounding.
    pub folds: Vec<BoundaryFold>,
    /// Why the curve ends.
    pub ends: [End; 2],
}

/// A point where a boundary is parallel to one of the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryFold {
    /// The axis, 0 or 1, whose quantity is extreme here.
    pub axis: usize,
    /// Values of the two quantities in SI. That of the axis is known to rounding, the other to the
    /// square root of it, as the curve is flat.
    pub at: [f64; 2],
    /// The motion.
    pub point: Point,
    /// Whether stability changes here.
    pub decides: bool,
}

/// A curve over two quantities on which a requirement begins or ceases to hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// The number of the requirement.
    pub requirement: usize,
    /// Values of the two quantities in SI, in order.
    pub points: Vec<[f64; 2]>,
}

/// Why a chart could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChartError {
    /// No steady motions, or unsuitable conditions.
    #[error(transparent)]
    Branch(#[from] BranchError),
    /// A grid that is too small or too large.
    #[error("the grid needs 2 to {MOST} points along each axis, not {0} × {1}")]
    Grid(usize, usize),
    /// Position constraints that do not determine their coordinates.
    #[error(transparent)]
    Undetermined(#[from] Undetermined),
    /// Eigenvalues that could not be computed.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

impl From<SteadyError> for ChartError {
    fn from(error: SteadyError) -> Self {
        Self::Branch(error.into())
    }
}

impl Chart {
    /// The motions at the i-th value of the first axis and the j-th of the second.
    pub fn motions(&self, i: usize, j: usize) -> &[Cell] {
        let inside = i < self.axes[0].count && j < self.axes[1].count;
        let place = j * self.axes[0].count + i;
        self.cells
            .get(place)
            .filter(|_| inside)
            .map_or(&[], Vec::as_slice)
    }
}

impl Boundary {
    /// The parts on which stability changes.
    pub fn deciding(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        let mut from = 0;
        let runs = self.decides.chunk_by(|a, b| a == b).filter_map(move |run| {
            let start = from;
            from += run.len();
            // A part extends to the point where the next one begins.
            run[0].then_some(start..(from + 1).min(self.points.len()))
        });
        runs.map(|run| &self.points[run])
    }
}
