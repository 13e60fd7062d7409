//! Branches: steady motions along one quantity, with their special points.

pub(crate) mod continuation;
pub(crate) mod crossing;

use nalgebra::DVector;

use crate::point::Point;
use crate::stability::critical::{Change, Criteria};
use crate::stability::{Stability, StabilityError, Verdict, essential_matrix};
use crate::steady::equations::SteadyEquations;
use crate::steady::newton;
use crate::steady::{SteadyError, SteadyProblem};
use crate::term::Term;
use appell_runtime::contact::{ContactForce, ContactForces};
use appell_spectra::spectrum::{Complex, characteristic_polynomial};
use continuation::{End, OnCurve, correct, follow};
use crossing::Crossing;

/// An output that must stay on one side of a value for a motion to be feasible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// The output.
    pub term: Term,
    /// Least value in SI.
    pub at_least: f64,
}

/// Options of the continuation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchOptions {
    /// Largest number of points of one branch.
    pub most_points: usize,
    /// Longest step, as a part of the range of the quantity and of the size of the unknowns.
    pub longest_step: f64,
    /// Whether a branch ends where a requirement is violated; else the points are marked.
    pub stop_infeasible: bool,
    /// Whether crossing branches are followed as well.
    pub follow_crossings: bool,
}

impl Default for BranchOptions {
    fn default() -> Self {
        Self {
            most_points: 4000,
            longest_step: 0.02,
            stop_infeasible: false,
            follow_crossings: true,
        }
    }
}

/// A steady motion on a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchPoint {
    /// State, inputs and parameters.
    pub point: Point,
    /// Value of the quantity along which the branch runs, in SI.
    pub value: f64,
    /// Outputs in SI.
    pub outputs: Vec<f64>,
    /// Forces at the contacts.
    pub contacts: Vec<ContactForce>,
    /// Eigenvalues, verdict.
    pub stability: Stability,
    /// Whether the requirements hold and every normal force is compressive.
    pub feasible: bool,
}

/// Kind of a special point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The quantity turns back (fold).
    Fold,
    /// Another branch crosses (branch point).
    Crossing,
    /// Stability may change, by the eigenvalues.
    Critical(Change),
    /// A requirement begins or ceases to hold: its number; after the last, a contact lifts.
    Feasibility(usize),
}

/// A point between two points of a branch that is known to rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Special {
    /// Its kind.
    pub kind: Kind,
    /// Index of the point before it.
    pub after: usize,
    /// The motion.
    pub motion: BranchPoint,
    /// Direction of the branch that crosses, in the unknowns.
    across: Option<DVector<f64>>,
}

/// Steady motions along one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The points, in order.
    pub points: Vec<BranchPoint>,
    /// The special points between them, in order.
    pub specials: Vec<Special>,
    /// The causes of its two ends.
    pub ends: [End; 2],
    curve: Vec<DVector<f64>>,
}

/// Why branches could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BranchError {
    /// No steady motions, or not a one-dimensional family.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// The conditions leave no family of motions.
    #[error("the steady motions are isolated; release a condition to continue them along {along}")]
    Isolated {
        /// The quantity.
        along: String,
    },
    /// The stability of a motion could not be determined.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// An invalid range.
    #[error("`{along}` cannot run from {from} to {to}: write two different numbers")]
    Range {
        /// The quantity.
        along: String,
        /// Its beginning.
        from: f64,
        /// Its end.
        to: f64,
    },
}

/// Largest number of branches.
const MOST_BRANCHES: usize = 40;
/// Values of the quantity at which branches are looked for.
const SECTIONS: usize = 5;
/// Points closer than this, relative to their size, are the same.
const SAME: f64 = 1e-6;

/// Branches of steady motions along a quantity.
pub struct Branches<'a> {
    problem: SteadyProblem<'a>,
    along: Term,
    range: [f64; 2],
    requirements: Vec<Requirement>,
    options: BranchOptions,
}

impl<'a> Branches<'a> {
    /// Of a problem whose conditions leave one dimension, once that on `along` is removed.
    pub fn new(
        problem: &SteadyProblem<'a>,
        along: Term,
        range: [f64; 2],
        requirements: &[Requirement],
        options: BranchOptions,
    ) -> Result<Self, BranchError> {
        let mut problem = problem.clone();
        problem.release(along)?;
        for requirement in requirements {
            problem.check(requirement.term)?;
        }
        let [from, to] = range;
        let length = to - from;
        if !length.is_finite() || length == 0.0 {
            let along = along.name(problem.model().info());
            return Err(BranchError::Range { along, from, to });
        }
        Ok(Self {
            problem,
            along,
            range,
            requirements: requirements.to_vec(),
            options,
        })
    }

    /// The problem without a condition on the quantity.
    pub fn problem(&self) -> &SteadyProblem<'a> {
        &self.problem
    }

    /// The quantity along which branches run.
    pub fn along(&self) -> Term {
        self.along
    }

    /// All branches found: through the steady motions at several values of the quantity, each
    /// sought from several starting points, and through crossings.
    pub fn trace(&self, starts: usize) -> Result<Vec<Branch>, BranchError> {
        let equations = self.equations();
        let mut branches: Vec<Branch> = Vec::new();
        let mut reason = None;
        for section in 0..SECTIONS {
            // Not at the ends, where rounding decides whether a motion exists.
            let part = (section as f64 + 0.5) / SECTIONS as f64;
            let value = self.range[0] + part * (self.range[1] - self.range[0]);
            let mut here = self.problem.clone();
            here.fix(self.along, value)?;
            match here.solve_all(starts) {
                Ok(motions) => {
                    for motion in motions {
                        let z = equations.unknowns_of(&motion.point);
                        if !branches.iter().any(|branch| branch.holds(&equations, &z)) {
                            branches.push(self.through(&equations, &z, None)?);
                        }
                    }
                }
                Err(error) => reason = Some(error),
            }
        }
        if let (true, Some(reason)) = (branches.is_empty(), reason) {
            return Err(reason.into());
        }
        let mut next = 0;
        while self.options.follow_crossings && next < branches.len() {
            for special in branches[next].specials.clone() {
                if branches.len() >= MOST_BRANCHES {
                    return Ok(branches);
                }
                let crossing = self.switch(&special)?;
                let known = |branch: &Branch| {
                    let middle = branch.curve.len() / 2;
                    branches
                        .iter()
                        .any(|b| b.holds(&equations, &branch.curve[middle]))
                };
                branches.extend(crossing.filter(|branch| branch.curve.len() > 2 && !known(branch)));
            }
            next += 1;
        }
        Ok(branches)
    }

    /// The branch that crosses at a special point, if any.
    pub fn switch(&self, special: &Special) -> Result<Option<Branch>, BranchError> {
        let Some(across) = &special.across else {
            return Ok(None);
        };
        let equations = self.equations();
        let z = equations.unknowns_of(&special.motion.point);
        self.through(&equations, &z, Some(across)).map(Some)
    }

    fn equations(&self) -> SteadyEquations<'_> {
        let mut equations = self.problem.equations();
        let reach = 0.5 * (self.range[1] - self.range[0]).abs();
        for (term, scale) in equations.unknowns.iter().zip(&mut equations.scales) {
            if *term == self.along {
                *scale = reach;
            }
        }
        equations
    }

    /// Follows the curve through a point both ways, along `direction` if the point is a crossing.
    fn through(
        &self,
        equations: &SteadyEquations<'_>,
        z: &DVector<f64>,
        direction: Option<&DVector<f64>>,
    ) -> Result<Branch, BranchError> {
        let start = match direction {
            Some(direction) => {
                // Beside the crossing, where the curve is isolated.
                let step = self.options.longest_step * 0.1 * (1.0 + z.norm());
                let beside = correct(equations, &(z + direction * step), direction);
                beside.and_then(|(z, _)| OnCurve::new(equations, z, direction))
            }
            None => self.begin(equations, z)?,
        };
        let Some(start) = start else {
            return Ok(Branch {
                points: Vec::new(),
                specials: Vec::new(),
                ends: [End::Lost; 2],
                curve: Vec::new(),
            });
        };
        let mut back = start.clone();
        back.tangent.neg_mut();
        let (forward, end) = self.follow(equations, &start);
        let (mut curve, first) = if end == End::Closed {
            (vec![start], End::Closed)
        } else {
            let (mut backward, first) = self.follow(equations, &back);
            backward.reverse();
            for point in &mut backward {
                point.tangent.neg_mut();
            }
            backward.push(start);
            (backward, first)
        };
        curve.extend(forward);
        // From small values of the quantity to large ones, if it says so.
        let value = |at: &OnCurve| equations.term(self.along, &at.z).0;
        let mut ends = [first, end];
        if let [a, .., b] = curve.as_slice()
            && value(a) > value(b)
        {
            curve.reverse();
            ends.reverse();
            for point in &mut curve {
                point.tangent.neg_mut();
            }
        }
        self.describe(equations, &curve, ends)
    }

    /// A point of the curve; an error where the motions are not a one-dimensional family.
    fn begin(
        &self,
        equations: &SteadyEquations<'_>,
        z: &DVector<f64>,
    ) -> Result<Option<OnCurve>, BranchError> {
        let Ok(zero) = newton::solve(equations, z) else {
            let motion = self.problem.solve_from(&equations.point(z));
            return Err(motion.map_or_else(BranchError::from, |_| self.isolated()));
        };
        match zero.family() {
            0 => Err(self.isolated()),
            1 => {
                let like = zero.kernel().column(0).into_owned();
                Ok(OnCurve::new(equations, zero.z, &like))
            }
            dimension => {
                // One dimension is that of the quantity.
                let motion = self.problem.solve_from(&equations.point(&zero.z))?;
                let info = self.problem.model().info();
                let open = self.problem.open(&motion);
                let open = open.iter().filter(|&&term| term != self.along);
                let open = open.map(|term| term.name(info)).collect();
                let dimension = dimension - 1;
                Err(SteadyError::Family { dimension, open }.into())
            }
        }
    }

    fn isolated(&self) -> BranchError {
        let along = self.along.name(self.problem.model().info());
        BranchError::Isolated { along }
    }

    /// Points after `start` along its tangent, up to where the curve ends.
    fn follow(&self, equations: &SteadyEquations<'_>, start: &OnCurve) -> (Vec<OnCurve>, End) {
        let longest = |at: &OnCurve| self.longest(equations, at);
        let limit = |a: &OnCurve, b: &OnCurve| self.first_limit(equations, a, b);
        follow(equations, start, self.options.most_points, longest, limit)
    }

    /// The longest step: a part of the quantity's range, and of the size of the unknowns.
    fn longest(&self, equations: &SteadyEquations<'_>, at: &OnCurve) -> f64 {
        let part = self.options.longest_step;
        let (_, gradient) = equations.term(self.along, &at.z);
        let slope = gradient.dot(&at.tangent).abs();
        let range = (self.range[1] - self.range[0]).abs();
        (part * range / slope).min(part * 5.0 * (1.0 + at.z.norm()))
    }

    /// The first end of the curve between two of its points.
    fn first_limit(
        &self,
        equations: &SteadyEquations<'_>,
        a: &OnCurve,
        b: &OnCurve,
    ) -> Option<(Option<OnCurve>, End)> {
        let info = self.problem.model().info();
        let [low, high] = [
            self.range[0].min(self.range[1]),
            self.range[0].max(self.range[1]),
        ];
        let mut limits: Vec<(Term, f64, f64, End)> = vec![
            (self.along, 1.0, low, End::Range),
            (self.along, -1.0, -high, End::Range),
        ];
        for &state in &self.problem.structure().essential {
            let [low, high] = info.states[state].range;
            limits.push((Term::State(state), 1.0, low, End::State(state)));
            limits.push((Term::State(state), -1.0, -high, End::State(state)));
        }
        if self.options.stop_infeasible {
            for (number, requirement) in self.requirements.iter().enumerate() {
                let end = End::Infeasible(number);
                limits.push((requirement.term, 1.0, requirement.at_least, end));
            }
        }
        let margin = |z: &DVector<f64>, (term, sign, least, _): (Term, f64, f64, End)| {
            let point = equations.point(z);
            sign * term.value(equations.model, &point) - least
        };
        let passed = |limit: &&(Term, f64, f64, End)| {
            let here = margin(&a.z, **limit);
            margin(&b.z, **limit) < 0.0 && here >= -1e-12 * (1.0 + limit.2.abs())
        };
        let passed: Vec<_> = limits.iter().filter(passed).collect();
        let ends = passed.iter().map(|limit| {
            let z = a.root(equations, b, |z| Some(margin(z, **limit)));
            (
                z.and_then(|z| OnCurve::new(equations, z, &a.tangent)),
                limit.3,
            )
        });
        // The nearest, if more than one is passed at once.
        let away = |end: &(Option<OnCurve>, End)| {
            end.0.as_ref().map_or(0.0, |point| (&point.z - &a.z).norm())
        };
        let mut ends: Vec<_> = ends.collect();
        ends.sort_by(|x, y| away(x).total_cmp(&away(y)));
        ends.into_iter().next()
    }

    /// The branch of a curve: its points and the special points between them.
    fn describe(
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
        seek(Kind::Fold, &|z| {
            let at = OnCurve::new(equations, z.clone(), &(&b.z - &a.z))?;
            Some(equations.term(self.along, z).1.dot(&at.tangent))
        });
        let critical = |z: &DVector<f64>, which: usize| {
            let point = equations.point(z);
            let (_, matrix) = essential_matrix(model, self.problem.structure(), &point).ok()?;
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

impl Branch {
    /// Whether a point lies on the branch.
    fn holds(&self, equations: &SteadyEquations<'_>, z: &DVector<f64>) -> bool {
        let near = |ends: &[DVector<f64>]| {
            let chord = &ends[1] - &ends[0];
            let part = chord.dot(&(z - &ends[0])) / chord.norm_squared();
            let beside = &ends[0] + &chord * part.clamp(0.0, 1.0);
            if !((-0.01..=1.01).contains(&part) && (z - &beside).norm() <= chord.norm()) {
                return false;
            }
            let there = correct(equations, &beside, &chord.normalize());
            there.is_some_and(|(there, _)| (there - z).norm() <= SAME * (1.0 + z.norm()))
        };
        self.curve.windows(2).any(near)
    }

    /// Special points at which the verdict changes.
    pub fn changes(&self) -> impl Iterator<Item = &Special> {
        self.specials.iter().filter(|special| {
            let verdict = |place: usize| self.points.get(place).map(|p| p.stability.verdict);
            let unstable = |place: usize| verdict(place) == Some(Verdict::Unstable);
            matches!(special.kind, Kind::Critical(_))
                && unstable(special.after) != unstable(special.after + 1)
        })
    }
}
