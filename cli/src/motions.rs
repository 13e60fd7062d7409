//! Flags and output common to `appell steady` and `appell stability`.

pub(crate) mod text;

use std::path::PathBuf;
use std::str::FromStr;

use appell::Error;
use appell::engine::Equations;
use appell::setup::{Assignment, Setup};
use appell::source::Source;
use appell::steady::{Answer, Asked, refused, term, value_of};
use appell_analysis::{Axis, Chart, Point, Requirement, SteadyProblem, Term};

use crate::engine::equations;
use crate::progress;

/// The problem: prescribed values, free quantities, continuation parameter.
#[derive(Debug, clap::Args)]
pub(crate) struct Question {
    /// Name of a shipped mechanism or path of a spec
    pub(crate) model: String,
    /// A parameter, such as R=0.3 or R=30cm
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Assignment>,
    /// Prescribe a state, input, output, or rate of an ignorable coordinate, such as theta=10deg;
    /// other inputs are zero
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    fix: Vec<Assignment>,
    /// An input or parameter to solve for
    #[arg(long, value_name = "NAME")]
    free: Vec<String>,
    /// Continue the motions along a quantity, such as speed=0.5..10 or theta=-30deg..30deg
    #[arg(long, value_name = "NAME=FROM..TO", allow_hyphen_values = true)]
    pub(crate) along: Option<Span>,
    /// Lower bound for feasible motions, such as z>=0
    #[arg(long, value_name = "NAME>=VALUE", allow_hyphen_values = true)]
    require: Vec<Least>,
    /// Number of starting points of the search
    #[arg(long, value_name = "N", default_value_t = 40)]
    starts: usize,
    /// Write the motions, in the units of the spec; `-` is standard output
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Plot the motions against the quantity
    #[arg(long, value_name = "FILE.svg|png")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the motions as JSON, in SI; `-` is standard output
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

impl Question {
    /// Obtains the equations, reads the values and passes both on.
    pub(crate) fn with<T>(
        &self,
        then: impl FnOnce(&Asked<'_>, &Setup<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let source = Source::find(&self.model)?;
        let equations = equations(&source, None)?;
        let mut setup = Setup::new(&source.file, &source.text, equations.model().info())?;
        setup.set(&self.set)?;
        then(&self.asked(&equations, &setup)?, &setup)
    }

    fn asked<'a>(&self, equations: &'a Equations, setup: &Setup<'_>) -> Result<Asked<'a>, Error> {
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
        appell::setup::unique(&self.fix, "--fix")?;
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
            requirements: requirements.collect::<Result<_, Error>>()?,
            starts: self.starts,
        })
    }
}

impl Span {
    /// The quantity and its range in SI.
    pub(crate) fn resolve(&self, setup: &Setup<'_>, flag: &str) -> Result<(Term, [f64; 2]), Error> {
        let term = term(setup, &self.name)?;
        let label = format!("{flag} {}", self.name);
        let [from, to] = &self.ends;
        let ends = [from, to].map(|end| value_of(setup, term, end, &label));
        let [from, to] = ends;
        Ok((term, [from?, to?]))
    }
}

/// The motions, with a progress indicator.
pub(crate) fn answer(asked: &Asked<'_>) -> Result<Answer, Error> {
    let spinner = progress::spinner("searching for steady motions");
    let answer = asked.answer();
    spinner.finish_and_clear();
    answer
}

/// The stability chart, with a progress indicator.
pub(crate) fn chart(asked: &Asked<'_>, axes: [Axis; 2]) -> Result<Chart, Error> {
    let spinner = progress::spinner("computing the chart");
    let chart = asked.chart(axes);
    spinner.finish_and_clear();
    chart
}
