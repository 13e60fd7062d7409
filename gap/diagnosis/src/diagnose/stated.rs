//! Gains of actuators and scales of encoders with a tolerance (`gain_std`, `scale_std` of a channel): relative errors
//! that become parameters of the spec. Like those they are fitted within their tolerances in every hypothesis, and a
//! larger error is a hypothesis, which keeps the name of its effect.

use appell_recordings::{Channel, DataSet, Role, Spec};
use appell_spec::edit::set_deviations;
use appell_spec::mechanism::InputId;

use super::Result;
use crate::effects::{Candidate, ModelError, with_candidates};

/// A data set whose spec has these relative errors as parameters, and the candidates with which they were added.
pub(super) struct Stated {
    pub(super) set: DataSet,
    pub(super) candidates: Vec<Candidate>,
}

impl Stated {
    /// `None` where no line states such a tolerance.
    pub(super) fn of(set: &DataSet, all: &[Candidate]) -> Result<Option<Self>> {
        let (mut candidates, mut places) = (Vec::new(), Vec::new());
        let mut tolerances: Vec<(&str, f64)> = Vec::new();
        for (place, channel) in set.channels.iter().enumerate() {
            let of = site(set, channel).zip(channel.tolerance);
            let is_own = |own: &&Candidate, site| {
                own.has_tolerance && own.site == site && !own.parameters.is_empty()
            };
            if let Some((site, std)) = of
                && let Some(own) = all.iter().find(|own| is_own(own, site))
            {
                candidates.push(own.clone());
                tolerances.push((&own.parameters[0].0, std));
                places.push(place);
            }
        }
        if candidates.is_empty() {
            return Ok(None);
        }
        let text = with_candidates(&set.spec.text, &candidates).map_err(ModelError::from)?;
        let text = set_deviations(&text, &tolerances).map_err(ModelError::from)?;
        let file = set.spec.file.clone();
        let mut set = set.rebound(&Spec { file, text })?;
        for place in places {
            // The spec has it now: it is not one of the readings as well.
            set.channels[place].tolerance = None;
        }
        Ok(Some(Self { set, candidates }))
    }

    /// Recordings of the rig with the new spec.
    pub(super) fn bound(&self, set: &DataSet) -> DataSet {
        let mut bound = set.bound_to(&self.set.mechanism);
        bound.spec = self.set.spec.clone();
        for (channel, own) in bound.channels.iter_mut().zip(&self.set.channels) {
            channel.tolerance = own.tolerance;
        }
        bound
    }

    /// The index of the parameter of a candidate.
    fn place(&self, candidate: &Candidate) -> Option<usize> {
        let (name, _) = candidate.parameters.first()?;
        let mut own = self.set.mechanism.parameters.iter();
        own.position(|own| own.label.name == *name)
    }

    /// The candidates of the new spec, in which larger errors replace those of the effects.
    pub(super) fn replaced(&self, mut all: Vec<Candidate>) -> Vec<Candidate> {
        let errors = self.candidates.iter();
        let errors = errors.filter_map(|error| Some(error.of_parameter(self.place(error)?)));
        let errors: Vec<Candidate> = errors.collect();
        let is_other = |own: &Candidate| {
            let mut errors = errors.iter();
            errors.all(|error| own.acts != error.acts && own.name() != error.name())
        };
        all.retain(is_other);
        all.extend(errors);
        all
    }
}

/// The site of the errors of a channel.
fn site<'s>(set: &'s DataSet, channel: &'s Channel) -> Option<&'s str> {
    match channel.role {
        Role::Measures(_) => Some(&channel.column),
        Role::Input(input) => Some(&set.mechanism.inputs[InputId::new(input)].label.name),
        Role::Recorded => None,
    }
}
