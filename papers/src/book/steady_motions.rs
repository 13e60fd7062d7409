//! Steady motions of shipped mechanisms, by names and in SI.

use appell_analysis::{
    Axis, Branch, BranchError, BranchOptions, Branches, Chart, Point, Requirement, Special,
    SteadyError, SteadyProblem, Term,
};
use appell_models::Shipped;
use appell_report::figure::{Curve, Series, Stroke};
use appell_runtime::model::Model;

use crate::book::{computation, failed};
use appell::Error;
use appell::steady::regions::Shown;

/// Starting points from which motions are sought.
const STARTS: usize = 20;
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
    pub(crate) fn shipped(name: &str) -> Result<Self, Error> {
        let found = Shipped::find(name);
        let found = found.ok_or_else(|| failed(&format!("no shipped mechanism `{name}`")))?;
        Ok(Self(found.model))
    }

    pub(crate) fn term(self, name: &str) -> Result<Term, Error> {
        Term::named(self.0.info(), name).ok_or_else(|| failed(&format!("no quantity `{name}`")))
    }

    /// A quantity at a point, in SI.
    pub(crate) fn value(self, name: &str, point: &Point) -> Result<f64, Error> {
        Ok(self.term(name)?.value(self.0, point))
    }

    /// Steady motions with quantities as given.
    pub(crate) fn problem(self, given: &[(&str, f64)]) -> Result<SteadyProblem<'static>, Error> {
        let mut problem =
            SteadyProblem::new(self.0, Point::initial(self.0)).map_err(computation)?;
        for (name, value) in given {
            problem.fix(self.term(name)?, *value).map_err(computation)?;
        }
        Ok(problem)
    }

    /// Whether a search finds no steady motion.
    pub(crate) fn has_none(self, given: &[(&str, f64)], starts: usize) -> Result<bool, Error> {
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
    ) -> Result<Vec<Branch>, Error> {
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

    pub(crate) fn chart(
        self,
        given: &[(&str, f64)],
        axes: [(&str, [f64; 2], usize); 2],
        least: &[(&str, f64)],
    ) -> Result<Chart, Error> {
        let axis = |(name, range, count)| {
            let term = self.term(name)?;
            Ok::<_, Error>(Axis { term, range, count })
        };
        let [x, y] = axes;
        let axes = [axis(x)?, axis(y)?];
        let requirement = |(name, at_least): &(&str, f64)| {
            let (term, at_least) = (self.term(name)?, *at_least);
            Ok::<_, Error>(Requirement { term, at_least })
        };
        let requirements: Vec<_> = least.iter().map(requirement).collect::<Result<_, _>>()?;
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Chart::of(
            &self.problem(given)?,
            axes,
            &requirements,
            CHART_STARTS,
            threads,
        )
        .map_err(computation)
    }

    /// Branches as curves over two quantities.
    pub(crate) fn curves(
        self,
        branches: &[Branch],
        over: [&str; 2],
        stroke: Stroke,
    ) -> Result<Vec<Curve>, Error> {
        let [x, y] = over.map(|name| self.term(name));
        let (x, y) = (x?, y?);
        let info = self.0.info();
        let values = |branch: &Branch, term: Term| -> Vec<f64> {
            let quantity = term.quantity(info);
            (branch.points.iter())
                .map(|at| quantity.to_unit(term.value(self.0, &at.point)))
                .collect()
        };
        let curve = |branch: &Branch| Curve {
            line: Series {
                label: String::new(),
                x: degrees(over[0], values(branch, x)),
                y: values(branch, y),
            },
            stroke,
        };
        Ok(branches.iter().map(curve).collect())
    }
}

/// The motion of a cell of a chart.
pub(crate) fn cell_point(chart: &Chart, unknowns: &[f64], base: &Point) -> Point {
    let mut point = base.clone();
    for (term, value) in chart.unknowns.iter().zip(unknowns) {
        if let Term::State(state) = term {
            point.x[*state] = *value;
        }
    }
    point
}

/// Angles are drawn in degrees.
pub(crate) fn degrees(name: &str, values: Vec<f64>) -> Vec<f64> {
    if name == "theta" {
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

/// Values of the quantity at special points of branches.
pub(crate) fn values(branches: &[Branch], wanted: impl Fn(&Special) -> bool) -> Vec<f64> {
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    let mut values: Vec<f64> = specials
        .filter(|special| wanted(special))
        .map(|special| special.motion.value)
        .collect();
    values.sort_by(f64::total_cmp);
    values
}
