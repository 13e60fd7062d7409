//! Stability boundaries as curves over two quantities.

use nalgebra::{DMatrix, DVector};

use super::level::{Curve, Level, unknowns};
use super::plane::Plane;
use super::{Boundary, BoundaryFold, Cell, Chart, ChartError, Edge};
use crate::branch::Requirement;
use crate::branch::continuation::OnCurve;
use crate::stability::critical::{Change, Criteria};
use appell_spectra::spectrum::{characteristic_polynomial, eigenvalues};

/// Real parts above this fraction of a typical eigenvalue are growth, where repeated eigenvalues
/// are known only to the square root of rounding.
const GROWS: f64 = 1e-3;

/// All boundaries that pass between grid points of a chart.
pub(crate) fn boundaries(
    plane: &Plane<'_>,
    chart: &Chart,
    zeros: usize,
) -> Result<Vec<Boundary>, ChartError> {
    let criteria = criteria(plane, chart, zeros)?;
    let of = |which: usize| {
        let critical = Critical {
            plane,
            criteria,
            which,
        };
        critical.boundaries(chart)
    };
    let (mut found, pairs) = rayon::join(|| of(0), || of(1));
    found.extend(pairs);
    Ok(found)
}

/// Where requirements begin or cease to hold.
pub(crate) fn edges(plane: &Plane<'_>, chart: &Chart, requirements: &[Requirement]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (requirement, wanted) in requirements.iter().enumerate() {
        let margin = |z: &DVector<f64>| {
            let point = plane.equations.point(z);
            wanted.term.value(plane.equations.model, &point) - wanted.at_least
        };
        let level = Level {
            plane,
            function: &margin,
        };
        let curves = level.curves(chart, |cell| margin(&unknowns(plane, cell)).signum());
        edges.extend(curves.iter().map(|curve| Edge {
            requirement,
            points: places(plane, curve),
        }));
    }
    edges
}

fn places(plane: &Plane<'_>, curve: &Curve) -> Vec<[f64; 2]> {
    curve
        .points
        .iter()
        .map(|at| plane.coordinates(&at.z))
        .collect()
}

/// Criteria for the motions of a chart, from a few of its cells.
fn criteria(plane: &Plane<'_>, chart: &Chart, zeros: usize) -> Result<Criteria, ChartError> {
    /// Number of cells examined.
    const SAMPLES: usize = 40;
    let cells: Vec<&Cell> = chart.cells.iter().flatten().collect();
    let each = (cells.len() / SAMPLES).max(1);
    let mut polynomials = Vec::new();
    for cell in cells.iter().step_by(each) {
        let point = plane.equations.point(&unknowns(plane, cell));
        let (_, matrix) = plane.problem.essential_matrix(&point)?;
        polynomials.push(characteristic_polynomial(&matrix)?);
    }
    Ok(Criteria::of(&polynomials, zeros))
}

/// One of the functions whose zeros are critical.
struct Critical<'a> {
    plane: &'a Plane<'a>,
    criteria: Criteria,
    which: usize,
}

impl Critical<'_> {
    fn boundaries(&self, chart: &Chart) -> Vec<Boundary> {
        let value = |z: &DVector<f64>| {
            let matrix = self.matrix(z);
            let polynomial = matrix.and_then(|a| characteristic_polynomial(&a).ok());
            polynomial.map_or(f64::NAN, |p| self.criteria.values(&p)[self.which])
        };
        let level = Level {
            plane: self.plane,
            function: &value,
        };
        let sign = |cell: &Cell| self.criteria.signs(&cell.eigenvalues)[self.which];
        let curves = level.curves(chart, sign);
        curves
            .iter()
            .filter_map(|curve| self.describe(&level, curve))
            .collect()
    }

    /// The boundary of a curve; `None` where eigenvalues are only symmetric about zero.
    fn describe(&self, level: &Level<'_>, curve: &Curve) -> Option<Boundary> {
        let changes: Vec<(Option<Change>, bool)> =
            curve.points.iter().map(|at| self.at(&at.z)).collect();
        let middle = changes.len() / 2;
        let (first, last) = changes.split_at(middle);
        let mut outwards = last.iter().chain(first.iter().rev());
        let change = outwards.find_map(|(change, _)| *change)?;
        Some(Boundary {
            change,
            points: places(self.plane, curve),
            decides: changes.into_iter().map(|(_, decides)| decides).collect(),
            folds: self.folds(level, curve),
            ends: curve.ends,
        })
    }

    fn matrix(&self, z: &DVector<f64>) -> Option<DMatrix<f64>> {
        let point = self.plane.equations.point(z);
        let matrix = self.plane.problem.essential_matrix(&point).ok();
        matrix.map(|(_, matrix)| matrix)
    }

    /// The change of the eigenvalues at a motion, and whether it changes stability.
    fn at(&self, z: &DVector<f64>) -> (Option<Change>, bool) {
        let values = self.matrix(z).and_then(|a| eigenvalues(&a).ok());
        let values = values.unwrap_or_default();
        let change = self.criteria.change(self.which, &values);
        let grows = GROWS * self.criteria.unit;
        let rests = values.iter().all(|value| value.re <= grows);
        (change, change.is_some() && rests)
    }

    fn folds(&self, level: &Level<'_>, curve: &Curve) -> Vec<BoundaryFold> {
        let equations = &self.plane.equations;
        let mut folds = Vec::new();
        for pair in curve.points.windows(2) {
            for (axis, quantity) in self.plane.axes.iter().enumerate() {
                let slope = |z: &DVector<f64>| {
                    let at = OnCurve::new(level, z.clone(), &(&pair[1].z - &pair[0].z))?;
                    Some(equations.term(quantity.term, z).1.dot(&at.tangent))
                };
                let signs = pair
                    .iter()
                    .map(|at| equations.term(quantity.term, &at.z).1.dot(&at.tangent));
                if signs.product::<f64>() < 0.0
                    && let Some(z) = pair[0].root(level, &pair[1], slope)
                {
                    folds.push(BoundaryFold {
                        axis,
                        at: self.plane.coordinates(&z),
                        point: equations.point(&z),
                        decides: self.at(&z).1,
                    });
                }
            }
        }
        folds
    }
}
