//! Diagnosis of recordings: the library of effects, a user's own, and failures in one type.

use std::path::PathBuf;

use appell_estimate::EstimateError;
use appell_gap::data::DataSet;
use appell_gap::diagnose::{self, DiagnoseError, Options, Report};
use appell_gap::effects::{self, Effect, EffectError, ModelError};
use appell_gap::identify::IdentifyError;

use crate::{Error, files, recording};

/// The effects that are tried.
#[derive(Debug)]
pub struct Library {
    effects: Vec<Effect>,
    /// What is worth a warning: an effect of the user's that takes the place of a shipped one.
    pub warnings: Vec<String>,
}

impl Library {
    /// The shipped effects.
    pub fn shipped() -> Result<Self, Error> {
        Ok(Self {
            effects: effects::shipped().map_err(wrong)?,
            warnings: Vec::new(),
        })
    }

    /// Leaves a kind out.
    pub fn without(mut self, kind: &str) -> Result<Self, Error> {
        let before = self.effects.len();
        self.effects.retain(|effect| effect.name != kind);
        if self.effects.len() < before {
            return Ok(self);
        }
        let mut kinds: Vec<&str> = self.effects.iter().map(|e| e.name.as_str()).collect();
        kinds.dedup();
        Err(Error::Usage(format!(
            "`--without {kind}`: the library has {}",
            kinds.join(", ")
        )))
    }

    /// Adds effects of a user's own. One with the name of a shipped effect takes its place.
    pub fn with(mut self, paths: &[PathBuf]) -> Result<Self, Error> {
        let mut own = Vec::new();
        for path in paths {
            let text = files::read(path, appell_spec::limits::MAX_FILE as u64)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let file = path.to_string_lossy();
            let effect = Effect::read(&name, &file, &text).map_err(wrong)?;
            if self
                .effects
                .iter()
                .any(|shipped| shipped.name == effect.name)
            {
                self.warnings.push(format!(
                    "warning: {file}: the effect `{}` stands in place of that of the library",
                    effect.name
                ));
            }
            own.push(effect);
        }
        self.effects.retain(|shipped| {
            own.iter()
                .all(|effect: &Effect| effect.name != shipped.name)
        });
        self.effects.append(&mut own);
        Ok(self)
    }

    /// Diagnoses a data set; `stage` hears what is being done.
    pub fn diagnose(
        &self,
        set: &DataSet,
        options: &Options,
        stage: impl FnMut(&'static str),
    ) -> Result<Report, Error> {
        recording::refuse_slow(set)?;
        diagnose::diagnose(set, &self.effects, options, stage).map_err(diagnosis)
    }
}

fn wrong(EffectError(report): EffectError) -> Error {
    Error::Report(report)
}

fn diagnosis(error: DiagnoseError) -> Error {
    match error {
        DiagnoseError::Model(
            ModelError::Spec(report) | ModelError::Effect(EffectError(report)),
        ) => Error::Report(report),
        DiagnoseError::Data(error) => error.into(),
        DiagnoseError::NothingMeasured
        | DiagnoseError::LacksChannel { .. }
        | DiagnoseError::NothingToFit
        | DiagnoseError::Model(ModelError::Edit(_)) => Error::Data(error.to_string()),
        other => Error::Computation(other.to_string()),
    }
}

/// The failure of an identification.
pub(crate) fn identification(error: &IdentifyError) -> Error {
    match error {
        IdentifyError::UnknownParameter { .. }
        | IdentifyError::UnknownAddition { .. }
        | IdentifyError::Rate { .. } => Error::Usage(error.to_string()),
        IdentifyError::Estimate(EstimateError::Diverged { .. } | EstimateError::Stuck { .. }) => {
            Error::Computation(format!(
                "{error}; where the values of the rig are far off, `--start shooting` may help"
            ))
        }
        IdentifyError::Estimate(_) => Error::Computation(error.to_string()),
        _ => Error::Data(error.to_string()),
    }
}
