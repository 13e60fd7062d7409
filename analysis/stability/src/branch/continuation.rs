//! Pseudo-arclength continuation of solution curves (H. B. Keller, 1977).
//!
//! The curve is where F(z) = 0 and F has one independent equation fewer than unknowns. Folds are
//! then regular points. Redundant equations are admissible: steps have minimum norm, by singular
//! values.

use nalgebra::{DMatrix, DVector};

use crate::steady::newton::{Equations, weighted, weights};
use appell_spectra::singular::Singular;

/// A point on a curve.
#[derive(Debug, Clone)]
pub(crate) struct OnCurve {
    /// The unknowns.
    pub(crate) z: DVector<f64>,
    /// Of length 1.
    pub(crate) tangent: DVector<f64>,
    /// Columns of the projection onto independent equations, weighted.
    equations: DMatrix<f64>,
    weights: DVector<f64>,
    jacobian: DMatrix<f64>,
}

/// Why a curve ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The quantity along which it runs reached the end of its range.
    Range,
    /// An essential state reached the end of its declared range: its index.
    State(usize),
    /// It diverges.
    Infinity,
    /// It closed.
    Closed,
    /// A requirement is violated: its number.
    Infeasible(usize),
    /// No further point was found, as the equations are not smooth or not finite; or the curve
    /// returned to itself away from its beginning, where another curve is as close as rounding.
    Lost,
    /// The limit of points was reached.
    Points,
}

/// Smallest step, relative to the size of the unknowns.
const SHORTEST: f64 = 1e-9;
/// A curve whose scaled unknowns exceed this diverges.
const INFINITE: f64 = 1e4;
/// Corrector steps; three are usual.
const MOST_STEPS: usize = 10;
/// A step that is shorter, relative to the point, ends the correction.
const CONVERGED: f64 = 4e-15;
/// Below this, corrections that stop improving are rounding.
const ROUNDING: f64 = 1e-9;
/// Singular values that count as zero in a correction, relative to the largest: those of redundant
/// equations are rounding.
const CORRECTOR_RANK: f64 = 1e-12;
/// Cosine of the largest angle between the tangents of neighbouring points.
const TURN: f64 = 0.985;

/// Corrects `predicted` back to the curve, perpendicular to `normal`. Also returns the number of
/// steps.
pub(crate) fn correct(
    equations: &dyn Equations,
    predicted: &DVector<f64>,
    normal: &DVector<f64>,
) -> Option<(DVector<f64>, usize)> {
    let mut z = predicted.clone();
    let mut last = f64::INFINITY;
    for step in 1..=MOST_STEPS {
        let (f, jacobian) = equations.evaluate(&z);
        if !f
            .iter()
            .chain(jacobian.iter())
            .all(|entry| entry.is_finite())
        {
            return None;
        }
        let weights = weights(&jacobian);
        let rows = jacobian.nrows();
        let mut matrix = weighted(&jacobian, &weights).insert_row(rows, 0.0);
        matrix.row_mut(rows).tr_copy_from(normal);
        let mut target = (-f.component_mul(&weights)).insert_row(rows, 0.0);
        target[rows] = normal.dot(&(predicted - &z));
        let singular = Singular::of(&matrix);
        let change = singular.solve(&target, singular.rank(CORRECTOR_RANK));
        z += &change;
        let size = change.norm() / (1.0 + z.norm());
        let stalled = size > 0.25 * last;
        if size <= CONVERGED || (stalled && size <= ROUNDING) {
            return Some((z, step));
        }
        if stalled && step > 2 {
            return None;
        }
        last = size;
    }
    None
}

impl OnCurve {
    /// A solution with its tangent, oriented along `like`.
    pub(crate) fn new(
        equations: &dyn Equations,
        z: DVector<f64>,
        like: &DVector<f64>,
    ) -> Option<Self> {
        let (_, jacobian) = equations.evaluate(&z);
        if !jacobian.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let weights = weights(&jacobian);
        let jacobian = weighted(&jacobian, &weights);
        let singular = Singular::of(&jacobian);
        let last = singular.values.len().checked_sub(1)?;
        let mut tangent = singular.right.column(last).into_owned();
        if tangent.dot(like) < 0.0 {
            tangent.neg_mut();
        }
        let mut independent = singular.images.columns(0, last).into_owned();
        for mut column in independent.column_iter_mut() {
            let length = column.norm();
            if length > 0.0 {
                column /= length;
            }
        }
        Some(Self {
            z,
            tangent,
            equations: independent,
            weights,
            jacobian,
        })
    }

    /// Whether another curve crosses between this point and `next`: the determinant of the
    /// independent equations and the tangent changes its sign.
    pub(crate) fn passes_crossing(&self, equations: &dyn Equations, next: &Self) -> bool {
        let determinant = |jacobian: &DMatrix<f64>, tangent: &DVector<f64>| {
            let square = self.equations.tr_mul(jacobian);
            let rows = square.nrows();
            let mut square = square.insert_row(rows, 0.0);
            square.row_mut(rows).tr_copy_from(tangent);
            square.determinant()
        };
        let (_, there) = equations.evaluate(&next.z);
        let there = weighted(&there, &self.weights);
        determinant(&self.jacobian, &self.tangent) * determinant(&there, &next.tangent) < 0.0
    }

    /// The next point, at most `step` away, which becomes the length of the following step.
    pub(crate) fn advance(
        &self,
        equations: &dyn Equations,
        step: &mut f64,
        limits: [f64; 2],
    ) -> Option<Self> {
        while *step >= limits[0] {
            let predicted = &self.z + &self.tangent * *step;
            let next = correct(equations, &predicted, &self.tangent)
                .filter(|(z, _)| (z - &predicted).norm() <= 0.5 * *step)
                .and_then(|(z, steps)| {
                    let next = Self::new(equations, z, &self.tangent)?;
                    (next.tangent.dot(&self.tangent) >= TURN).then_some((next, steps))
                });
            if let Some((next, steps)) = next {
                if steps <= 4 {
                    *step = (*step * 1.4).min(limits[1]);
                }
                return Some(next);
            }
            *step *= 0.5;
        }
        None
    }

    /// The point of the curve over a part of the chord to another point of it.
    pub(crate) fn between(
        &self,
        equations: &dyn Equations,
        other: &Self,
        part: f64,
    ) -> Option<DVector<f64>> {
        let chord = &other.z - &self.z;
        let normal = chord.normalize();
        let predicted = &self.z + chord * part;
        correct(equations, &predicted, &normal).map(|(z, _)| z)
    }

    /// The zero, to rounding, of a function of the unknowns that has different signs at two points.
    pub(crate) fn root(
        &self,
        equations: &dyn Equations,
        other: &Self,
        function: impl Fn(&DVector<f64>) -> Option<f64>,
    ) -> Option<DVector<f64>> {
        let value = |part: f64| {
            let z = self.between(equations, other, part)?;
            function(&z)
        };
        let part = root([0.0, 1.0], [function(&self.z)?, function(&other.z)?], value)?;
        self.between(equations, other, part)
    }
}

/// The curve through a point along its tangent, from end to end, with why it ends on both sides; `follow` gives the
/// points after one along its tangent.
pub(crate) fn both_ways(
    start: &OnCurve,
    follow: impl Fn(&OnCurve) -> (Vec<OnCurve>, End),
) -> (Vec<OnCurve>, [End; 2]) {
    let (forward, last) = follow(start);
    let (mut points, first) = if last == End::Closed {
        (Vec::new(), last)
    } else {
        let mut back = start.clone();
        back.tangent.neg_mut();
        let (points, first) = follow(&back);
        (turned(points), first)
    };
    points.push(start.clone());
    points.extend(forward);
    (points, [first, last])
}

/// A curve from its other end.
pub(crate) fn turned(mut points: Vec<OnCurve>) -> Vec<OnCurve> {
    points.reverse();
    for point in &mut points {
        point.tangent.neg_mut();
    }
    points
}

/// Points after `start` along its tangent, with steps of at most `longest`, until `limit` returns
/// an end between two of them.
pub(crate) fn follow(
    equations: &dyn Equations,
    start: &OnCurve,
    most_points: usize,
    longest: impl Fn(&OnCurve) -> f64,
    limit: impl Fn(&OnCurve, &OnCurve) -> Option<(Option<OnCurve>, End)>,
) -> (Vec<OnCurve>, End) {
    let mut points: Vec<OnCurve> = Vec::new();
    let mut step = 0.1 * longest(start);
    // Where two curves nearly meet a step may jump to the other, and the start is not reached
    // again.
    let mut mark: Option<OnCurve> = None;
    loop {
        let last = points.last().unwrap_or(start);
        let size = 1.0 + last.z.norm();
        if points.len() >= most_points {
            return (points, End::Points);
        }
        if size > INFINITE {
            return (points, End::Infinity);
        }
        let longest = longest(last);
        step = step.min(longest);
        let Some(next) = last.advance(equations, &mut step, [SHORTEST * size, longest]) else {
            return (points, End::Lost);
        };
        let travelled = (&next.z - &last.z).norm();
        let back_at = |other: &OnCurve| {
            let near = (&next.z - &other.z).norm() < 0.75 * travelled;
            near && next.tangent.dot(&other.tangent) > 0.0
        };
        if points.len() > 4 && back_at(start) {
            points.push(start.clone());
            return (points, End::Closed);
        }
        if mark.as_ref().is_some_and(back_at) {
            return (points, End::Lost);
        }
        if let Some((end, why)) = limit(last, &next) {
            points.extend(end);
            return (points, why);
        }
        points.push(next);
        // Marks at doubling distances detect a cycle of any length (R. P. Brent, 1980).
        if points.len() > 4 && points.len().is_power_of_two() {
            mark = points.last().cloned();
        }
    }
}

/// The zero of a function between two points of different sign, to rounding: bracketed secants
/// (Anderson and Björck, BIT 13, 1973), and bisection where they fail.
pub(crate) fn root(
    [mut a, mut b]: [f64; 2],
    [mut f_a, mut f_b]: [f64; 2],
    function: impl Fn(f64) -> Option<f64>,
) -> Option<f64> {
    if f_a == 0.0 {
        return Some(a);
    }
    if f_b == 0.0 {
        return Some(b);
    }
    if f_a * f_b > 0.0 || !(f_a * f_b).is_finite() {
        return None;
    }
    for round in 0..200 {
        let chord = b - f_b * (b - a) / (f_b - f_a);
        let inside = chord > a.min(b) && chord < a.max(b);
        let c = if inside && round % 4 != 3 {
            chord
        } else {
            f64::midpoint(a, b)
        };
        let f_c = function(c)?;
        if f_c == 0.0 {
            return Some(c);
        }
        if f_c.signum() == f_b.signum() {
            let kept = 1.0 - f_c / f_b;
            f_a *= if kept > 0.0 { kept } else { 0.5 };
        } else {
            (a, f_a) = (b, f_b);
        }
        (b, f_b) = (c, f_c);
        if (b - a).abs() <= 2.0 * f64::EPSILON * b.abs().max(a.abs()) {
            break;
        }
    }
    Some(b)
}
