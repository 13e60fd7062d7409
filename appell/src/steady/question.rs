//! A question about steady motions, in texts with units.

use std::str::FromStr;

use appell_analysis::{Point, Requirement, SteadyProblem, Term};
use appell_runtime::model::Model;

use super::{Asked, refused, term, value_of};
use crate::Error;
use crate::setup::{Assignment, Setup, unique};

/// Starting points from which motions are sought, unless a question says otherwise.
pub const STARTS: usize = 40;

/// What is given and what is sought.
#[derive(Debug, Clone)]
pub struct Question {
    /// Parameters; the others are those of the spec.
    pub parameters: Vec<Assignment>,
    /// Values of states, inputs, outputs, or rates of hidden coordinates; inputs that are not fixed are zero.
    pub fix: Vec<Assignment>,
    /// Inputs or parameters whose values follow.
    pub free: Vec<String>,
    /// A quantity along which the motions are followed.
    pub along: Option<Span>,
    /// Lower bounds of feasible motions.
    pub require: Vec<Assignment>,
    /// Starting points from which motions are sought.
    pub starts: usize,
}

/// A quantity with its first and last value.
#[derive(Debug, Clone)]
pub struct Span {
    /// The quantity.
    pub name: String,
    /// First and last value.
    pub ends: [String; 2],
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

impl Span {
    /// The quantity and its range in SI.
    pub fn resolve(&self, setup: &Setup<'_>, flag: &str) -> Result<(Term, [f64; 2]), Error> {
        let term = term(setup, &self.name)?;
        let label = format!("{flag} {}", self.name);
        let [from, to] = &self.ends;
        let ends = [from, to].map(|end| value_of(setup, term, end, &label));
        let [from, to] = ends;
        Ok((term, [from?, to?]))
    }
}

impl Default for Question {
    fn default() -> Self {
        Self {
            parameters: Vec::new(),
            fix: Vec::new(),
            free: Vec::new(),
            along: None,
            require: Vec::new(),
            starts: STARTS,
        }
    }
}

impl Question {
    /// Gives a quantity a value.
    #[must_use]
    pub fn fix(mut self, name: &str, value: impl ToString) -> Self {
        self.fix.push(Assignment::new(name, value));
        self
    }

    /// Lets the value of an input or parameter follow.
    #[must_use]
    pub fn free(mut self, name: &str) -> Self {
        self.free.push(name.to_owned());
        self
    }

    /// Follows the motions along a quantity.
    #[must_use]
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a number or a text is given as it stands"
    )]
    pub fn along(mut self, name: &str, from: impl ToString, to: impl ToString) -> Self {
        self.along = Some(Span {
            name: name.to_owned(),
            ends: [from.to_string(), to.to_string()],
        });
        self
    }

    /// The question with its names resolved; the parameters are those of the setup.
    pub fn resolve<'a>(&self, model: &'a dyn Model, setup: &Setup<'_>) -> Result<Asked<'a>, Error> {
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
        unique(&self.fix, "--fix")?;
        for Assignment { name, value } in &self.fix {
            let term = term(setup, name)?;
            let value = value_of(setup, term, value, &format!("--fix {name}"))?;
            problem.fix(term, value).map_err(|error| refused(&error))?;
        }
        let along = self.along.as_ref();
        let along = along.map(|span| span.resolve(setup, "--along"));
        let requirement = |Assignment { name, value }: &Assignment| {
            let term = term(setup, name)?;
            let at_least = value_of(setup, term, value, &format!("--require {name}"))?;
            Ok(Requirement { term, at_least })
        };
        Ok(Asked {
            problem,
            along: along.transpose()?,
            requirements: self
                .require
                .iter()
                .map(requirement)
                .collect::<Result<_, Error>>()?,
            starts: self.starts,
        })
    }
}
