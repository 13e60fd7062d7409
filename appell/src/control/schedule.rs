//! Gain schedules: a law at each value of a state, input or parameter.

use appell_analysis::Term;
use appell_runtime::model::{Model, Quantity};

use super::design::{self, Design};
use super::request::Request;
use super::{law_file, parse};
use crate::setup::{Assignment, Setup};
use crate::{Error, Field};

/// Designs over a scheduling variable.
pub struct Schedule {
    /// The scheduling variable.
    pub over: Quantity,
    /// Whether a law can measure it: inputs are set by the law instead.
    pub measurable: bool,
    /// Its values in SI, each with the design there.
    pub designs: Vec<(f64, Design)>,
}

impl Schedule {
    /// The designs of a request at the values of a range such as `v=1..20/10`.
    pub(crate) fn new(
        model: &dyn Model,
        mut setup: Setup<'_>,
        request: &Request,
        range: &Assignment,
    ) -> Result<Self, Error> {
        setup.set(&request.parameters)?;
        let mut goal = request.resolve(model, &setup)?;
        let values = parse::values(&mut setup, range)?;
        let mut designs: Vec<(f64, Design)> = Vec::new();
        for &value in &values.si {
            // The steady motion may be given in terms of the scheduling variable.
            values.place(&mut setup, &mut Vec::new(), value);
            let condition = Some((values.term, value));
            let design = parse::point(model, &mut setup, &request.at, condition)
                .and_then(|mut at| {
                    values.place(&mut setup, &mut at, value);
                    design::design(model, &setup, &at, &goal)
                })
                .map_err(|failure| values.at(&setup, value, failure))?;
            // All laws of a schedule feed back the same states.
            goal.outputs.clone_from(&design.outputs);
            designs.push((value, design));
        }
        Ok(Self {
            over: values.term.quantity(setup.info).into_owned(),
            measurable: !matches!(values.term, Term::Input(_)),
            designs,
        })
    }

    /// The text of a feedback file whose gains follow the scheduling variable.
    pub(crate) fn law(&self, setup: &Setup<'_>, model: &str) -> Result<String, Error> {
        let refused = |message: &str| Err(Error::request(Field::Schedule, message));
        if self.designs.iter().any(|(_, design)| design.law.is_none()) {
            return refused("without poles or weights there is no law");
        }
        self.is_readable(setup)?;
        let mut laws = self
            .designs
            .iter()
            .filter_map(|(_, design)| design.law.as_ref());
        if laws.any(|law| law.sampling.is_some()) {
            return refused("a sampled law cannot be scheduled yet");
        }
        if !self.measurable {
            return refused(
                "gains cannot follow an input, which they set; schedule a state or a parameter",
            );
        }
        Ok(law_file::schedule(&self.over, &self.designs, setup, model))
    }

    /// A scheduled law follows constant steady values, and cannot feed back the scheduling variable.
    fn is_readable(&self, setup: &Setup<'_>) -> Result<(), Error> {
        for (_, design) in &self.designs {
            for &state in &design.outputs {
                let name = &setup.info.states[state].name;
                if *name == self.over.name {
                    let message = format!(
                        "`{name}` selects the gains and cannot be fed back: choose other outputs"
                    );
                    return Err(Error::request(Field::Outputs, message));
                }
                if design.running(state) != 0.0 {
                    let message = format!(
                        "`{name}` advances with the steady motion, and the values of a schedule are \
                         constant: choose other outputs"
                    );
                    return Err(Error::request(Field::Outputs, message));
                }
            }
        }
        Ok(())
    }
}
