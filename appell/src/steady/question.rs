//! A request for steady motions, in texts with units.

use std::str::FromStr;

use appell_analysis::{Point, Requirement, SteadyProblem, Term};
use appell_runtime::model::Model;

use super::{Resolved, term, value_of};
use crate::setup::{Assignment, Setup, assigning, unique};
use crate::{Error, Field};

/// Default number of starting points of the search.
pub const STARTS: usize = 40;

/// A request for steady motions.
#[derive(Debug, Clone)]
pub struct Question {
    /// Parameters; the others are those of the spec.
    pub parameters: Vec<Assignment>,
    /// Values of states, inputs, outputs, or rates of ignorable coordinates; inputs that are not fixed are zero.
    pub fix: Vec<Assignment>,
    /// Inputs or parameters to solve for.
    pub free: Vec<String>,
    /// Continuation parameter.
    pub along: Option<Span>,
    /// Lower bounds of feasible motions.
    pub require: Vec<Assignment>,
    /// Number of starting points of the search.
    pub starts: usize,
    /// Whether motions outside of the declared ranges of states are admitted.
    pub ignore_ranges: bool,
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
    pub fn resolve(&self, setup: &Setup<'_>, field: Field) -> Result<(Term, [f64; 2]), Error> {
        let term = term(setup, field, &self.name)?;
        let ends = self.ends.each_ref().map(|end| {
            let end = Assignment::new(&self.name, end);
            value_of(setup, term, field, &end)
        });
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
            ignore_ranges: false,
        }
    }
}

impl Question {
    assigning! {
        /// Sets a parameter.
        set to parameters;
        /// Requires feasible motions to have at least this value of a quantity.
        require to require;
        /// Prescribes the value of a quantity.
        fix to fix;
    }

    /// Solves for an input or parameter.
    #[must_use]
    pub fn free(mut self, name: &str) -> Self {
        self.free.push(name.to_owned());
        self
    }

    /// Continues the motions along a quantity.
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

    /// The request with its names resolved; the parameters are those of the setup.
    pub fn resolve<'a>(
        &self,
        model: &'a dyn Model,
        setup: &Setup<'_>,
    ) -> Result<Resolved<'a>, Error> {
        let point = Point {
            p: setup.parameters.clone(),
            ..Point::initial(model)
        };
        let mut problem = SteadyProblem::new(model, point)?;
        if self.ignore_ranges {
            problem.ignore_ranges();
        }
        for name in &self.free {
            problem.free(term(setup, Field::Free, name)?)?;
        }
        unique(&self.fix, Field::Fix)?;
        for fixed in &self.fix {
            let term = term(setup, Field::Fix, &fixed.name)?;
            let value = value_of(setup, term, Field::Fix, fixed)?;
            if let (Term::State(state), false) = (term, self.ignore_ranges) {
                let within = setup.state_within(state, value);
                within.map_err(|message| Error::request(Field::Fix, message))?;
            }
            problem.fix(term, value)?;
        }
        let along = self.along.as_ref();
        let along = along.map(|span| span.resolve(setup, Field::Along));
        let requirement = |bound: &Assignment| {
            let term = term(setup, Field::Require, &bound.name)?;
            let at_least = value_of(setup, term, Field::Require, bound)?;
            Ok(Requirement { term, at_least })
        };
        Ok(Resolved {
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
