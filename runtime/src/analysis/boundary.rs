//! Borders of stability as curves over two quantities.

use nalgebra::{DMatrix, DVector};

use super::chart::{Axis, Chart, ChartError, criteria, unknowns};
use super::continuation::{End, OnCurve, follow};
use super::critical::{Change, Criteria};
use super::cyclic::Structure;
use super::equations::SteadyEquations;
use super::newton::{self, Equations};
use super::point::Point;
use super::stability::essential_matrix;
use super::steady::SteadyProblem;
use crate::spectrum::{characteristic_polynomial, eigenvalues};

/// A curve over two quantities on which stability may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// What eigenvalues do there.
    pub change: Change,
    /// Values of the two quantities in SI, in order.
    pub points: Vec<[f64; 2]>,
    /// Where one of the two quantities turns back, to rounding.
    pub folds: Vec<BoundaryFold>,
    /// Whether a motion in the middle of the curve is unstable on one side only: nothing else grows
    /// there.
    pub decides: bool,
    /// Why the curve ends.
    pub ends: [End; 2],
}

/// A place where a boundary runs along one of the quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryFold {
    /// The axis, 0 or 1, whose quantity is largest or smallest here.
    pub axis: usize,
    /// Values of the two quantities in SI. That of the axis is known to rounding; the other to the
    /// root of it, as the curve is flat.
    pub at: [f64; 2],
    /// The motion.
    pub point: Point,
}

/// Points of one curve.
const MOST_POINTS: usize = 4000;
/// Longest step as a part of the range of either quantity.
const LONGEST: f64 = 0.01;
/// Rows and columns of the grid that are searched for boundaries.
const LINES: usize = 40;
/// Curves that are followed at most.
const MOST_CURVES: usize = 40;
/// Real parts above this part of a usual eigenvalue are growth, where eigenvalues that meet are
/// known to the root of rounding.
const GROWS: f64 = 1e-3;
/// Steady motions at which a criterion is zero.
struct CriticalEquations<'a> {
    steady: &'a SteadyEquations<'a>,
    structure: &'a Structure,
    criteria: Criteria,
    which: usize,
}

impl CriticalEquations<'_> {
    fn criterion(&self, z: &DVector<f64>) -> f64 {
        let point = self.steady.point(z);
        let matrix = essential_matrix(self.steady.model, self.structure, &point);
        let polynomial = matrix
            .ok()
            .and_then(|(_, a)| characteristic_polynomial(&a).ok());
        polynomial.map_or(f64::NAN, |p| self.criteria.values(&p)[self.which])
    }
}

impl Equations for CriticalEquations<'_> {
    /// The steady equations and the criterion. Its gradient comes from differences: the value decides
    /// where the curve is, the gradient where it goes.
    fn evaluate(&self, z: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        /// Balances the error of a difference of order four with that of rounding.
        const STEP: f64 = 1e-3;
        let (f, jacobian) = self.steady.evaluate(z);
        let rows = f.len();
        let (mut f, mut jacobian) = (f.insert_row(rows, 0.0), jacobian.insert_row(rows, 0.0));
        f[rows] = self.criterion(z);
        for i in 0..z.len() {
            let at = |steps: f64| {
                let mut z = z.clone();
                z[i] += steps * STEP;
                self.criterion(&z)
            };
            let difference = 8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0));
            jacobian[(rows, i)] = difference / (12.0 * STEP);
        }
        (f, jacobian)
    }
}

/// All boundaries that cross the lines of a chart.
pub(super) fn trace(
    problem: &SteadyProblem<'_>,
    equations: &SteadyEquations<'_>,
    chart: &Chart,
    zeros: usize,
) -> Result<Vec<Boundary>, ChartError> {
    let criteria = criteria(problem, equations, chart, zeros)?;
    let of = |which: usize| {
        let structure = problem.structure();
        let critical = CriticalEquations {
            steady: equations,
            structure,
            criteria,
            which,
        };
        curves(&critical, chart)
    };
    Ok(std::thread::scope(|scope| {
        let pairs = scope.spawn(|| of(1));
        let mut found = of(0);
        found.extend(pairs.join().unwrap_or_default());
        found
    }))
}

/// The curves on which one criterion is zero.
fn curves(critical: &CriticalEquations<'_>, chart: &Chart) -> Vec<Boundary> {
    let mut found = Vec::new();
    let mut curves: Vec<Vec<OnCurve>> = Vec::new();
    for start in starts(critical, chart) {
        if curves.len() >= MOST_CURVES || curves.iter().any(|c| holds(c, &start.z)) {
            continue;
        }
        let (curve, ends) = both_ways(critical, &chart.axes, &start);
        found.extend(describe(critical, &chart.axes, &curve, ends));
        curves.push(curve);
    }
    found
}

/// Points on boundaries, from changes of sign between neighbours on a few lines of the grid.
fn starts(critical: &CriticalEquations<'_>, chart: &Chart) -> Vec<OnCurve> {
    let [x, y] = chart.axes.map(|axis| axis.count);
    let [by_x, by_y] = [x, y].map(|count| (count / LINES).max(1));
    let across = (0..y).step_by(by_y);
    let across = across.map(|j| (0..x).step_by(by_x).map(|i| (i, j)).collect::<Vec<_>>());
    let upward = (0..x).step_by(by_x);
    let upward = upward.map(|i| (0..y).step_by(by_y).map(|j| (i, j)).collect::<Vec<_>>());
    let mut starts = Vec::new();
    for line in across.chain(upward) {
        let mut last: Option<(DVector<f64>, f64)> = None;
        for (i, j) in line {
            let here = chart.cell(i, j).map(|cell| {
                let z = unknowns(critical.steady, cell);
                let value = critical.criterion(&z);
                (z, value)
            });
            if let (Some((a, before)), Some((b, after))) = (&last, &here)
                && before * after < 0.0
            {
                let between = a + (b - a) * (before / (before - after));
                let zero = newton::solve(critical, &between).ok();
                let zero = zero.filter(|zero| {
                    let near = (&zero.z - &between).norm() <= 2.0 * (b - a).norm();
                    zero.family() == 1 && near && inside(critical, &chart.axes, &zero.z)
                });
                starts.extend(zero.and_then(|zero| {
                    let like = zero.kernel().column(0).into_owned();
                    OnCurve::new(critical, zero.z, &like)
                }));
            }
            last = here;
        }
    }
    starts
}

fn place(critical: &CriticalEquations<'_>, axes: &[Axis; 2], z: &DVector<f64>) -> [f64; 2] {
    let point = critical.steady.point(z);
    axes.map(|axis| axis.term.value(critical.steady.model, &point))
}

fn inside(critical: &CriticalEquations<'_>, axes: &[Axis; 2], z: &DVector<f64>) -> bool {
    let place = place(critical, axes, z);
    axes.iter()
        .zip(place)
        .all(|(axis, value)| margin(axis, value) >= 0.0)
}

/// How far a value is inside the range of an axis; negative outside.
fn margin(axis: &Axis, value: f64) -> f64 {
    let [from, to] = axis.range;
    (value - from.min(to)).min(from.max(to) - value)
}

/// The curve through a point, from end to end.
fn both_ways(
    critical: &CriticalEquations<'_>,
    axes: &[Axis; 2],
    start: &OnCurve,
) -> (Vec<OnCurve>, [End; 2]) {
    let longest = |at: &OnCurve| {
        let steps = axes.iter().map(|axis| {
            let (_, gradient) = critical.steady.term(axis.term, &at.z);
            let slope = gradient.dot(&at.tangent).abs();
            LONGEST * (axis.range[1] - axis.range[0]).abs() / slope
        });
        steps.fold(0.1 * (1.0 + at.z.norm()), f64::min)
    };
    let limit = |a: &OnCurve, b: &OnCurve| {
        let there = place(critical, axes, &b.z);
        let left = (0..2).find(|&k| margin(&axes[k], there[k]) < 0.0)?;
        let outside = |z: &DVector<f64>| Some(margin(&axes[left], place(critical, axes, z)[left]));
        let end = a.root(critical, b, outside);
        let end = end.and_then(|z| OnCurve::new(critical, z, &a.tangent));
        Some((end, End::Range))
    };
    let (forward, last) = follow(critical, start, MOST_POINTS, longest, limit);
    if last == End::Closed {
        let mut curve = vec![start.clone()];
        curve.extend(forward);
        return (curve, [last; 2]);
    }
    let mut back = start.clone();
    back.tangent.neg_mut();
    let (mut curve, first) = follow(critical, &back, MOST_POINTS, longest, limit);
    for point in &mut curve {
        point.tangent.neg_mut();
    }
    curve.reverse();
    curve.push(start.clone());
    curve.extend(forward);
    (curve, [first, last])
}

/// Whether a point lies on a curve: as near to a chord as the curve itself.
fn holds(curve: &[OnCurve], z: &DVector<f64>) -> bool {
    /// Of a chord; an arc of ten degrees is half as far away.
    const BESIDE: f64 = 0.05;
    curve.windows(2).any(|pair| {
        let chord = &pair[1].z - &pair[0].z;
        let part = chord.dot(&(z - &pair[0].z)) / chord.norm_squared();
        let beside = &pair[0].z + &chord * part.clamp(0.0, 1.0);
        (z - &beside).norm() <= BESIDE * chord.norm()
    })
}

/// What a curve is for people; nothing where eigenvalues only mirror each other.
fn describe(
    critical: &CriticalEquations<'_>,
    axes: &[Axis; 2],
    curve: &[OnCurve],
    ends: [End; 2],
) -> Option<Boundary> {
    let middle = critical.steady.point(&curve.get(curve.len() / 2)?.z);
    let model = critical.steady.model;
    let (_, matrix) = essential_matrix(model, critical.structure, &middle).ok()?;
    let values = eigenvalues(&matrix).ok()?;
    let change = critical.criteria.change(critical.which, &values)?;
    let grows = GROWS * critical.criteria.unit;
    let decides = values.iter().all(|value| value.re <= grows);
    let mut folds = Vec::new();
    for pair in curve.windows(2) {
        for (axis, quantity) in axes.iter().enumerate() {
            let slope = |z: &DVector<f64>| {
                let at = OnCurve::new(critical, z.clone(), &(&pair[1].z - &pair[0].z))?;
                Some(critical.steady.term(quantity.term, z).1.dot(&at.tangent))
            };
            let signs = pair.iter().map(|at| {
                let gradient = critical.steady.term(quantity.term, &at.z).1;
                gradient.dot(&at.tangent)
            });
            if signs.product::<f64>() < 0.0
                && let Some(z) = pair[0].root(critical, &pair[1], slope)
            {
                let at = place(critical, axes, &z);
                let point = critical.steady.point(&z);
                folds.push(BoundaryFold { axis, at, point });
            }
        }
    }
    Some(Boundary {
        change,
        decides,
        points: curve
            .iter()
            .map(|at| place(critical, axes, &at.z))
            .collect(),
        folds,
        ends,
    })
}
