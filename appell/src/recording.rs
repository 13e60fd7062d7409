//! Recordings: found, read, and what of them changes what can be concluded.

use std::path::PathBuf;

use appell_gap::data::{self, DataError, DataSet, Finding, FindingKind, Run, Spec};
use appell_models::ALL;
use appell_report::recording::sentence;
use appell_report::text::number;
use appell_spec::Severity;

use crate::Error;
use crate::source::Source;

/// Reads a data set, or CSV files of a mechanism.
pub fn read(paths: &[PathBuf], model: Option<&str>) -> Result<DataSet, Error> {
    let spec = model.map(Source::find).transpose()?.map(|source| Spec {
        file: source.file,
        text: source.text,
    });
    let described = |path: &PathBuf| path.is_dir() || path.ends_with(data::MANIFEST);
    match (paths, spec) {
        ([folder], spec) if described(folder) => {
            let shipped = ALL.iter().map(|shipped| {
                let (file, text) = (shipped.file.to_owned(), shipped.spec.to_owned());
                (shipped.name, Spec { file, text })
            });
            let library: Vec<(&str, Spec)> = shipped.collect();
            Ok(data::read(folder, &library, spec)?)
        }
        (paths, _) if paths.iter().any(described) => Err(Error::Usage(
            "give one data set, or CSV files and their mechanism".to_owned(),
        )),
        (paths, Some(spec)) => Ok(data::read_bare(spec, paths)?),
        (_, None) => Err(Error::Usage(
            "CSV files need the mechanism whose names their columns have; name a shipped one or a spec".to_owned(),
        )),
    }
}

/// Refuses times that are hardly in seconds: a filter would integrate for hours.
pub fn refuse_slow(set: &DataSet) -> Result<(), Error> {
    let slow = |finding: &&Finding| finding.kind == FindingKind::SlowClock;
    let Some(first) = set.findings.iter().find(slow) else {
        return Ok(());
    };
    let mut runs = set.runs.iter();
    let run = runs.find(|run| first.run.as_ref() == Some(&run.name));
    let seconds = run.map_or(0.0, Run::duration);
    Err(Error::Data(format!(
        "{}: {}: the run lasts {} s, with {}",
        first.run.as_deref().unwrap_or_default(),
        first.channel.as_deref().unwrap_or_default(),
        number(seconds),
        first.message
    )))
}

impl From<DataError> for Error {
    fn from(error: DataError) -> Self {
        match error {
            DataError::Report(report) => Self::Report(report),
            DataError::File { path, cause } => Self::reading(&path)(cause),
            DataError::Several(errors) => {
                Self::Several(errors.into_iter().map(Self::from).collect())
            }
            whole => Self::Data(whole.to_string()),
        }
    }
}

/// What of the recordings changes what can be concluded, a sentence each.
pub fn warnings(set: &DataSet) -> Vec<String> {
    let findings = set.findings.iter();
    let grave = findings.filter(|finding| finding.kind.severity() == Severity::Warning);
    grave.map(sentence).collect()
}
