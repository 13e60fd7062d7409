//! Questions about steady motions, by the names of a spec.

pub mod export;
mod question;
pub mod regions;

use appell_analysis::{
    Axis, Branch, BranchError, BranchOptions, Branches, Chart, ChartError, Requirement, Stability,
    SteadyError, SteadyMotion, SteadyProblem, Term,
};
use appell_spec::did_you_mean;
use appell_spec::units::{self, Unit};

use crate::Error;
use crate::setup::Setup;

pub use question::{Question, STARTS, Span};

/// A question with its names resolved.
pub struct Asked<'a> {
    /// The problem with its conditions.
    pub problem: SteadyProblem<'a>,
    /// The quantity to follow, and its range in SI.
    pub along: Option<(Term, [f64; 2])>,
    /// What feasible motions satisfy.
    pub requirements: Vec<Requirement>,
    /// Starting points from which motions are sought.
    pub starts: usize,
}

/// Motions that stand alone, or branches of them.
pub enum Answer {
    /// Each with its stability.
    Motions(Vec<(SteadyMotion, Stability)>),
    /// Along a quantity.
    Branches(Vec<Branch>),
}

impl Asked<'_> {
    /// The motions.
    pub fn answer(&self) -> Result<Answer, Error> {
        match self.along {
            Some((along, range)) => {
                let options = BranchOptions::default();
                Branches::new(&self.problem, along, range, &self.requirements, options)
                    .and_then(|branches| branches.trace(self.starts))
                    .map(Answer::Branches)
                    .map_err(|error| unanswered(&error))
            }
            None => self.motions().map(Answer::Motions),
        }
    }

    fn motions(&self) -> Result<Vec<(SteadyMotion, Stability)>, Error> {
        let found = self
            .problem
            .solve_isolated(self.starts)
            .map_err(|error| refused(&error))?;
        let judged = found.into_iter().map(|motion| {
            let structure = self.problem.structure();
            let stability = Stability::of(self.problem.model(), structure, &motion.point);
            stability
                .map(|stability| (motion, stability))
                .map_err(|error| Error::Computation(error.to_string()))
        });
        judged.collect()
    }

    /// Stability over two quantities.
    pub fn chart(&self, axes: [Axis; 2]) -> Result<Chart, Error> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let requirements = &self.requirements;
        let chart = Chart::of(&self.problem, axes, requirements, self.starts, threads);
        chart.map_err(|error| match error {
            ChartError::Branch(error) => unanswered(&error),
            ChartError::Grid(..) => Error::Usage(error.to_string()),
            other => Error::Computation(other.to_string()),
        })
    }

    /// What is told of every motion.
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

    /// Pairs of coordinates or outputs that are a place in the ground plane: `x…` and `y…`.
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

/// The term of a name, or what to write instead.
pub fn term(setup: &Setup<'_>, name: &str) -> Result<Term, Error> {
    Term::named(setup.info, name).ok_or_else(|| {
        let names = Term::names(setup.info);
        let names = || names.iter().map(String::as_str);
        let instead = did_you_mean(name, names(), || {
            format!("there are {}", names().collect::<Vec<_>>().join(", "))
        });
        Error::Usage(format!("there is no quantity `{name}`; {instead}"))
    })
}

/// A value of a term in SI.
pub fn value_of(setup: &Setup<'_>, term: Term, text: &str, label: &str) -> Result<f64, Error> {
    let quantity = term.quantity(setup.info);
    let unit: Unit = units::parse(&quantity.unit)
        .map_err(|_| Error::Usage(format!("{label}: `{}` is no unit", quantity.unit)))?;
    setup.value(text, &unit, label)
}

fn unanswered(error: &BranchError) -> Error {
    match error {
        BranchError::Steady(error) => refused(error),
        BranchError::Isolated { .. } | BranchError::Range { .. } => Error::Usage(error.to_string()),
        BranchError::Stability(_) => Error::Computation(error.to_string()),
    }
}

/// Why there is no steady motion.
pub fn refused(error: &SteadyError) -> Error {
    match error {
        SteadyError::None { .. } | SteadyError::Structure(_) => {
            Error::Computation(error.to_string())
        }
        _ => Error::Usage(error.to_string()),
    }
}
