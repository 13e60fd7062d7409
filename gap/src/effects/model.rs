//! A mechanism with many candidates, derived at once.
//!
//! All of them stand in one spec with sizes of zero: at these values its equations are those of the
//! mechanism, and their derivatives are what each candidate would do first. A hypothesis sets some
//! sizes free.

use std::collections::BTreeMap;

use appell_codegen::compile::report;
use appell_codegen::derived;
use appell_codegen::jit::{JitError, JitModel};
use appell_codegen::mechanics::assemble;
use appell_codegen::program::FunctionKind;
use appell_codegen::velocities::Velocities;
use appell_runtime::model::{Model, ModelInfo};
use appell_spec::compose::Composition;
use appell_spec::edit::EditError;
use appell_spec::{Mechanism, Report};

use super::effect::{Effect, EffectError};
use super::site::{Scales, Sites};
use super::{Candidate, Family};
use crate::data::Spec;

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
    model: JitModel,
    /// The model without contacts that creep, which is much shorter. Its parameters come first in the
    /// whole one.
    rolling: Option<JitModel>,
}

/// All candidates of some effects in a mechanism.
pub fn candidates(
    mechanism: &Mechanism,
    spec: &Spec,
    effects: &[Effect],
    scales: &Scales,
) -> Result<Vec<Candidate>, ModelError> {
    let velocities = Velocities::of(mechanism)
        .map_err(|findings| ModelError::Spec(Box::new(report(mechanism, &spec.text, &findings))))?;
    let sites = Sites::new(mechanism, &velocities, scales);
    let mut all = Vec::new();
    for effect in effects {
        all.extend(Candidate::all(effect, mechanism, &sites)?);
    }
    Ok(all)
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

    fn with_all(spec: &Spec, candidates: Vec<Candidate>) -> Result<Self, ModelError> {
        let text = with_candidates(&spec.text, &candidates)?;
        let wrong = |report: Report| ModelError::Spec(Box::new(report));
        let derived = derived(&spec.file, &text).map_err(wrong)?;
        let mechanism = derived.mechanism;
        let program = assemble::program(derived.derivation, &mechanism, &FunctionKind::ALL)
            .map_err(|findings| wrong(report(&mechanism, &text, &findings)))?;
        Ok(Self {
            candidates,
            mechanism,
            spec: Spec {
                file: spec.file.clone(),
                text,
            },
            model: JitModel::new(&program)?,
            rolling: None,
        })
    }

    /// The shortest equations that have some candidates.
    pub fn with(&self, members: &[usize]) -> &dyn Model {
        let creeps = members
            .iter()
            .any(|&member| self.candidates[member].creeps());
        match &self.rolling {
            Some(rolling) if !creeps => rolling,
            _ => &self.model,
        }
    }

    /// Its equations.
    pub fn model(&self) -> &dyn Model {
        &self.model
    }

    /// Names and sizes of its equations.
    pub fn info(&self) -> &ModelInfo {
        self.model.info()
    }
}

/// A spec with candidates.
pub fn with_candidates(text: &str, candidates: &[Candidate]) -> Result<String, EditError> {
    let mut spec = Composition::new(text)?;
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
    }
    // What candidates add does not feel what they add to inputs.
    let mut centres: BTreeMap<&str, &str> = BTreeMap::new();
    for candidate in candidates {
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

impl Family {
    /// Whether it acts in the equations of motion.
    pub fn has_equations(self) -> bool {
        !matches!(self, Self::Sensor)
    }
}
