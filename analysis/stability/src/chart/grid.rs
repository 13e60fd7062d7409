//! The steady motions of a chart, grid point by grid point.

use std::cmp::Ordering;

use nalgebra::DVector;
use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelIterator as _, IntoParallelRefIterator as _,
    ParallelIterator as _,
};

use super::grid_continuation::GridContinuation;
use super::plane::{Axis, Plane};
use super::{Cell, Chart, ChartError, MOST, boundary};
use crate::branch::{BranchError, Requirement};
use crate::stability::critical::REST;
use crate::stability::{Verdict, zero_count};
use crate::steady::SteadyProblem;
use appell_spectra::spectrum::Eigenvalues;

/// Points along each axis where motions are sought from many starting points.
const SEEDS: usize = 5;

impl Chart {
    /// Of the motions that satisfy a problem's conditions and have the values of the axes. `starts`
    /// is the number of starting points for each seed; rows are shared among `threads`, whose number
    /// does not change the result.
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
            if !axis.length().is_finite() || axis.length() == 0.0 {
                let along = axis.term.name(problem.model().info());
                let [from, to] = axis.range;
                return Err(BranchError::Range { along, from, to }.into());
            }
        }
        for requirement in requirements {
            problem.check(requirement.term)?;
        }
        let plane = Plane::new(&problem, axes);
        let (seeds, zeros) = seeds(&plane, starts)?;
        let judge = Judge {
            plane: &plane,
            requirements,
            zeros,
        };
        let cells = || judge.cells(&motions(&plane, &seeds, starts));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1));
        let mut chart = Self {
            axes,
            unknowns: plane.equations.unknowns.clone(),
            cells: match pool.build() {
                Ok(pool) => pool.install(cells),
                // Where no thread can be started.
                Err(_) => cells(),
            },
            boundaries: Vec::new(),
            edges: Vec::new(),
        };
        chart.boundaries = boundary::boundaries(&plane, &chart, zeros)?;
        chart.edges = boundary::edges(&plane, &chart, requirements);
        Ok(chart)
    }
}

/// Motions at a few points of the plane, found from many starting points, and the number of zero
/// eigenvalues common to all of them.
fn seeds(plane: &Plane<'_>, starts: usize) -> Result<(Vec<DVector<f64>>, usize), ChartError> {
    let problem = plane.problem;
    let mut seeds = Vec::new();
    let mut zeros = usize::MAX;
    let mut reason = None;
    for i in 0..SEEDS {
        for j in 0..SEEDS {
            let mut here = problem.clone();
            for (axis, k) in plane.axes.iter().zip([i, j]) {
                // Off the middle, where mechanisms are symmetric.
                let part = (k as f64 + 0.53) / SEEDS as f64;
                here.fix(axis.term, axis.range[0] + part * axis.length())?;
            }
            match here.solve_isolated(starts) {
                Ok(motions) => {
                    for motion in motions {
                        let (_, matrix) = problem.essential_matrix(&motion.point)?;
                        zeros = zeros.min(zero_count(&matrix)?);
                        seeds.push(plane.equations.unknowns_of(&motion.point));
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

/// The motions of the whole grid: a band for each row of seeds, then across their edges.
fn motions(plane: &Plane<'_>, seeds: &[DVector<f64>], starts: usize) -> Vec<Vec<DVector<f64>>> {
    let rows = plane.axes[1].count;
    let high = rows.div_ceil(SEEDS);
    let filled = |number: usize| {
        let from = number * high;
        let mut band = GridContinuation::over(plane, from..rows.min(from + high));
        for seed in seeds {
            band.seed(seed);
            band.continue_all();
        }
        band
    };
    let numbers = (0..rows.div_ceil(high)).into_par_iter().with_max_len(1);
    let bands = numbers.map(filled).collect();
    let mut all = GridContinuation::joined(plane, bands);
    all.continue_all();
    all.fill_holes(plane.problem, starts);
    all.motions
}

/// Assesses motions.
struct Judge<'a> {
    plane: &'a Plane<'a>,
    requirements: &'a [Requirement],
    zeros: usize,
}

impl Judge<'_> {
    /// The cells of all grid points.
    fn cells(&self, motions: &[Vec<DVector<f64>>]) -> Vec<Vec<Cell>> {
        let motions = motions.par_iter();
        let places = motions.map_init(
            || Eigenvalues::new(0),
            |solver, place| {
                let cells = place.iter().filter_map(|z| self.cell(z, solver));
                let mut cells: Vec<Cell> = cells.collect();
                // In an order that does not depend on how they were found.
                cells.sort_by(|a, b| {
                    let pairs = a.unknowns.iter().zip(&b.unknowns);
                    let mut orders = pairs.map(|(a, b)| rounded(*a).total_cmp(&rounded(*b)));
                    orders
                        .find(|order| order.is_ne())
                        .unwrap_or(Ordering::Equal)
                });
                cells
            },
        );
        places.collect()
    }

    fn cell(&self, z: &DVector<f64>, solver: &mut Eigenvalues) -> Option<Cell> {
        let (problem, equations) = (self.plane.problem, &self.plane.equations);
        let (model, point) = (problem.model(), equations.point(z));
        let (states, matrix) = problem.essential_matrix(&point).ok()?;
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
        let holds = |r: &Requirement| r.term.value(model, &point) >= r.at_least;
        let scaled = z.iter().zip(&equations.scales);
        Some(Cell {
            unknowns: scaled.map(|(z, scale)| z * scale).collect(),
            eigenvalues: values,
            verdict,
            feasible: self.requirements.iter().all(holds),
        })
    }
}

/// A value in SI without its last digits, and zero without a sign.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() + 0.0
}
