//! Steady motions: requests in the names of a spec, and their results.

pub mod chart;
pub mod export;
mod question;
pub mod regions;

pub use appell_analysis::{
    Axis, Boundary, Branch, BranchError, BranchPoint, Cell, Change, Chart, ChartError, Edge, End,
    Kind, Point, Requirement, Special, Stability, StabilityError, SteadyError, SteadyMotion,
    SteadyProblem, Structure, Term, Verdict,
};
use appell_analysis::{BranchOptions, Branches};
use appell_spec::did_you_mean;
use appell_spec::units::{self, Unit};

use crate::setup::{Assignment, Setup};
use crate::{Error, Field};

pub use question::{Question, STARTS, Span};

/// A request with its names resolved.
pub struct Resolved<'a> {
    /// The problem with its conditions.
    pub problem: SteadyProblem<'a>,
    /// The continuation parameter, and its range in SI.
    pub along: Option<(Term, [f64; 2])>,
    /// Conditions on feasible motions.
    pub requirements: Vec<Requirement>,
    /// Number of starting points of the search.
    pub starts: usize,
}

/// Isolated motions, or branches of motions.
pub enum Answer {
    /// Each with its stability.
    Motions(Vec<(SteadyMotion, Stability)>),
    /// Along the continuation parameter.
    Branches(Vec<Branch>),
}

impl Resolved<'_> {
    /// The motions.
    pub fn answer(&self) -> Result<Answer, Error> {
        match self.along {
            Some((along, range)) => {
                let options = BranchOptions::default();
                let branches =
                    Branches::new(&self.problem, along, range, &self.requirements, options)?;
                Ok(Answer::Branches(branches.trace(self.starts)?))
            }
            None => self.motions().map(Answer::Motions),
        }
    }

    fn motions(&self) -> Result<Vec<(SteadyMotion, Stability)>, Error> {
        let found = self.problem.solve_isolated(self.starts)?;
        let judged = found.into_iter().map(|motion| {
            let structure = self.problem.structure();
            let stability = Stability::of(self.problem.model(), structure, &motion.point);
            Ok((motion, stability?))
        });
        judged.collect()
    }

    /// The stability chart over two quantities.
    pub fn chart(&self, axes: [Axis; 2]) -> Result<Chart, Error> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let requirements = &self.requirements;
        let chart = Chart::of(&self.problem, axes, requirements, self.starts, threads);
        Ok(chart?)
    }

    /// The quantities that are reported of every motion.
    pub fn terms(&self) -> Vec<Term> {
        let mut terms = self.problem.constants();
        terms.extend(self.problem.free_terms());
        if let Some((along, _)) = self.along
            && !terms.contains(&along)
        {
            terms.push(along);
        }
        terms
    }

    /// Pairs of coordinates or outputs that form a position in the ground plane: `x…` and `y…`.
    pub fn places(&self) -> Vec<([Term; 2], String)> {
        let info = self.problem.model().info();
        let coordinates = info
            .coordinate_quantities()
            .iter()
            .chain(info.outputs.iter());
        let pairs = coordinates.filter_map(|x| {
            let rest = x.name.strip_prefix('x')?;
            let pair = [x.name.to_string(), format!("y{rest}")];
            let [first, second] = pair.each_ref().map(|name| Term::named(info, name));
            let same = second?.quantity(info).unit == x.unit && x.unit == "m";
            same.then_some(([first?, second?], pair.join(", ")))
        });
        pairs.collect()
    }
}

/// The term of a name.
pub(crate) fn term(setup: &Setup<'_>, field: Field, name: &str) -> Result<Term, Error> {
    Term::named(setup.info, name).ok_or_else(|| {
        let names = Term::names(setup.info);
        let names = || names.iter().map(String::as_str);
        let instead = did_you_mean(name, names(), || {
            format!("there are {}", names().collect::<Vec<_>>().join(", "))
        });
        Error::request(field, format!("there is no quantity `{name}`; {instead}"))
    })
}

/// A value of a term in SI.
pub(crate) fn value_of(
    setup: &Setup<'_>,
    term: Term,
    field: Field,
    Assignment { name, value }: &Assignment,
) -> Result<f64, Error> {
    let quantity = term.quantity(setup.info);
    let unit: Unit = units::parse(&quantity.unit).map_err(|_| {
        let message = format!("{name}: `{}` is not a unit", quantity.unit);
        Error::request(field, message)
    })?;
    setup.value(field, name, value, &unit)
}
