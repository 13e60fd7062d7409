//! The special points of a branch: folds, crossings, changes of stability and of feasibility.

use nalgebra::DVector;

use super::continuation::{End, OnCurve};
use super::crossing::Crossing;
use super::{Branch, BranchError, BranchPoint, Branches, Kind, Requirement, Special};
use crate::stability::critical::{Change, Criteria};
use crate::stability::{Stability, StabilityError};
use crate::steady::equations::SteadyEquations;
use appell_runtime::contact::{ContactForce, ContactForces};
use appell_spectra::spectrum::{Complex, characteristic_polynomial};

/// A slope along a branch that is rounding, relative to the gradient.
const CONSTANT: f64 = 1e-9;

impl Branches<'_> {
    /// The branch of a curve: its points and the special points between them.
    pub(super) fn describe(
        &self,
        equations: &SteadyEquations<'_>,
        curve: &[OnCurve],
        ends: [End; 2],
    ) -> Result<Branch, BranchError> {
        let motions = curve.iter().map(|at| self.motion(equations, &at.z));
        let points: Vec<BranchPoint> = motions.collect::<Result<_, _>>()?;
        let polynomials: Vec<Vec<f64>> = points
            .iter()
            .map(|p| characteristic_polynomial(&p.stability.matrix))
            .collect::<Result<_, _>>()
            .map_err(StabilityError::from)?;
        let zeros = points.iter().map(|point| point.stability.zeros);
        let criteria = Criteria::of(&polynomials, zeros.min().unwrap_or(0));
        let mut specials = Vec::new();
        for (after, pair) in curve.windows(2).enumerate() {
            let [a, b] = pair else { continue };
            let found = self.specials(equations, [a, b], criteria);
            for (kind, z, across) in found {
                let motion = self.motion(equations, &z)?;
                let change = match kind {
                    Kind::Critical(change) => {
                        let which = usize::from(change != Change::RealZero);
                        let values: Vec<Complex<f64>> =
                            motion.stability.spectrum.values().collect();
                        criteria.change(which, &values).map(Kind::Critical)
                    }
                    other => Some(other),
                };
                if let Some(kind) = change {
                    specials.push(Special {
                        kind,
                        after,
                        motion,
                        across,
                    });
                }
            }
        }
        Ok(Branch {
            points,
            specials,
            ends,
            curve: curve.iter().map(|at| at.z.clone()).collect(),
        })
    }

    /// The special points between two points, with their unknowns.
    fn specials(
        &self,
        equations: &SteadyEquations<'_>,
        [a, b]: [&OnCurve; 2],
        criteria: Criteria,
    ) -> Vec<(Kind, DVector<f64>, Option<DVector<f64>>)> {
        let mut found = Vec::new();
        let model = self.problem.model();
        let mut seek = |kind: Kind, function: &dyn Fn(&DVector<f64>) -> Option<f64>| {
            let signs = [function(&a.z), function(&b.z)];
            // A zero at the first point belongs to the pair before.
            if let [Some(first), Some(last)] = signs
                && first != 0.0
                && first * last <= 0.0
                && let Some(z) = a.root(equations, b, function)
            {
                found.push((kind, z, None));
            }
        };
        // Along a family on which the quantity is constant, rounding alone turns it back.
        let is_constant = [a, b].iter().all(|at| {
            let gradient = equations.term(self.along, &at.z).1;
            gradient.dot(&at.tangent).abs() <= CONSTANT * gradient.norm()
        });
        if !is_constant {
            seek(Kind::Fold, &|z| {
                let at = OnCurve::new(equations, z.clone(), &(&b.z - &a.z))?;
                Some(equations.term(self.along, z).1.dot(&at.tangent))
            });
        }
        let critical = |z: &DVector<f64>, which: usize| {
            let (_, matrix) = self.problem.essential_matrix(&equations.point(z)).ok()?;
            let polynomial = characteristic_polynomial(&matrix).ok()?;
            Some(criteria.values(&polynomial)[which])
        };
        let oscillation = Change::Oscillation { frequency: 0.0 };
        seek(Kind::Critical(Change::RealZero), &|z| critical(z, 0));
        seek(Kind::Critical(oscillation), &|z| critical(z, 1));
        for (number, requirement) in self.requirements.iter().enumerate() {
            seek(Kind::Feasibility(number), &|z| {
                let value = requirement.term.value(model, &equations.point(z));
                Some(value - requirement.at_least)
            });
        }
        let contacts = model.info().contacts.len();
        for contact in 0..contacts {
            seek(Kind::Feasibility(self.requirements.len()), &|z| {
                let point = equations.point(z);
                let mut forces = ContactForces::new();
                Some(forces.at(model, point.at()).get(contact)?.normal)
            });
        }
        if a.passes_crossing(equations, b)
            && let Some(crossing) = Crossing::near(equations, &a.z)
        {
            let chord = (&b.z - &a.z).norm();
            let near = |z: &DVector<f64>| (z - &a.z).norm().max((z - &b.z).norm()) <= 2.0 * chord;
            if near(&crossing.z) {
                let along = |t: &DVector<f64>| t.dot(&a.tangent).abs();
                let [first, second] = crossing.tangents;
                let across = if along(&first) < along(&second) {
                    first
                } else {
                    second
                };
                found.push((Kind::Crossing, crossing.z, Some(across)));
            }
        }
        found.sort_by(|x, y| (&x.1 - &a.z).norm().total_cmp(&(&y.1 - &a.z).norm()));
        found
    }

    fn motion(
        &self,
        equations: &SteadyEquations<'_>,
        z: &DVector<f64>,
    ) -> Result<BranchPoint, BranchError> {
        let model = self.problem.model();
        let point = equations.point(z);
        let contacts = ContactForces::new().at(model, point.at()).to_vec();
        let holds = |r: &Requirement| r.term.value(model, &point) >= r.at_least;
        let pushes = |force: &ContactForce| force.normal >= 0.0;
        Ok(BranchPoint {
            value: self.along.value(model, &point),
            outputs: point.outputs(model),
            feasible: self.requirements.iter().all(holds) && contacts.iter().all(pushes),
            stability: Stability::of(model, self.problem.structure(), &point)?,
            contacts,
            point,
        })
    }
}
