//! A mechanism with many candidates, derived at once.
//!
//! All of them stand in one spec with sizes of zero: at these values its equations are those of the
//! mechanism, and their derivatives are what each candidate would do first. A hypothesis sets some
//! sizes free.
//!
//! A candidate that brings a coordinate has a model of its own, with all others beside it, derived once it
//! is asked for. Its parameters stand in every model, so that they have the same places everywhere.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use appell_codegen::compile::report;
use appell_codegen::derived;
use appell_codegen::jit::{JitError, JitModel};
use appell_codegen::mechanics::assemble;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{Model, ModelInfo};
use appell_spec::compose::Composition;
use appell_spec::edit::EditError;
use appell_spec::{Mechanism, Report};

use super::effect::{Effect, EffectError};
use super::load::Stated;
use super::site::{Scales, Sites, number};
use super::{Candidate, Drive, Part};
use appell_recordings::Spec;

/// Sections whose expressions inputs act in.
pub(crate) const ACTING: [&str; 2] = ["loads", "constraints"];

/// Stands for the centre of mass of a body with what moves it so far.
const LAST_CENTRE: &str = "{last_centre}";

/// Why a mechanism with effects has no equations.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file of an effect is wrong.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The spec cannot be added to.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The spec with its effects is wrong.
    #[error("{}", .0.plain())]
    Spec(Box<Report>),
    /// No machine code can be made.
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
    /// The spec with all of them.
    pub spec: Spec,
    model: Arc<JitModel>,
    /// The model without contacts that creep, which is much shorter. Its parameters come first in the
    /// whole one.
    rolling: Option<Arc<JitModel>>,
    /// The equations of hypotheses that were asked for.
    hypotheses: OnceLock<Box<Hypothesis>>,
    /// For each candidate that brings a coordinate, once it was asked for.
    augmented: Vec<OnceLock<Option<Augmented>>>,
    /// The spec that candidates are added to.
    plain: Spec,
    /// Whether values are those of recordings before, so that an error is a change.
    pub(crate) is_of_changes: bool,
}

/// The equations of some candidates, and those that were asked for after them.
#[derive(Debug)]
struct Hypothesis {
    members: Vec<usize>,
    /// The equations that also have all others.
    whole: Arc<JitModel>,
    own: Option<JitModel>,
    next: OnceLock<Box<Hypothesis>>,
}

/// A model with a coordinate that a candidate brings.
#[derive(Debug)]
struct Augmented {
    /// The candidate, all words of its items told.
    candidate: Candidate,
    model: Arc<JitModel>,
    /// The longest step in s that it bears, where it is fast.
    longest_step: Option<f64>,
}

/// All candidates of some effects in a mechanism.
pub fn candidates(
    mechanism: &Mechanism,
    spec: &Spec,
    effects: &[Effect],
    scales: &Scales,
) -> Result<Vec<Candidate>, ModelError> {
    let sites = Sites::of_spec(mechanism, scales, &spec.text);
    let mut all = Vec::new();
    for effect in effects {
        let own = Candidate::all(effect, mechanism, &sites)?;
        own.iter()
            .try_for_each(|candidate| check(spec, candidate))?;
        all.extend(own);
    }
    Ok(all)
}

/// A candidate with all its words, as a spec has it beside no other; nothing where it acts on a drive, and none is there.
pub fn written(spec: &Spec, candidate: &Candidate) -> Result<Option<Candidate>, ModelError> {
    let centre = candidate.centre.clone().unwrap_or_default();
    let candidate = candidate.told(&[(LAST_CENTRE.trim_matches(['{', '}']), &centre)]);
    let Some(speed) = candidate.brings else {
        return Ok(Some(candidate));
    };
    let (mechanism, model) = derive((&spec.file, &spec.text), &FunctionKind::ALL)?;
    let parameters = model.info().default_parameters();
    let drive = Drive::of(model.as_ref(), &parameters, speed);
    Ok(drive.map(|drive| candidate.driven(&mechanism, &drive)))
}

/// Whether the effect of a user makes a spec wrong: that is told in the words of its file.
fn check(spec: &Spec, candidate: &Candidate) -> Result<(), ModelError> {
    let Some(source) = &candidate.source else {
        return Ok(());
    };
    // What a coordinate of its own needs is known once there are equations; zero has its dimension.
    let (force, inertia) = (candidate.nothing(), number(1.0));
    let whole = candidate.told(&[("drive", &force), ("inertia", &inertia)]);
    let text = with_candidates(&spec.text, &[whole])?;
    match appell_spec::load(&spec.file, &text) {
        Ok(_) => Ok(()),
        Err(report) => Err(source.blamed(&report, &text).into()),
    }
}

impl Candidate {
    /// With the words about what drives it.
    fn driven(&self, mechanism: &Mechanism, drive: &Drive) -> Self {
        let inputs = mechanism.inputs.iter();
        let force = drive.written(inputs.map(|input| input.label.name.as_str()));
        let inertia = number(drive.inertia);
        self.told(&[("drive", &force), ("inertia", &inertia)])
    }
}

impl EffectModel {
    /// Derives the mechanism of a spec with candidates, without those of contacts where the forces of
    /// these cannot be told.
    pub fn new(spec: &Spec, mut candidates: Vec<Candidate>) -> Result<Self, ModelError> {
        // The last ones, so that all other parameters keep their places without them.
        candidates.sort_by_key(Candidate::creeps);
        let others = candidates.partition_point(|one| !one.creeps());
        if others == candidates.len() {
            return Self::with_all(spec, candidates);
        }
        let rolling = Self::with_all(spec, candidates[..others].to_vec())?;
        Ok(match Self::with_all(spec, candidates) {
            Ok(whole) => Self {
                rolling: Some(rolling.model),
                ..whole
            },
            Err(_) => rolling,
        })
    }

    /// The same for forces of motions alone, without candidates that bring coordinates or let contacts creep.
    pub(crate) fn of_forces(
        spec: &Spec,
        mut candidates: Vec<Candidate>,
    ) -> Result<Self, ModelError> {
        candidates.retain(|one| !one.creeps() && one.brings.is_none());
        // Recorded motions are found by Newton's method.
        let own = [FunctionKind::Jacobians, FunctionKind::InverseDynamics];
        let functions = [&FunctionKind::OF_MOTIONS[..], &own].concat();
        Self::with_functions(spec, candidates, &functions)
    }

    fn with_all(spec: &Spec, candidates: Vec<Candidate>) -> Result<Self, ModelError> {
        Self::with_functions(spec, candidates, &FunctionKind::ALL)
    }

    fn with_functions(
        spec: &Spec,
        candidates: Vec<Candidate>,
        functions: &[FunctionKind],
    ) -> Result<Self, ModelError> {
        let declared = |one: &Candidate| match one.brings {
            Some(_) => one.declared(),
            None => one.clone(),
        };
        let declared: Vec<Candidate> = candidates.iter().map(declared).collect();
        let text = with_candidates(&spec.text, &declared)?;
        let (mechanism, model) = derive((&spec.file, &text), functions)
            .map_err(|error| blamed(spec, &declared, error))?;
        Ok(Self {
            augmented: candidates.iter().map(|_| OnceLock::new()).collect(),
            candidates,
            mechanism,
            spec: Spec {
                file: spec.file.clone(),
                text,
            },
            model,
            rolling: None,
            hypotheses: OnceLock::new(),
            plain: spec.clone(),
            is_of_changes: false,
        })
    }

    /// The same spec with other candidates.
    pub(crate) fn again(&self, candidates: Vec<Candidate>) -> Result<Self, ModelError> {
        Self::new(&self.plain, candidates)
    }

    /// Derives the model of a candidate that brings a coordinate; whether there is one.
    pub(crate) fn augment(&self, index: usize, drive: &Drive) -> bool {
        let augmented = self.augmented[index].get_or_init(|| self.augmented(index, drive).ok());
        augmented.is_some()
    }

    fn augmented(&self, index: usize, drive: &Drive) -> Result<Augmented, ModelError> {
        let candidate = self.candidates[index].driven(&self.mechanism, drive);
        let others = self.candidates.iter().filter(|one| !one.creeps());
        let beside = others.enumerate().map(|(other, one)| match one.brings {
            Some(_) if other == index => candidate.clone(),
            Some(_) => one.declared(),
            None => one.clone(),
        });
        let beside: Vec<Candidate> = beside.collect();
        let text = with_candidates(&self.plain.text, &beside)?;
        let (mechanism, model) = derive((&self.plain.file, &text), &FunctionKind::ALL)?;
        Ok(Augmented {
            candidate,
            model,
            longest_step: mechanism.longest_step,
        })
    }

    /// Whether a candidate can stand beside none that brings a coordinate.
    pub(crate) fn stands_alone(&self, index: usize) -> bool {
        let candidate = &self.candidates[index];
        candidate.creeps() || candidate.brings.is_some()
    }

    /// A candidate, with all words that are told by now.
    pub fn candidate(&self, index: usize) -> &Candidate {
        let augmented = self.augmented[index].get().and_then(Option::as_ref);
        augmented.map_or(&self.candidates[index], |augmented| &augmented.candidate)
    }

    /// The model with the coordinate that a member brings.
    fn augmented_with(&self, members: &[usize]) -> Option<&Augmented> {
        let mut augmented = members
            .iter()
            .filter_map(|&member| self.augmented[member].get());
        augmented.find_map(Option::as_ref)
    }

    /// The longest step in s that some candidates bear, where their equations are fast.
    pub(crate) fn longest_step(&self, members: &[usize]) -> Option<f64> {
        let own = self.mechanism.longest_step;
        let augmented = self
            .augmented_with(members)
            .and_then(|augmented| augmented.longest_step);
        own.into_iter().chain(augmented).reduce(f64::min)
    }

    /// The shortest equations that have some candidates. Derivatives with respect to the parameters of others are
    /// zero; at sizes of others that are not zero they have these too.
    pub fn with(&self, members: &[usize]) -> &dyn Model {
        let whole = self.whole(members);
        let mut place = &self.hypotheses;
        loop {
            let one = place.get_or_init(|| Box::new(self.hypothesis(members, whole)));
            if one.members == members && Arc::ptr_eq(&one.whole, whole) {
                return match &one.own {
                    Some(own) => own,
                    None => &**whole,
                };
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
            own: whole.without(&zeros).ok(),
            whole: whole.clone(),
            next: OnceLock::new(),
        }
    }

    /// Equations that have some candidates and others.
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

    /// The equations of all candidates that can stand beside some members.
    pub fn beside(&self, members: &[usize]) -> &dyn Model {
        let augmented = self.augmented_with(members);
        &**augmented.map_or(&self.model, |augmented| &augmented.model)
    }

    /// Places of the parameters of a candidate, with what each is.
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

/// Why a spec has no equations: the effect of a user, if one has none alone.
fn blamed(spec: &Spec, candidates: &[Candidate], error: ModelError) -> ModelError {
    let alone = |candidate: &Candidate| {
        let source = candidate.source.as_ref()?;
        let text = with_candidates(&spec.text, std::slice::from_ref(candidate)).ok()?;
        match derive((&spec.file, &text), &FunctionKind::ALL) {
            Err(ModelError::Spec(report)) => Some(source.blamed(&report, &text).into()),
            _ => None,
        }
    };
    candidates.iter().find_map(alone).unwrap_or(error)
}

/// The mechanism of a spec, and machine code of its equations.
fn derive(
    (file, text): (&str, &str),
    functions: &[FunctionKind],
) -> Result<(Mechanism, Arc<JitModel>), ModelError> {
    let wrong = |report: Report| ModelError::Spec(Box::new(report));
    let derived = derived(file, text).map_err(wrong)?;
    let mechanism = derived.mechanism;
    let program = assemble::program(derived.derivation, &mechanism, functions)
        .map_err(|findings| wrong(report(&mechanism, text, &findings)))?;
    Ok((mechanism, Arc::new(JitModel::new(&program)?)))
}

/// A spec with candidates.
pub fn with_candidates(text: &str, candidates: &[Candidate]) -> Result<String, EditError> {
    let mut spec = Composition::new(text)?;
    // What drives a coordinate that a candidate brings feels what others add to inputs.
    for candidate in candidates.iter().filter(|one| one.brings.is_some()) {
        spec.add(&candidate.items)?;
    }
    // Expressions that effects name, once each: inputs act in them too.
    let mut stated = Composition::new("")?;
    for (load, own) in limited(candidates) {
        let added: Vec<&str> = own.iter().map(|(_, _, added)| *added).collect();
        for (place, (effect, as_in_spec, _)) in own.iter().enumerate() {
            stated.add(&as_in_spec.definition(effect))?;
            if place == 0 {
                spec.add(&as_in_spec.with(load, &added))?;
            }
        }
    }
    let mut inputs: Vec<&String> = Vec::new();
    for candidate in candidates {
        inputs.extend(candidate.added.iter().map(|(input, _)| input));
    }
    inputs.sort_unstable();
    inputs.dedup();
    for input in inputs {
        let added = candidates.iter().flat_map(|candidate| &candidate.added);
        let added = added
            .filter(|(own, _)| own == input)
            .map(|(_, text)| text.as_str());
        let parts: Vec<&str> = std::iter::once(input.as_str()).chain(added).collect();
        spec.substitute(&ACTING, input, &parts.join(" + "));
        stated.substitute(&["definitions"], input, &parts.join(" + "));
    }
    spec.add(&stated.text())?;
    // What other candidates add does not.
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

/// A candidate's name in a spec, the load as it stands there, and what is added to it.
type Limit<'c> = (&'c str, &'c Stated, &'c str);

/// The loads to whose expressions candidates add.
fn limited(candidates: &[Candidate]) -> BTreeMap<&str, Vec<Limit<'_>>> {
    let mut loads: BTreeMap<&str, Vec<Limit<'_>>> = BTreeMap::new();
    for candidate in candidates {
        if let Some((stated, added)) = &candidate.limits {
            let load = loads.entry(&candidate.site).or_default();
            load.push((&candidate.stem, stated, added));
        }
    }
    loads
}
