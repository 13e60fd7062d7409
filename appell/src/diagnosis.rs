//! Diagnosis of recordings: the library of effects, and a user's own.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use appell_gap::diagnose;
use appell_gap::effects;
use appell_recordings::DataSet;

pub use appell_gap::diagnose::{
    Changes, DiagnoseError, Experiment, ForceHistory, ForceLaw, Found, GapVerdict, HowFar,
    Hypothesis, Limit, Options, Refitted, Report, SignalEffect, Where, Window,
};
pub use appell_gap::effects::{Effect, EffectError, ModelError};

use crate::difference::unified;
use crate::gap_report::{self, GapReport};
use crate::json::in_names_of;
use crate::{Error, Field, correction, files, recording};

/// The page of a gap report, with the lines of the spec or the robot file that change.
pub fn page(set: &DataSet, report: &Report) -> String {
    // A page without them if there is nothing to write, or the file is gone.
    let lines = changed_lines(set, report).unwrap_or_default();
    let page = appell_report::gap::page(set, report, &lines);
    set.named(&page).into_owned()
}

/// What `apply` changes by the leading hypothesis, as a difference.
fn changed_lines(set: &DataSet, report: &Report) -> Result<String, Error> {
    let json = in_names_of(set, gap_report::json(report, None, &[]));
    let report = GapReport::parse("the report", &json.to_string())?;
    let (file, before, after) = if let Some(robot) = &set.robot {
        let text = files::read(Path::new(&robot.file), appell_robots::MAX_FILE)?;
        let better = correction::correct(Path::new(&robot.file), &text, &report, None)?;
        (&robot.file, text, better.text)
    } else {
        let source = recording::source(set);
        let better = source.improved(&report, None, &source.file)?.text;
        (&set.spec.file, source.text, better)
    };
    Ok(unified(file, file, &before, &after))
}

/// A library of effects.
#[derive(Debug)]
pub struct Library {
    effects: Vec<Effect>,
    /// Warnings: shipped effects that are replaced by the user's own.
    pub warnings: Vec<String>,
}

impl Library {
    /// The shipped effects.
    pub fn shipped() -> Result<Self, Error> {
        Self::of(&[], &[])
    }

    /// The shipped effects without some kinds, and with a user's own. An effect with the name of a shipped one replaces it.
    pub fn of(without: &[String], paths: &[PathBuf]) -> Result<Self, Error> {
        let mut effects = effects::shipped()?;
        for kind in without {
            let before = effects.len();
            effects.retain(|effect| effect.name != *kind);
            if effects.len() == before {
                let mut kinds: Vec<&str> = effects.iter().map(|e| e.name.as_str()).collect();
                kinds.dedup();
                let kinds = kinds.join(", ");
                let message = format!("there is no effect `{kind}`; the library has {kinds}");
                return Err(Error::request(Field::Effects, message));
            }
        }
        let (mut own, mut warnings) = (Vec::<Effect>::new(), Vec::new());
        for path in paths {
            let text = files::read(path, appell_spec::limits::MAX_FILE as u64)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let file = path.to_string_lossy();
            let effect = Effect::read(&name, &file, &text)?;
            let name = &effect.name;
            if effects.iter().any(|shipped| shipped.name == *name) {
                warnings.push(format!("{file}: effect `{name}` replaces the shipped one"));
            }
            if own.iter().any(|other| other.name == *name) {
                let message = format!("{file}: the effect `{name}` is given twice");
                return Err(Error::request(Field::Effects, message));
            }
            own.push(effect);
        }
        effects.retain(|shipped| own.iter().all(|effect| effect.name != shipped.name));
        effects.append(&mut own);
        Ok(Self { effects, warnings })
    }

    /// All that its effects say.
    pub(crate) fn fingerprint(&self) -> String {
        let texts = self.effects.iter().map(Effect::text);
        texts.collect::<Vec<_>>().join("\n")
    }

    /// Diagnoses a data set, or judges it against recordings of the same rig before; `stage` is called with the name of each
    /// step.
    pub fn diagnose(
        &self,
        before: Option<&DataSet>,
        set: &DataSet,
        options: &Options,
        stage: impl FnMut(&'static str),
    ) -> Result<Report, Error> {
        let effects = &self.effects;
        before.map_or(Ok(()), recording::check)?;
        recording::check(set)?;
        Ok(match before {
            Some(before) => diagnose::against(before, set, effects, options, stage)?,
            None => diagnose::diagnose(set, effects, options, stage)?,
        })
    }
}

/// The inputs of an experiment in the units of the spec, as a [`Motion`](crate::Motion) reads recorded
/// inputs.
pub fn experiment_inputs(set: &DataSet, experiment: &Experiment) -> String {
    let mut text = "t".to_owned();
    let mut units = Vec::new();
    for (name, _) in &experiment.inputs {
        let _ = write!(text, ",{name}");
        let mut inputs = set.mechanism.inputs.iter();
        units.push(
            inputs
                .find(|input| input.label.name == *name)
                .map(|input| &input.label.unit),
        );
    }
    text.push('\n');
    for (row, t) in experiment.times.iter().enumerate() {
        // Times are multiples of a step; round off the floating-point error.
        let _ = write!(text, "{}", (t * 1e9).round() / 1e9);
        for ((_, values), unit) in experiment.inputs.iter().zip(&units) {
            let value = unit.map_or(values[row], |unit| unit.from_si(values[row]));
            let _ = write!(text, ",{value:.6e}");
        }
        text.push('\n');
    }
    text
}
