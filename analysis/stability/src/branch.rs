//! Branches: steady motions along one quantity, with their special points.

pub(crate) mod continuation;
pub(crate) mod crossing;
mod specials;

use appell_runtime::contact::ContactForce;
use nalgebra::DVector;

use crate::point::Point;
use crate::stability::critical::Change;
use crate::stability::{Stability, StabilityError, Verdict};
use crate::steady::equations::SteadyEquations;
use crate::steady::{SteadyError, SteadyProblem, newton};
use crate::term::Term;
use continuation::{End, OnCurve, both_ways, correct, follow, turned};

/// Largest number of branches.
const MOST_BRANCHES: usize = 40;
/// Values of the quantity at which branches are looked for.
const SECTIONS: usize = 5;
/// A point no farther than this from a branch, relative to its size, lies on it: corrections end
/// within 1e-9 of the curve.
const SAME_BRANCH: f64 = 1e-6;

/// A value that a quantity must not pass on a branch.
#[derive(Clone, Copy)]
struct Limit {
    term: Term,
    /// 1 for a lower limit, −1 for an upper one.
    sign: f64,
    /// The least value of `sign` times the quantity, in SI.
    least: f64,
    /// Why the branch ends there.
    end: End,
}

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
                // Start off the branch point, where the curve is isolated.
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
        let longest = |at: &OnCurve| self.longest(equations, at);
        let limit = |a: &OnCurve, b: &OnCurve| self.first_limit(equations, a, b);
        let most = self.options.most_points;
        let (mut curve, mut ends) = both_ways(&start, |start| {
            follow(equations, start, most, longest, limit)
        });
        // In the order of increasing values of the quantity, if they differ.
        let value = |at: &OnCurve| equations.term(self.along, &at.z).0;
        if let [a, .., b] = curve.as_slice()
            && value(a) > value(b)
        {
            curve = turned(curve);
            ends.reverse();
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
                let terms = self.problem.open(&motion);
                let others = terms.iter().filter(|&&term| term != self.along);
                let open = others.map(|term| term.name(info)).collect();
                let dimension = dimension - 1;
                Err(SteadyError::Family { dimension, open }.into())
            }
        }
    }

    fn isolated(&self) -> BranchError {
        BranchError::Isolated(self.along.name(self.problem.model().info()))
    }

    /// The longest step: a part of the quantity's range, and of the size of the unknowns.
    fn longest(&self, equations: &SteadyEquations<'_>, at: &OnCurve) -> f64 {
        let part = self.options.longest_step;
        let (_, gradient) = equations.term(self.along, &at.z);
        let slope = gradient.dot(&at.tangent).abs();
        let range = (self.range[1] - self.range[0]).abs();
        (part * range / slope).min(part * 5.0 * (1.0 + at.z.norm()))
    }

    /// Limits of a branch: the ends of the range of its quantity and of the declared ranges of essential
    /// states and, depending on the options, violation of a requirement.
    fn limits(&self) -> Vec<Limit> {
        let within = |term: Term, [low, high]: [f64; 2], end: End| {
            [(1.0, low), (-1.0, -high)].map(|(sign, least)| Limit {
                term,
                sign,
                least,
                end,
            })
        };
        let [from, to] = self.range;
        let range = [from.min(to), from.max(to)];
        let states = &self.problem.model().info().states;
        let mut limits = within(self.along, range, End::Range).to_vec();
        for &state in &self.problem.structure().essential {
            let term = Term::State(state);
            limits.extend(within(term, states[state].range, End::State(state)));
        }
        if self.options.stop_infeasible {
            for (number, requirement) in self.requirements.iter().enumerate() {
                limits.push(Limit {
                    term: requirement.term,
                    sign: 1.0,
                    least: requirement.at_least,
                    end: End::Infeasible(number),
                });
            }
        }
        limits
    }

    /// The first end of the curve between two of its points.
    fn first_limit(
        &self,
        equations: &SteadyEquations<'_>,
        a: &OnCurve,
        b: &OnCurve,
    ) -> Option<(Option<OnCurve>, End)> {
        let margin = |z: &DVector<f64>, limit: &Limit| {
            let point = equations.point(z);
            limit.sign * limit.term.value(equations.model, &point) - limit.least
        };
        let passed = |limit: &Limit| {
            let here = margin(&a.z, limit);
            margin(&b.z, limit) < 0.0 && here >= -1e-12 * (1.0 + limit.least.abs())
        };
        let end = |limit: Limit| {
            let z = a.root(equations, b, |z| Some(margin(z, &limit)));
            (
                z.and_then(|z| OnCurve::new(equations, z, &a.tangent)),
                limit.end,
            )
        };
        // The nearest, if more than one is passed at once.
        let distance = |(point, _): &(Option<OnCurve>, End)| {
            point.as_ref().map_or(0.0, |point| (&point.z - &a.z).norm())
        };
        let limits = self.limits().into_iter();
        let mut ends: Vec<_> = limits.filter(passed).map(end).collect();
        ends.sort_by(|x, y| distance(x).total_cmp(&distance(y)));
        ends.into_iter().next()
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
            there.is_some_and(|(there, _)| (there - z).norm() <= SAME_BRANCH * (1.0 + z.norm()))
        };
        self.curve.windows(2).any(near)
    }
}

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

impl Branch {
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

/// Why branches could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BranchError {
    /// No steady motions, or not a one-dimensional family.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// The conditions leave no family of motions.
    #[error("the steady motions are isolated; release a condition to continue them along {0}")]
    Isolated(String),
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
