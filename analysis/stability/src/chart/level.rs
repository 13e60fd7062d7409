//! Curves over a plane on which a function of the steady motions is zero.
//!
//! They begin where the function has different signs at two neighbouring grid points.

use nalgebra::{DMatrix, DVector};

use super::grid_continuation::nearest;
use super::plane::{Plane, between};
use super::{Cell, Chart};
use crate::branch::continuation::{End, OnCurve, both_ways, follow, root};
use crate::steady::newton::Equations;

/// A function of the unknowns of steady motions.
pub(crate) struct Level<'a> {
    pub(crate) plane: &'a Plane<'a>,
    pub(crate) function: &'a dyn Fn(&DVector<f64>) -> f64,
}

/// A curve from end to end.
pub(crate) struct Curve {
    pub(crate) points: Vec<OnCurve>,
    pub(crate) ends: [End; 2],
    places: Vec<[f64; 2]>,
}

/// Points of one curve.
const MOST_POINTS: usize = 4000;
/// Longest step as a part of the range of either quantity.
const LONGEST: f64 = 0.01;
/// Largest number of curves.
const MOST_CURVES: usize = 100;

impl Equations for Level<'_> {
    /// The steady equations and the function. Its gradient, by differences, affects only the
    /// direction of the curve.
    fn evaluate(&self, z: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        /// Balances the error of a difference of order four with that of rounding.
        const STEP: f64 = 1e-3;
        let (f, jacobian) = self.plane.equations.evaluate(z);
        let rows = f.len();
        let (mut f, mut jacobian) = (f.insert_row(rows, 0.0), jacobian.insert_row(rows, 0.0));
        f[rows] = (self.function)(z);
        for i in 0..z.len() {
            let at = |steps: f64| {
                let mut z = z.clone();
                z[i] += steps * STEP;
                (self.function)(&z)
            };
            let difference = 8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0));
            jacobian[(rows, i)] = difference / (12.0 * STEP);
        }
        (f, jacobian)
    }
}

impl Level<'_> {
    /// All curves that pass between grid points of a chart. `sign` returns that of the function at
    /// a motion of the chart, or 0.
    pub(crate) fn curves(&self, chart: &Chart, sign: impl Fn(&Cell) -> f64) -> Vec<Curve> {
        let mut curves: Vec<Curve> = Vec::new();
        for [a, b] in pairs(self.plane, chart, sign) {
            if curves.len() >= MOST_CURVES {
                break;
            }
            let middle = (&a + &b) * 0.5;
            let reach = (&b - &a).norm();
            if curves
                .iter()
                .any(|curve| self.passes(curve, &middle, reach))
            {
                continue;
            }
            if let Some(start) = self.start(&a, &b) {
                curves.push(self.both_ways(&start));
            }
        }
        curves
    }

    /// The zero between two neighbouring motions, unless it is a pole.
    fn start(&self, a: &DVector<f64>, b: &DVector<f64>) -> Option<OnCurve> {
        /// Largest value of the function at a zero, relative to those on either side: at a pole it is
        /// larger than they are.
        const LARGEST_AT_ZERO: f64 = 1e-3;
        let [here, there] = [a, b].map(|z| self.plane.coordinates(z));
        let motion = |part: f64| {
            let z = a + (b - a) * part;
            self.plane.near(between(here, there, part), &z)
        };
        let value = |part: f64| Some((self.function)(&motion(part)?));
        let signs = [(self.function)(a), (self.function)(b)];
        let z = motion(root([0.0, 1.0], signs, value)?)?;
        let size = signs[0].abs().max(signs[1].abs());
        let zero = (self.function)(&z).abs() <= LARGEST_AT_ZERO * size && self.plane.holds(&z);
        let either_way = DVector::from_element(z.len(), 1.0);
        OnCurve::new(self, z, &either_way).filter(|_| zero)
    }

    /// Whether a curve passes within a distance of a motion.
    fn passes(&self, curve: &Curve, z: &DVector<f64>, reach: f64) -> bool {
        let place = self.plane.coordinates(z);
        let near = |other: &[f64; 2]| {
            let axes = self.plane.axes.iter().zip(place.iter().zip(other));
            let mut apart = axes.map(|(axis, (a, b))| {
                (a - b).abs() / (2.0 * LONGEST + 1.0 / axis.count as f64) / axis.length().abs()
            });
            apart.all(|apart| apart <= 1.0)
        };
        let chords = curve.points.windows(2).zip(&curve.places);
        let mut chords = chords.filter(|(_, place)| near(place));
        chords.any(|(pair, _)| {
            let chord = &pair[1].z - &pair[0].z;
            let part = chord.dot(&(z - &pair[0].z)) / chord.norm_squared();
            let beside = &pair[0].z + &chord * part.clamp(0.0, 1.0);
            (z - &beside).norm() <= reach
        })
    }

    /// The curve through a point, from end to end.
    fn both_ways(&self, start: &OnCurve) -> Curve {
        let plane = self.plane;
        let longest = |at: &OnCurve| {
            let steps = plane.axes.iter().map(|axis| {
                let (_, gradient) = plane.equations.term(axis.term, &at.z);
                LONGEST * axis.length().abs() / gradient.dot(&at.tangent).abs()
            });
            steps.fold(0.1 * (1.0 + at.z.norm()), f64::min)
        };
        let limit = |a: &OnCurve, b: &OnCurve| {
            let there = plane.coordinates(&b.z);
            let axis = (0..2).find(|&k| plane.axes[k].margin(there[k]) < 0.0)?;
            let outside =
                |z: &DVector<f64>| Some(plane.axes[axis].margin(plane.coordinates(z)[axis]));
            let root = a.root(self, b, outside);
            let end = root.and_then(|z| OnCurve::new(self, z, &a.tangent));
            Some((end, End::Range))
        };
        let (points, ends) = both_ways(start, |start| {
            follow(self, start, MOST_POINTS, longest, limit)
        });
        Curve {
            places: points.iter().map(|at| plane.coordinates(&at.z)).collect(),
            points,
            ends,
        }
    }
}

/// Neighbouring motions on one branch where a function has different signs.
fn pairs(
    plane: &Plane<'_>,
    chart: &Chart,
    sign: impl Fn(&Cell) -> f64,
) -> impl Iterator<Item = [DVector<f64>; 2]> {
    let count = chart.axes[0].count;
    let signs: Vec<Vec<f64>> = (chart.cells.iter())
        .map(|cells| cells.iter().map(&sign).collect())
        .collect();
    (0..chart.cells.len()).flat_map(move |place| {
        let right = (place + 1) % count > 0;
        let beside = [right.then_some(place + 1), Some(place + count)];
        let beside = beside.into_iter().flatten();
        let mut found = Vec::new();
        for other in beside.filter(|&other| other < chart.cells.len()) {
            // Most grid points have one motion, and most neighbours the same sign.
            let [here, there] = [place, other].map(|place| signs[place].iter());
            let any =
                |wanted: fn(f64) -> bool| here.clone().chain(there.clone()).any(|s| wanted(*s));
            if !(any(|s| s > 0.0) && any(|s| s < 0.0)) {
                continue;
            }
            let [here, there] = [place, other].map(|place| {
                let cells = chart.cells[place].iter();
                cells.map(|cell| unknowns(plane, cell)).collect::<Vec<_>>()
            });
            for (a, sign) in here.iter().zip(&signs[place]) {
                let b = nearest(&there, a).filter(|b| nearest(&here, b) == Some(a));
                let Some(b) = b else { continue };
                let back = there.iter().position(|z| z == b).unwrap_or(0);
                if sign * signs[other][back] < 0.0 {
                    found.push([a.clone(), b.clone()]);
                }
            }
        }
        found
    })
}

/// The unknowns of a cell in units of their scales.
pub(crate) fn unknowns(plane: &Plane<'_>, cell: &Cell) -> DVector<f64> {
    let values = cell.unknowns.iter().zip(&plane.equations.scales);
    let values = values.map(|(value, scale)| value / scale);
    DVector::from_iterator(cell.unknowns.len(), values)
}
