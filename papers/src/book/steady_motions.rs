//! Steady motions of shipped mechanisms, by names and in SI.

use appell_analysis::{
    Axis, Branch, BranchError, BranchOptions, BranchPoint, Branches, Cell, Change, Chart, Kind,
    Point, Requirement, SteadyError, SteadyProblem, Term,
};
use appell_report::figure::{Curve, Stroke};
use appell_runtime::model::Model;

use crate::book::{Result, computation, failed, line, shipped};
use appell::Error;
use appell::steady::Resolved;
use appell::steady::regions::Shown;

/// Starting points from which motions are sought.
const STARTS: usize = 20;
/// The same for isolated motions.
const ISOLATED_STARTS: usize = 60;
/// The same for the seeds of a chart, whose regions are disconnected.
const CHART_STARTS: usize = 100;

/// The numbers of the paper: masses of wheel and slider, radius, gravitational acceleration.
pub(crate) const WHEEL_MASS: f64 = 10.0;
/// Mass of the slider in kg.
pub(crate) const SLIDER_MASS: f64 = 5.0;
/// Radius in m.
pub(crate) const RADIUS: f64 = 0.3;
/// In m/s².
pub(crate) const GRAVITY: f64 = 9.81;

/// A mechanism with quantities by name.
#[derive(Clone, Copy)]
pub(crate) struct Mechanism(pub(crate) &'static dyn Model);

impl Mechanism {
    pub(crate) fn shipped(name: &str) -> Result<Self> {
        Ok(Self(shipped(name)?.model))
    }

    pub(crate) fn term(self, name: &str) -> Result<Term> {
        Term::named(self.0.info(), name).ok_or_else(|| failed(&format!("no quantity `{name}`")))
    }

    /// Quantities at a point, in SI.
    pub(crate) fn values<const N: usize>(
        self,
        names: [&str; N],
        point: &Point,
    ) -> Result<[f64; N]> {
        let mut values = [f64::NAN; N];
        for (value, name) in values.iter_mut().zip(names) {
            *value = self.term(name)?.value(self.0, point);
        }
        Ok(values)
    }

    /// Quantities of the motion of a cell of a chart, in SI.
    pub(crate) fn cell_values<const N: usize>(
        self,
        names: [&str; N],
        chart: &Chart,
        cell: &Cell,
    ) -> Result<[f64; N]> {
        let mut point = Point::initial(self.0);
        for (term, value) in chart.unknowns.iter().zip(&cell.unknowns) {
            if let Term::State(state) = term {
                point.x[*state] = *value;
            }
        }
        self.values(names, &point)
    }

    /// Steady motions with quantities as given.
    pub(crate) fn problem(self, given: &[(&str, f64)]) -> Result<SteadyProblem<'static>> {
        let mut problem =
            SteadyProblem::new(self.0, Point::initial(self.0)).map_err(computation)?;
        for (name, value) in given {
            problem.fix(self.term(name)?, *value).map_err(computation)?;
        }
        Ok(problem)
    }

    /// Isolated steady motions.
    pub(crate) fn isolated(self, given: &[(&str, f64)]) -> Result<Vec<Point>> {
        let motions = self.problem(given)?.solve_isolated(ISOLATED_STARTS);
        let motions = motions.map_err(computation)?;
        Ok(motions.into_iter().map(|motion| motion.point).collect())
    }

    /// Whether a search finds no steady motion.
    pub(crate) fn has_none(self, given: &[(&str, f64)], starts: usize) -> Result<bool> {
        match self.problem(given)?.solve_all(starts) {
            Ok(_) => Ok(false),
            Err(SteadyError::None { .. } | SteadyError::OutOfRange { .. }) => Ok(true),
            Err(error) => Err(computation(error)),
        }
    }

    /// Branches of steady motions along a quantity; none without motions.
    pub(crate) fn branches(
        self,
        given: &[(&str, f64)],
        along: &str,
        range: [f64; 2],
    ) -> Result<Vec<Branch>> {
        let problem = self.problem(given)?;
        let options = BranchOptions::default();
        let traced = Branches::new(&problem, self.term(along)?, range, &[], options)
            .and_then(|branches| branches.trace(STARTS));
        match traced {
            Err(BranchError::Steady(SteadyError::None { .. } | SteadyError::OutOfRange { .. })) => {
                Ok(Vec::new())
            }
            other => other.map_err(computation),
        }
    }

    /// A chart over two axes, each with its range and number of points, under lower bounds.
    pub(crate) fn chart(
        self,
        given: &[(&str, f64)],
        axes: [(&str, [f64; 2], usize); 2],
        least: &[(&str, f64)],
    ) -> Result<Chart> {
        let mut requirements = Vec::new();
        for (name, at_least) in least {
            let (term, at_least) = (self.term(name)?, *at_least);
            requirements.push(Requirement { term, at_least });
        }
        let [x, y] = axes.map(|(name, range, count)| {
            let term = self.term(name)?;
            Ok::<_, Error>(Axis { term, range, count })
        });
        let asked = Resolved {
            problem: self.problem(given)?,
            along: None,
            requirements,
            starts: CHART_STARTS,
        };
        asked.chart([x?, y?])
    }

    /// Branches as curves over two quantities.
    pub(crate) fn curves(
        self,
        branches: &[Branch],
        over: [&str; 2],
        stroke: Stroke,
    ) -> Result<Vec<Curve>> {
        let values = |branch: &Branch, name: &str| -> Result<Vec<f64>> {
            let term = self.term(name)?;
            let quantity = term.quantity(self.0.info());
            let points = branch.points.iter();
            let value = |at: &BranchPoint| quantity.to_unit(term.value(self.0, &at.point));
            Ok(points.map(value).collect())
        };
        let curve = |branch: &Branch| {
            let x = degrees(over[0], values(branch, over[0])?);
            let line = line("", x, values(branch, over[1])?);
            Ok(Curve { line, stroke })
        };
        branches.iter().map(curve).collect()
    }
}

/// Angles are drawn in degrees.
pub(crate) fn degrees(name: &str, values: Vec<f64>) -> Vec<f64> {
    if matches!(name, "theta" | "psi") {
        return values.into_iter().map(f64::to_degrees).collect();
    }
    values
}

/// Scale and letter of a quantity in figures: angles in degrees, letters of the paper.
pub(crate) fn shown(name: &str) -> Shown {
    let (label, scale) = match name {
        "theta" => ("ϑ [deg]", 1f64.to_degrees()),
        "psi_dot" => ("ψ̇ [rad/s]", 1.0),
        "phi_dot" => ("φ̇ [rad/s]", 1.0),
        other => (other, 1.0),
    };
    Shown {
        label: label.to_owned(),
        scale,
    }
}

/// Values at which a real eigenvalue passes through zero, in their order.
pub(crate) fn critical_values(branches: &[Branch]) -> Vec<f64> {
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let mut values: Vec<f64> = specials
        .filter(|special| special.kind == Kind::Critical(Change::RealZero))
        .map(|special| special.motion.value)
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The first of them; NaN without one.
pub(crate) fn first_critical(branches: &[Branch]) -> f64 {
    let critical = critical_values(branches);
    critical.first().copied().unwrap_or(f64::NAN)
}
