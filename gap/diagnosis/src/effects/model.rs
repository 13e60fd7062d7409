//! A mechanism with many candidates, derived at once.
//!
//! All of them are items of one spec with sizes of zero: at these values its equations are those of the
//! mechanism, and the derivatives by the sizes are the first-order effects of the candidates. A hypothesis
//! frees some sizes.
//!
//! A candidate that introduces a coordinate has its own model, which contains all other candidates and is derived on
//! demand. Every model declares its parameters, so that parameter indices agree.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use appell_codegen::jit::{JitError, JitModel};
use appell_codegen::program::FunctionKind;
use appell_codegen::tapes::Tapes;
use appell_runtime::model::{Model, ModelInfo};
use appell_spec::compose::Composition;
use appell_spec::edit::EditError;
use appell_spec::{Mechanism, Report};

use super::effect::{Effect, EffectError};
use super::load::Stated;
use super::site::{Scales, Sites, number};
use super::{Candidate, Drive, Part, Term};
use appell_recordings::Spec;

/// Placeholder of the centre of mass of a body after the preceding offsets.
const LAST_CENTRE: &str = "{last_centre}";

/// Why a mechanism with effects has no equations.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file of an effect is wrong.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The items cannot be added to the spec.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The spec with its effects is wrong.
    #[error("{}", .0.plain())]
    Spec(Box<Report>),
    /// Machine code cannot be generated.
    #[error(transparent)]
    Jit(#[from] JitError),
}

/// A mechanism with candidates.
#[derive(Debug)]
pub struct EffectModel {
    /// The candidates.
    pub candidates: Vec<Candidate>,
    /// The mechanism with all of them.
    pub mechanism: Mechanism,
    model: Arc<JitModel>,
    /// The model without creeping contacts, which is much shorter. Its parameters are the first ones of the
    /// whole model.
    rolling: Option<Arc<JitModel>>,
    /// The equations of hypotheses, derived on demand.
    hypotheses: OnceLock<Box<Hypothesis>>,
    /// The model of each candidate with an additional coordinate, derived on demand.
    augmented: Vec<OnceLock<Option<Augmented>>>,
    /// The spec that candidates are added to.
    plain: Spec,
    /// Candidates that the spec has already, with stated tolerances of their sizes.
    pub(crate) in_spec: Vec<Candidate>,
    /// Whether parameter values are those of earlier recordings, so that a gap is a change.
    pub(crate) is_of_changes: bool,
}

/// The equations of some candidates, in a list of those derived so far.
#[derive(Debug)]
struct Hypothesis {
    members: Vec<usize>,
    /// The equations that also contain all other candidates.
    whole: Arc<JitModel>,
    own: JitModel,
    next: OnceLock<Box<Hypothesis>>,
}

/// A model with the additional coordinate of a candidate.
#[derive(Debug)]
struct Augmented {
    /// The candidate, with all placeholders replaced.
    candidate: Candidate,
    model: Arc<JitModel>,
    /// The largest integration step in s, for a fast model.
    longest_step: Option<f64>,
}

/// All candidates of some effects in a mechanism.
pub fn candidates(
    mechanism: &Mechanism,
    spec: &Spec,
    effects: &[Effect],
    scales: &Scales,
) -> Result<Vec<Candidate>, ModelError> {
    let text = &spec.text;
    let sites = Sites {
        mechanism,
        scales,
        text,
    };
    let mut all = Vec::new();
    for effect in effects {
        let own = Candidate::all(effect, &sites, &all)?;
        own.iter()
            .try_for_each(|candidate| check(spec, candidate))?;
        all.extend(own);
    }
    Ok(all)
}

/// A candidate with all placeholders replaced, alone in its spec; `None` where it needs a drive and there is none.
pub fn written(spec: &Spec, candidate: &Candidate) -> Result<Option<Candidate>, ModelError> {
    let centre = candidate.centre.clone().unwrap_or_default();
    let candidate = candidate.with_words(&[(LAST_CENTRE.trim_matches(['{', '}']), &centre)]);
    let Some(speed) = candidate.brings else {
        return Ok(Some(candidate));
    };
    let (mechanism, model) = derive(&spec.file, &spec.text, &OF_ESTIMATION)?;
    let parameters = model.info().default_parameters();
    let drive = Drive::of(model.as_ref(), &parameters, speed);
    Ok(drive.map(|drive| candidate.driven(&mechanism, &drive)))
}

/// Checks the spec with a user-defined effect; errors refer to the file of the effect.
fn check(spec: &Spec, candidate: &Candidate) -> Result<(), ModelError> {
    let Some(source) = &candidate.source else {
        return Ok(());
    };
    // The force of the drive is known only with the equations; here a zero of the same dimension replaces it.
    let (force, inertia) = (candidate.nothing(), number(1.0));
    let whole = candidate.with_words(&[("drive", &force), ("inertia", &inertia)]);
    let text = with_candidates(&spec.text, &[whole])?;
    match appell_spec::load(&spec.file, &text) {
        Ok(_) => Ok(()),
        Err(report) => Err(source.blamed(&report, &text).into()),
    }
}

impl Candidate {
    /// Replaces the placeholders of its drive.
    fn driven(&self, mechanism: &Mechanism, drive: &Drive) -> Self {
        let inputs = mechanism.inputs.iter();
        let force = drive.written(inputs.map(|input| input.label.name.as_str()));
        let inertia = number(drive.inertia);
        self.with_words(&[("drive", &force), ("inertia", &inertia)])
    }
}

impl EffectModel {
    /// Derives the mechanism of a spec with candidates, without those of contacts where contact forces are
    /// undetermined.
    pub fn new(spec: &Spec, mut candidates: Vec<Candidate>) -> Result<Self, ModelError> {
        // Creeping contacts come last, so that the indices of all other parameters do not depend on them.
        candidates.sort_by_key(Candidate::creeps);
        let others = candidates.partition_point(|one| !one.creeps());
        if others == candidates.len() {
            return Self::requiring(spec, candidates, &OF_ESTIMATION);
        }
        let rolling = Self::requiring(spec, candidates[..others].to_vec(), &OF_ESTIMATION)?;
        Ok(match Self::requiring(spec, candidates, &OF_ESTIMATION) {
            Ok(whole) => Self {
                rolling: Some(rolling.model),
                ..whole
            },
            Err(_) => rolling,
        })
    }

    /// The same for inverse dynamics, without candidates that add coordinates or make contacts creep.
    pub(crate) fn of_forces(
        spec: &Spec,
        mut candidates: Vec<Candidate>,
    ) -> Result<Self, ModelError> {
        candidates.retain(|one| !one.creeps() && one.brings.is_none());
        Self::requiring(spec, candidates, &[FunctionKind::InverseDynamics])
    }

    fn requiring(
        spec: &Spec,
        candidates: Vec<Candidate>,
        functions: &[FunctionKind],
    ) -> Result<Self, ModelError> {
        let declared: Vec<Candidate> = candidates.iter().map(Candidate::declared).collect();
        let text = with_candidates(&spec.text, &declared)?;
        let (mechanism, model) =
            derive(&spec.file, &text, functions).map_err(|error| blamed(spec, &declared, error))?;
        Ok(Self {
            augmented: candidates.iter().map(|_| OnceLock::new()).collect(),
            candidates,
            mechanism,
            model,
            rolling: None,
            hypotheses: OnceLock::new(),
            plain: spec.clone(),
            in_spec: Vec::new(),
            is_of_changes: false,
        })
    }

    /// The same spec with other candidates.
    pub(crate) fn again(&self, candidates: Vec<Candidate>) -> Result<Self, ModelError> {
        Ok(Self::new(&self.plain, candidates)?.in_spec(&self.in_spec))
    }

    /// The same, where the spec has some candidates already.
    pub(crate) fn in_spec(self, in_spec: &[Candidate]) -> Self {
        Self {
            in_spec: in_spec.to_vec(),
            ..self
        }
    }

    /// Derives the model of a candidate with an additional coordinate; returns whether that succeeded.
    pub(crate) fn augment(&self, index: usize, drive: &Drive) -> bool {
        let augmented = self.augmented[index].get_or_init(|| self.augmented(index, drive).ok());
        augmented.is_some()
    }

    fn augmented(&self, index: usize, drive: &Drive) -> Result<Augmented, ModelError> {
        let candidate = self.candidates[index].driven(&self.mechanism, drive);
        let others = self.candidates.iter().filter(|one| !one.creeps());
        let mut beside: Vec<Candidate> = others.map(Candidate::declared).collect();
        beside[index].clone_from(&candidate);
        let text = with_candidates(&self.plain.text, &beside)?;
        let (mechanism, model) = derive(&self.plain.file, &text, &OF_ESTIMATION)?;
        Ok(Augmented {
            candidate,
            model,
            longest_step: mechanism.longest_step,
        })
    }

    /// Whether a candidate is incompatible with every one that adds a coordinate.
    pub(crate) fn stands_alone(&self, index: usize) -> bool {
        let candidate = &self.candidates[index];
        candidate.creeps() || candidate.brings.is_some()
    }

    /// A candidate, with all placeholders replaced that are known by now.
    pub fn candidate(&self, index: usize) -> &Candidate {
        let augmented = self.augmented[index].get().and_then(Option::as_ref);
        augmented.map_or(&self.candidates[index], |augmented| &augmented.candidate)
    }

    /// The model with the additional coordinate of a member, if any.
    fn augmented_with(&self, members: &[usize]) -> Option<&Augmented> {
        let mut augmented = members
            .iter()
            .filter_map(|&member| self.augmented[member].get());
        augmented.find_map(Option::as_ref)
    }

    /// The largest integration step in s for some candidates, if their equations are fast.
    pub(crate) fn longest_step(&self, members: &[usize]) -> Option<f64> {
        let own = self.mechanism.longest_step;
        let augmented = self
            .augmented_with(members)
            .and_then(|augmented| augmented.longest_step);
        own.into_iter().chain(augmented).reduce(f64::min)
    }

    /// The shortest equations with some candidates. Derivatives with respect to the parameters of all others are
    /// zero; they are valid only while the sizes of all others are zero.
    pub fn with(&self, members: &[usize]) -> &dyn Model {
        let whole = self.whole(members);
        let mut place = &self.hypotheses;
        loop {
            let one = place.get_or_init(|| Box::new(self.hypothesis(members, whole)));
            if one.members == members && Arc::ptr_eq(&one.whole, whole) {
                return &one.own;
            }
            place = &one.next;
        }
    }

    fn hypothesis(&self, members: &[usize], whole: &Arc<JitModel>) -> Hypothesis {
        let info = whole.info();
        let others = self.candidates.iter().enumerate();
        let others = others.filter(|(index, _)| !members.contains(index));
        let sizes = others.flat_map(|(_, candidate)| {
            let own = candidate.parameters.iter();
            own.filter(|(_, part)| !part.is_shape())
        });
        let zeros: Vec<usize> = sizes
            .filter_map(|(name, _)| info.parameter_index(name))
            .collect();
        Hypothesis {
            members: members.to_vec(),
            own: whole.without(&zeros),
            whole: whole.clone(),
            next: OnceLock::new(),
        }
    }

    /// Equations that contain some candidates among others.
    fn whole(&self, members: &[usize]) -> &Arc<JitModel> {
        if let Some(augmented) = self.augmented_with(members) {
            return &augmented.model;
        }
        let creeps = members
            .iter()
            .any(|&member| self.candidates[member].creeps());
        match &self.rolling {
            Some(rolling) if !creeps => rolling,
            _ => &self.model,
        }
    }

    /// The equations with all candidates that are compatible with some members.
    pub fn beside(&self, members: &[usize]) -> &dyn Model {
        let augmented = self.augmented_with(members);
        &**augmented.map_or(&self.model, |augmented| &augmented.model)
    }

    /// Indices of the parameters of a candidate, with their roles.
    pub(crate) fn own(&self, candidate: &Candidate) -> Vec<(usize, Part)> {
        let info = self.info();
        let own = candidate.parameters.iter();
        own.filter_map(|(name, part)| Some((info.parameter_index(name)?, *part)))
            .collect()
    }

    /// Names and sizes of its equations.
    pub fn info(&self) -> &ModelInfo {
        self.model.info()
    }
}

/// The reason why a spec has no equations: the first user-defined effect that fails alone, if any.
fn blamed(spec: &Spec, candidates: &[Candidate], error: ModelError) -> ModelError {
    let alone = |candidate: &Candidate| {
        let source = candidate.source.as_ref()?;
        let text = with_candidates(&spec.text, std::slice::from_ref(candidate)).ok()?;
        match derive(&spec.file, &text, &OF_ESTIMATION) {
            Err(ModelError::Spec(report)) => Some(source.blamed(&report, &text).into()),
            _ => None,
        }
    };
    candidates.iter().find_map(alone).unwrap_or(error)
}

/// The functions of a likelihood and its gradient.
const OF_ESTIMATION: [FunctionKind; 4] = [
    FunctionKind::Jacobians,
    FunctionKind::Adjoint,
    FunctionKind::OutputJacobians,
    FunctionKind::OutputAdjoint,
];

/// The mechanism of a spec, and machine code of its equations with functions that must be possible.
fn derive(
    file: &str,
    text: &str,
    functions: &[FunctionKind],
) -> Result<(Mechanism, Arc<JitModel>), ModelError> {
    let wrong = |report: Report| ModelError::Spec(Box::new(report));
    let mechanism = appell_spec::load(file, text).map_err(wrong)?.mechanism;
    let tapes = Arc::new(Tapes::of_spec(file, text).map_err(wrong)?);
    tapes.require(functions, text).map_err(wrong)?;
    Ok((mechanism, Arc::new(JitModel::over(tapes)?)))
}

/// A spec with candidates.
pub fn with_candidates(text: &str, candidates: &[Candidate]) -> Result<String, EditError> {
    let mut spec = Composition::new(text)?;
    // Terms that other candidates add to inputs also act on the drive of an additional coordinate.
    for candidate in candidates.iter().filter(|one| one.brings.is_some()) {
        spec.add(&candidate.items)?;
    }
    // Expressions of loads that effects refer to, each defined once: inputs act in them too.
    let mut stated = Composition::new("")?;
    let mut limited: BTreeMap<&str, Vec<(&Candidate, &Stated, &str)>> = BTreeMap::new();
    for candidate in candidates {
        if let Some((stated, added)) = &candidate.limits {
            let load = limited.entry(&candidate.site).or_default();
            load.push((candidate, stated, added));
        }
    }
    for (load, own) in limited {
        let added: Vec<&str> = own.iter().map(|(_, _, added)| *added).collect();
        for (place, (candidate, as_in_spec, _)) in own.iter().enumerate() {
            stated.add(&as_in_spec.definition(&candidate.stem))?;
            if place == 0 {
                spec.add(&as_in_spec.with(load, &added))?;
            }
        }
    }
    let terms = candidates.iter().flat_map(|candidate| &candidate.added);
    Term::add(&terms.collect::<Vec<_>>(), &mut spec, Some(&mut stated));
    spec.add(&stated.text())?;
    // Inputs in the items of other candidates are not substituted.
    let mut centres: BTreeMap<&str, &str> = BTreeMap::new();
    for candidate in candidates.iter().filter(|one| one.brings.is_none()) {
        let moved = candidate.items.contains(LAST_CENTRE);
        match candidate.centre.as_deref().filter(|_| moved) {
            Some(centre) => {
                let last = centres.insert(&candidate.site, &candidate.stem);
                let last = last.unwrap_or(centre);
                spec.add(&candidate.items.replace(LAST_CENTRE, last))?;
            }
            None => spec.add(&candidate.items)?,
        }
    }
    Ok(spec.text())
}
