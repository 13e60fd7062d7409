//! Stability over two quantities: a grid of steady motions with their eigenvalues.

use nalgebra::DVector;

use super::boundary::{self, Boundary};
use super::branch::{BranchError, Requirement};
use super::critical::Criteria;
use super::cyclic::Structure;
use super::equations::SteadyEquations;
use super::newton::{self, Equations as _};
use super::stability::{Verdict, essential_matrix, zero_count};
use super::steady::{Condition, SteadyError, SteadyProblem};
use super::term::Term;
use crate::linearise::Undetermined;
use crate::model::Model;
use crate::spectrum::{Complex, Eigenvalues, SpectrumError, characteristic_polynomial};

/// A quantity with its range and the number of its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The quantity.
    pub term: Term,
    /// First and last value in SI.
    pub range: [f64; 2],
    /// How many values, both ends among them.
    pub count: usize,
}

impl Axis {
    /// A value by its number.
    pub fn value(&self, i: usize) -> f64 {
        let part = i as f64 / self.count.saturating_sub(1).max(1) as f64;
        self.range[0] + part * (self.range[1] - self.range[0])
    }
}

/// A steady motion of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// The essential states and what else is unknown, in SI, in the order of
    /// [`Chart::unknowns`].
    pub unknowns: Vec<f64>,
    /// Eigenvalues without the zeros, largest real part first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// What they say. A grid takes real parts below a millionth of the largest eigenvalue as zero;
    /// where stability changes, the boundaries tell to the last digit.
    pub verdict: Verdict,
    /// Whether the requirements hold.
    pub feasible: bool,
}

/// A stability chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// The horizontal and the vertical quantity.
    pub axes: [Axis; 2],
    /// What [`Cell::unknowns`] are.
    pub unknowns: Vec<Term>,
    /// Cells row by row, the horizontal quantity running fastest; nothing where no steady motion was
    /// found.
    pub cells: Vec<Option<Cell>>,
    /// Where eigenvalues reach the imaginary axis, as curves.
    pub boundaries: Vec<Boundary>,
}

/// Why there is no chart.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChartError {
    /// No steady motions, or conditions that do not fit.
    #[error(transparent)]
    Branch(#[from] BranchError),
    /// A grid that is too small or too large.
    #[error("a chart of {0} × {1} motions cannot be drawn: write two numbers from 2 to {MOST}")]
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

/// Values of one axis at most.
const MOST: usize = 4000;
/// Places along each axis where motions are sought from many starting points.
const SEEDS: usize = 5;
/// Passes over the grid; one or two are usual, a region behind a corner takes more.
const MOST_PASSES: usize = 12;
/// Cells between those that are sought from seeds, where they have no neighbour to begin from.
const STRIDE: usize = 16;
/// Real parts below this part of the largest eigenvalue count as zero.
const REST: f64 = 1e-6;

impl Chart {
    /// Of the motions that satisfy a problem's conditions and have the values of the axes. `starts`
    /// is the number of starting points for each seed; rows are shared among `threads`.
    pub fn of(
        problem: &SteadyProblem<'_>,
        axes: [Axis; 2],
        requirements: &[Requirement],
        starts: usize,
        threads: usize,
    ) -> Result<Self, ChartError> {
        let [x, y] = axes;
        if [x, y].iter().any(|axis| !(2..=MOST).contains(&axis.count)) {
            return Err(ChartError::Grid(x.count, y.count));
        }
        let mut problem = problem.clone();
        for axis in axes {
            problem.release(axis.term)?;
            let [from, to] = axis.range;
            let length = to - from;
            if !length.is_finite() || length == 0.0 {
                let along = axis.term.name(problem.model().info());
                return Err(BranchError::Range { along, from, to }.into());
            }
        }
        for requirement in requirements {
            problem.check(requirement.term)?;
        }
        let equations = scaled(&problem, axes);
        let (seeds, zeros) = seeds(&problem, &equations, axes, starts)?;
        let rows: Vec<usize> = (0..y.count).collect();
        let band = y.count.div_ceil(threads.max(1));
        let filled = std::thread::scope(|scope| {
            let bands = rows.chunks(band).map(|rows| {
                let filler = Filler::new(&problem, &equations, axes, requirements, zeros, &seeds);
                scope.spawn(move || filler.fill(rows))
            });
            let running: Vec<_> = bands.collect();
            let joined = running
                .into_iter()
                .map(|thread| thread.join().unwrap_or_default());
            joined.collect::<Vec<_>>().concat()
        });
        let mut chart = Self {
            axes,
            unknowns: equations.unknowns.clone(),
            cells: filled,
            boundaries: Vec::new(),
        };
        chart.boundaries = boundary::trace(&problem, &equations, &chart, zeros)?;
        Ok(chart)
    }

    /// The cell of the i-th value of the first axis and the j-th of the second.
    pub fn cell(&self, i: usize, j: usize) -> Option<&Cell> {
        let inside = i < self.axes[0].count && j < self.axes[1].count;
        let place = j * self.axes[0].count + i;
        self.cells.get(place).filter(|_| inside)?.as_ref()
    }
}

/// The equations with the quantities of the axes in units of their ranges.
fn scaled<'p>(problem: &'p SteadyProblem<'_>, axes: [Axis; 2]) -> SteadyEquations<'p> {
    let mut equations = problem.equations();
    for (term, scale) in equations.unknowns.iter().zip(&mut equations.scales) {
        for axis in axes.iter().filter(|axis| axis.term == *term) {
            *scale = 0.5 * (axis.range[1] - axis.range[0]).abs();
        }
    }
    equations
}

/// Motions at a few places, found from many starting points, and how many eigenvalues are zero at
/// all of them.
fn seeds(
    problem: &SteadyProblem<'_>,
    equations: &SteadyEquations<'_>,
    axes: [Axis; 2],
    starts: usize,
) -> Result<(Vec<DVector<f64>>, usize), ChartError> {
    let mut seeds = Vec::new();
    let mut zeros = usize::MAX;
    let mut reason = None;
    for i in 0..SEEDS {
        for j in 0..SEEDS {
            let mut here = problem.clone();
            for (axis, k) in axes.iter().zip([i, j]) {
                // Off the middle, where mechanisms are symmetric.
                let part = (k as f64 + 0.53) / SEEDS as f64;
                here.fix(
                    axis.term,
                    axis.range[0] + part * (axis.range[1] - axis.range[0]),
                )?;
            }
            match here.solve_isolated(starts) {
                Ok(motions) => {
                    for motion in motions {
                        let (model, structure) = (problem.model(), problem.structure());
                        let (_, matrix) = essential_matrix(model, structure, &motion.point)?;
                        zeros = zeros.min(zero_count(&matrix)?);
                        seeds.push(equations.unknowns_of(&motion.point));
                    }
                }
                Err(error) => reason = Some(error),
            }
        }
    }
    match reason {
        Some(reason) if seeds.is_empty() => Err(reason.into()),
        _ => Ok((seeds, zeros)),
    }
}

/// Motions of a row of the grid, as unknowns.
type Row = Vec<Option<DVector<f64>>>;

/// Fills rows of the grid, each motion from its neighbours.
struct Filler<'a> {
    model: &'a dyn Model,
    structure: &'a Structure,
    equations: SteadyEquations<'a>,
    axes: [Axis; 2],
    requirements: &'a [Requirement],
    zeros: usize,
    seeds: &'a [DVector<f64>],
    problem: &'a SteadyProblem<'a>,
}

impl<'a> Filler<'a> {
    fn new(
        problem: &'a SteadyProblem<'a>,
        equations: &SteadyEquations<'a>,
        axes: [Axis; 2],
        requirements: &'a [Requirement],
        zeros: usize,
        seeds: &'a [DVector<f64>],
    ) -> Self {
        let mut equations = equations.clone();
        let conditions = axes.map(|axis| Condition {
            term: axis.term,
            value: axis.range[0],
        });
        equations.conditions.extend(conditions);
        Self {
            model: problem.model(),
            structure: problem.structure(),
            equations,
            axes,
            requirements,
            zeros,
            seeds,
            problem,
        }
    }

    /// Down and up in turn, until nothing further is reached.
    fn fill(mut self, rows: &[usize]) -> Vec<Option<Cell>> {
        let count = self.axes[0].count;
        let mut motions: Vec<Row> = vec![vec![None; count]; rows.len()];
        let mut found = 0;
        for pass in 0..MOST_PASSES {
            for place in 0..rows.len() {
                let down = pass % 2 == 0;
                let k = if down { place } else { rows.len() - 1 - place };
                let beside = if down { k.checked_sub(1) } else { Some(k + 1) };
                let mut row = std::mem::take(&mut motions[k]);
                let beside = beside.and_then(|k| motions.get(k));
                self.sweep(rows[k], &mut row, beside, pass == 0 && k % STRIDE == 0);
                motions[k] = row;
            }
            let now = motions.iter().flatten().flatten().count();
            if pass > 0 && now == found {
                break;
            }
            found = now;
        }
        let mut solver = Eigenvalues::new(0);
        let motions = motions.iter().flatten();
        let cell = |z: &Option<DVector<f64>>| z.as_ref().and_then(|z| self.cell(z, &mut solver));
        motions.map(cell).collect()
    }

    /// Fills what a row lacks, forth and back.
    fn sweep(&mut self, j: usize, row: &mut Row, beside: Option<&Row>, seeded: bool) {
        let count = row.len();
        for i in 0..count {
            if row[i].is_none() {
                let before = [i.checked_sub(1), i.checked_sub(2)];
                row[i] = self.solve([i, j], before, row, beside, seeded && i % STRIDE == 0);
            }
        }
        for i in (0..count).rev() {
            if row[i].is_none() {
                let after = [i + 1, i + 2].map(|k| Some(k).filter(|&k| k < count));
                row[i] = self.solve([i, j], after, row, beside, false);
            }
        }
    }

    /// The motion of a cell from the two beside it in its row and one of the next row, or from a seed.
    fn solve(
        &mut self,
        [i, j]: [usize; 2],
        beside: [Option<usize>; 2],
        row: &Row,
        above: Option<&Row>,
        seeded: bool,
    ) -> Option<DVector<f64>> {
        let last = self.equations.conditions.len();
        self.equations.conditions[last - 2].value = self.axes[0].value(i);
        self.equations.conditions[last - 1].value = self.axes[1].value(j);
        let [one, two] = beside.map(|place| row[place?].as_ref());
        let ahead = one.zip(two).map(|(one, two)| one * 2.0 - two);
        let starts = [ahead.as_ref(), one, above.and_then(|row| row[i].as_ref())];
        let near = starts
            .into_iter()
            .flatten()
            .find_map(|start| self.newton(start));
        if near.is_some() || !seeded {
            return near;
        }
        let zero = newton::solve(&self.equations, self.nearest_seed()?).ok()?;
        let inside = self.problem.in_range(&self.equations.point(&zero.z));
        (zero.family() == 0 && inside).then_some(zero.z)
    }

    /// The seed whose values of the axes are nearest to those of the conditions.
    fn nearest_seed(&self) -> Option<&DVector<f64>> {
        let conditions = &self.equations.conditions[self.equations.conditions.len() - 2..];
        let away = |z: &DVector<f64>| {
            let point = self.equations.point(z);
            let part = |k: usize| {
                let [from, to] = self.axes[k].range;
                let value = self.axes[k].term.value(self.model, &point);
                (value - conditions[k].value) / (to - from)
            };
            part(0).hypot(part(1))
        };
        let seeds = self.seeds.iter();
        seeds.min_by(|a, b| away(a).total_cmp(&away(b)))
    }

    /// Newton's method for a motion that stands alone and is near.
    fn newton(&self, start: &DVector<f64>) -> Option<DVector<f64>> {
        /// Steps; two are usual.
        const STEPS: usize = 8;
        /// After a step as short as this the next would be rounding.
        const SHORT: f64 = 1e-7;
        /// A longer step, relative to the motion, leads to another one.
        const FAR: f64 = 1.0;
        /// Unknowns that exceed this, in their scales, run to infinity.
        const INFINITE: f64 = 1e4;
        /// Columns that depend on each other to this part belong to a family.
        const REGULAR: f64 = 1e-9;
        let mut z = start.clone();
        for _ in 0..STEPS {
            let (f, jacobian) = self.equations.evaluate(&z);
            let weights = newton::weights(&jacobian);
            let qr = newton::weighted(&jacobian, &weights).qr();
            let mut target = -f.component_mul(&weights);
            qr.q_tr_mul(&mut target);
            let r = qr.r();
            let diagonal = r.diagonal();
            let regular = diagonal.amin() > REGULAR * diagonal.amax();
            if !regular {
                return None;
            }
            let step = r.solve_upper_triangular(&target.rows(0, r.ncols()))?;
            z += &step;
            let size = step.norm() / (1.0 + z.norm());
            if size.is_nan() || size > FAR || z.norm() > INFINITE {
                return None;
            }
            if size <= SHORT {
                let inside = self.problem.in_range(&self.equations.point(&z));
                return inside.then_some(z);
            }
        }
        None
    }

    fn cell(&self, z: &DVector<f64>, solver: &mut Eigenvalues) -> Option<Cell> {
        let point = self.equations.point(z);
        let (states, matrix) = essential_matrix(self.model, self.structure, &point).ok()?;
        if solver.size() != states.len() {
            *solver = Eigenvalues::new(states.len());
        }
        // Column by column is the transpose, which has the same eigenvalues.
        let mut values = solver.of(matrix.as_slice()).ok()?.to_vec();
        values.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
        values.truncate(states.len() - self.zeros.min(states.len()));
        let largest = values.first().map_or(0.0, |value| value.norm());
        values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        let growth = values.first().map_or(f64::NEG_INFINITY, |value| value.re);
        let verdict = if growth > REST * largest {
            Verdict::Unstable
        } else if growth < -REST * largest {
            Verdict::Asymptotic
        } else {
            Verdict::Neutral
        };
        let holds = |r: &Requirement| r.term.value(self.model, &point) >= r.at_least;
        let scaled = z.iter().zip(&self.equations.scales);
        Some(Cell {
            unknowns: scaled.map(|(z, scale)| z * scale).collect(),
            eigenvalues: values,
            verdict,
            feasible: self.requirements.iter().all(holds),
        })
    }
}

/// Criteria for the motions of a chart, from a few of its cells.
pub(super) fn criteria(
    problem: &SteadyProblem<'_>,
    equations: &SteadyEquations<'_>,
    chart: &Chart,
    zeros: usize,
) -> Result<Criteria, ChartError> {
    /// Cells that are looked at.
    const SAMPLES: usize = 40;
    let cells: Vec<&Cell> = chart.cells.iter().flatten().collect();
    let each = (cells.len() / SAMPLES).max(1);
    let mut polynomials = Vec::new();
    for cell in cells.iter().step_by(each) {
        let z = unknowns(equations, cell);
        let point = equations.point(&z);
        let (_, matrix) = essential_matrix(problem.model(), problem.structure(), &point)?;
        polynomials.push(characteristic_polynomial(&matrix)?);
    }
    Ok(Criteria::of(&polynomials, zeros))
}

/// The unknowns of a cell in units of their scales.
pub(super) fn unknowns(equations: &SteadyEquations<'_>, cell: &Cell) -> DVector<f64> {
    let values = cell.unknowns.iter().zip(&equations.scales);
    DVector::from_iterator(
        cell.unknowns.len(),
        values.map(|(value, scale)| value / scale),
    )
}
