//! Questions about steady motions from the command line, and what is common to their answers.

pub(crate) mod export;
pub(crate) mod regions;
pub(crate) mod told;

use std::path::PathBuf;
use std::str::FromStr;

use appell_analysis::{
    Axis, Branch, BranchError, BranchOptions, Branches, Chart, ChartError, Point, Requirement,
    Stability, SteadyError, SteadyMotion, SteadyProblem, Term,
};
use appell_spec::did_you_mean;
use appell_spec::units::{self, Unit};

use crate::engine::Equations;
use crate::failure::Failure;
use crate::progress;
use crate::setup::{Assignment, Setup};
use crate::source::Source;

/// What is given and what is sought.
#[derive(Debug, clap::Args)]
pub(crate) struct Question {
    /// Name of a shipped mechanism or path of a spec
    pub(crate) model: String,
    /// A parameter, such as R=0.3 or R=30cm
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Assignment>,
    /// The value of a state, input, output, or rate of a hidden coordinate, such as theta=10deg;
    /// inputs that are not fixed are zero
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    fix: Vec<Assignment>,
    /// An input or parameter whose value follows
    #[arg(long, value_name = "NAME")]
    free: Vec<String>,
    /// Follow the motions along a quantity, such as speed=0.5..10 or theta=-30deg..30deg
    #[arg(long, value_name = "NAME=FROM..TO", allow_hyphen_values = true)]
    pub(crate) along: Option<Span>,
    /// Motions below this are not feasible, such as z>=0
    #[arg(long, value_name = "NAME>=VALUE", allow_hyphen_values = true)]
    require: Vec<Least>,
    /// Starting points from which motions are sought
    #[arg(long, value_name = "N", default_value_t = 40)]
    starts: usize,
    /// Write the motions, in the units of the spec; `-` is standard output
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Draw the motions along the quantity
    #[arg(long, value_name = "FILE.svg|png")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the motions in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

/// `NAME=FROM..TO` as it was given.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    /// The quantity.
    pub(crate) name: String,
    /// First and last value.
    pub(crate) ends: [String; 2],
}

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=').and_then(|(name, span)| {
            let (from, to) = span.split_once("..")?;
            Some([name, from, to].map(|part| part.trim().to_owned()))
        });
        match parts {
            Some([name, from, to]) if ![&name, &from, &to].iter().any(|part| part.is_empty()) => {
                let ends = [from, to];
                Ok(Self { name, ends })
            }
            _ => {
                Err("write NAME=FROM..TO, such as speed=0.5..10 or theta=-30deg..30deg".to_owned())
            }
        }
    }
}

/// `NAME>=VALUE` as it was given.
#[derive(Debug, Clone)]
pub(crate) struct Least(Assignment);

impl FromStr for Least {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text
            .split_once(">=")
            .ok_or("write NAME>=VALUE, such as z>=0")?;
        let assignment = Assignment::from_str(&format!("{name}={value}"))?;
        Ok(Self(assignment))
    }
}

/// A question with its names resolved.
pub(crate) struct Asked<'a> {
    /// The problem with its conditions.
    pub(crate) problem: SteadyProblem<'a>,
    /// The quantity to follow, and its range in SI.
    pub(crate) along: Option<(Term, [f64; 2])>,
    /// What feasible motions satisfy.
    pub(crate) requirements: Vec<Requirement>,
    starts: usize,
}

/// Motions that stand alone, or branches of them.
pub(crate) enum Answer {
    /// Each with its stability.
    Motions(Vec<(SteadyMotion, Stability)>),
    /// Along a quantity.
    Branches(Vec<Branch>),
}

impl Question {
    /// Derives or finds the equations, reads the values and hands both on.
    pub(crate) fn with<T>(
        &self,
        then: impl FnOnce(&Asked<'_>, &Setup<'_>) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let source = Source::find(&self.model)?;
        let equations = Equations::at_hand(&source)?;
        let mut setup = Setup::new(&source.file, &source.text, equations.model().info())?;
        setup.set(&self.set)?;
        then(&self.asked(&equations, &setup)?, &setup)
    }

    fn asked<'a>(&self, equations: &'a Equations, setup: &Setup<'_>) -> Result<Asked<'a>, Failure> {
        let model = equations.model();
        let point = Point {
            p: setup.parameters.clone(),
            ..Point::initial(model)
        };
        let mut problem = SteadyProblem::new(model, point).map_err(|error| refused(&error))?;
        for name in &self.free {
            problem
                .free(term(setup, name)?)
                .map_err(|error| refused(&error))?;
        }
        crate::setup::unique(&self.fix, "--fix")?;
        for Assignment { name, value } in &self.fix {
            let term = term(setup, name)?;
            let value = value_of(setup, term, value, &format!("--fix {name}"))?;
            problem.fix(term, value).map_err(|error| refused(&error))?;
        }
        let along = self
            .along
            .as_ref()
            .map(|span| span.resolve(setup, "--along"));
        let requirements = self
            .require
            .iter()
            .map(|Least(Assignment { name, value })| {
                let term = term(setup, name)?;
                let at_least = value_of(setup, term, value, &format!("--require {name}"))?;
                Ok(Requirement { term, at_least })
            });
        Ok(Asked {
            problem,
            along: along.transpose()?,
            requirements: requirements.collect::<Result<_, Failure>>()?,
            starts: self.starts,
        })
    }
}

impl Span {
    /// The quantity and its range in SI.
    pub(crate) fn resolve(
        &self,
        setup: &Setup<'_>,
        flag: &str,
    ) -> Result<(Term, [f64; 2]), Failure> {
        let term = term(setup, &self.name)?;
        let label = format!("{flag} {}", self.name);
        let [from, to] = &self.ends;
        let ends = [from, to].map(|end| value_of(setup, term, end, &label));
        let [from, to] = ends;
        Ok((term, [from?, to?]))
    }
}

impl Asked<'_> {
    /// The motions.
    pub(crate) fn answer(&self) -> Result<Answer, Failure> {
        let spinner = progress::spinner("looking for steady motions");
        let answer = match self.along {
            Some((along, range)) => {
                let options = BranchOptions::default();
                Branches::new(&self.problem, along, range, &self.requirements, options)
                    .and_then(|branches| branches.trace(self.starts))
                    .map(Answer::Branches)
                    .map_err(|error| unanswered(&error))
            }
            None => self.motions().map(Answer::Motions),
        };
        spinner.finish_and_clear();
        answer
    }

    fn motions(&self) -> Result<Vec<(SteadyMotion, Stability)>, Failure> {
        let found = self
            .problem
            .solve_isolated(self.starts)
            .map_err(|error| refused(&error))?;
        let judged = found.into_iter().map(|motion| {
            let structure = self.problem.structure();
            let stability = Stability::of(self.problem.model(), structure, &motion.point);
            stability
                .map(|stability| (motion, stability))
                .map_err(|error| Failure::Computation(error.to_string()))
        });
        judged.collect()
    }

    /// Stability over two quantities.
    pub(crate) fn chart(&self, axes: [Axis; 2]) -> Result<Chart, Failure> {
        let spinner = progress::spinner("drawing the chart");
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let requirements = &self.requirements;
        let chart = Chart::of(&self.problem, axes, requirements, self.starts, threads);
        spinner.finish_and_clear();
        chart.map_err(|error| match error {
            ChartError::Branch(error) => unanswered(&error),
            ChartError::Grid(..) => Failure::Usage(error.to_string()),
            other => Failure::Computation(other.to_string()),
        })
    }

    /// What is told of every motion.
    pub(crate) fn terms(&self) -> Vec<Term> {
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
    pub(crate) fn places(&self) -> Vec<([Term; 2], String)> {
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
pub(crate) fn term(setup: &Setup<'_>, name: &str) -> Result<Term, Failure> {
    Term::named(setup.info, name).ok_or_else(|| {
        let names = Term::names(setup.info);
        let names = || names.iter().map(String::as_str);
        let instead = did_you_mean(name, names(), || {
            format!("there are {}", names().collect::<Vec<_>>().join(", "))
        });
        Failure::Usage(format!("there is no quantity `{name}`; {instead}"))
    })
}

/// A value of a term in SI.
pub(crate) fn value_of(
    setup: &Setup<'_>,
    term: Term,
    text: &str,
    label: &str,
) -> Result<f64, Failure> {
    let quantity = term.quantity(setup.info);
    let unit: Unit = units::parse(&quantity.unit)
        .map_err(|_| Failure::Usage(format!("{label}: `{}` is no unit", quantity.unit)))?;
    setup.value(text, &unit, label)
}

fn unanswered(error: &BranchError) -> Failure {
    match error {
        BranchError::Steady(error) => refused(error),
        BranchError::Isolated { .. } | BranchError::Range { .. } => {
            Failure::Usage(error.to_string())
        }
        BranchError::Stability(_) => Failure::Computation(error.to_string()),
    }
}

/// Why there is no steady motion.
pub(crate) fn refused(error: &SteadyError) -> Failure {
    match error {
        SteadyError::None { .. } | SteadyError::Structure(_) => {
            Failure::Computation(error.to_string())
        }
        _ => Failure::Usage(error.to_string()),
    }
}
