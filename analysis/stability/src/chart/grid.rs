//! The steady motions of a chart, grid point by grid point.

use std::cmp::Ordering;
use std::iter;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use nalgebra::DVector;

use super::boundary;
use super::grid_continuation::GridContinuation;
use super::plane::{Axis, Plane};
use super::{Cell, Chart, ChartError, MOST};
use crate::branch::{BranchError, Requirement};
use crate::stability::critical::REST;
use crate::stability::{Verdict, essential_matrix, zero_count};
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
        let motions = motions(&plane, &seeds, starts, threads);
        let judge = Judge {
            plane: &plane,
            requirements,
            zeros,
        };
        let mut chart = Self {
            axes,
            unknowns: plane.equations.unknowns.clone(),
            cells: judge.cells(&motions, threads),
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
                        let (model, structure) = (problem.model(), problem.structure());
                        let (_, matrix) = essential_matrix(model, structure, &motion.point)?;
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

/// The motions of the whole grid: a band for each row of seeds, then across their edges. The work in
/// bands differs, so each thread takes the next one when it is free.
fn motions(
    plane: &Plane<'_>,
    seeds: &[DVector<f64>],
    starts: usize,
    threads: usize,
) -> Vec<Vec<DVector<f64>>> {
    let rows = plane.axes[1].count;
    let high = rows.div_ceil(SEEDS);
    let filled = |from: usize| {
        let mut band = GridContinuation::over(plane, from..rows.min(from + high));
        for seed in seeds {
            band.seed(seed);
            band.continue_all();
        }
        band
    };
    let next = AtomicUsize::new(0);
    let taken = || {
        let from = iter::repeat_with(|| next.fetch_add(high, Relaxed));
        let bands = from.take_while(|&from| from < rows).map(filled);
        bands.collect::<Vec<_>>()
    };
    let mut bands: Vec<GridContinuation<'_>> = std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(taken)).collect();
        let taken = running.into_iter().filter_map(|bands| bands.join().ok());
        taken.flatten().collect()
    });
    bands.sort_by_key(GridContinuation::first_row);
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
    /// The cells of all grid points, shared among threads.
    fn cells(&self, motions: &[Vec<DVector<f64>>], threads: usize) -> Vec<Vec<Cell>> {
        let share = motions.len().div_ceil(threads.max(1)).max(1);
        std::thread::scope(|scope| {
            let part = |motions| scope.spawn(move || self.part(motions));
            let running: Vec<_> = motions.chunks(share).map(part).collect();
            let parts = running.into_iter();
            parts
                .flat_map(|part| part.join().unwrap_or_default())
                .collect()
        })
    }

    fn part(&self, motions: &[Vec<DVector<f64>>]) -> Vec<Vec<Cell>> {
        let mut solver = Eigenvalues::new(0);
        let places = motions.iter().map(|place| {
            let cells = place.iter().filter_map(|z| self.cell(z, &mut solver));
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
        });
        places.collect()
    }

    fn cell(&self, z: &DVector<f64>, solver: &mut Eigenvalues) -> Option<Cell> {
        let (problem, equations) = (self.plane.problem, &self.plane.equations);
        let (model, point) = (problem.model(), equations.point(z));
        let (states, matrix) = essential_matrix(model, problem.structure(), &point).ok()?;
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
