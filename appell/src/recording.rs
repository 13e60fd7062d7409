//! Recordings: reading, and warnings about the data.

use std::path::{Path, PathBuf};

use appell_gap::units;
use appell_models::ALL;
pub use appell_recordings::{
    Channel, DataError, DataSet, Drafted, Finding, FindingKind, Frame, Measured, Parameter, Part,
    Role, Run, Spec,
};
use appell_recordings::{Draft, Logged, MANIFEST};
use appell_report::recording::sentences;
use appell_report::text::number;
use appell_spec::Severity;

use crate::engine::Equations;
use crate::source::Source;
use crate::{Error, Field};

/// Reads a data set, or CSV files of a mechanism.
pub fn read(paths: &[PathBuf], model: Option<&str>) -> Result<DataSet, Error> {
    read_with(paths, model.map(Source::find).transpose()?.as_ref())
}

/// Recordings in memory. Without a description, the text of a `recording.toml` with its path, columns have the names
/// and units of the mechanism.
pub fn read_frames(
    frames: &[Frame],
    description: Option<(&Path, &str)>,
    model: Option<&str>,
) -> Result<DataSet, Error> {
    let spec = model.map(Source::find).transpose()?;
    let spec = spec.as_ref().map(Spec::from);
    with_doubts(match (description, spec) {
        (Some((file, text)), spec) => {
            appell_recordings::read_frames(file, text, frames, &library(), spec)?
        }
        (None, Some(spec)) => appell_recordings::read_bare_frames(spec, frames)?,
        (None, None) => return Err(Error::request(Field::Recordings, UNNAMED)),
    })
}

/// Remedy for columns without a description.
const UNNAMED: &str = "CSV files and data frames need the mechanism whose names their columns have; name a shipped one \
                       or a spec";

/// Drafts the description `path` of recordings of a mechanism: a shipped name, or the path of a spec or a robot file.
/// Recordings without a column of the times need the rate of their rows.
pub fn draft(
    mechanism: &str,
    runs: &[PathBuf],
    path: &Path,
    rate_hz: Option<f64>,
) -> Result<Drafted, Error> {
    let runs = runs
        .iter()
        .map(|run| Ok((beside(path, run)?, Logged::File(run.clone()))));
    drafted(
        mechanism,
        &runs.collect::<Result<Vec<_>, Error>>()?,
        path,
        rate_hz,
    )
}

/// The same of recordings in memory.
pub fn draft_frames(
    mechanism: &str,
    frames: &[Frame],
    path: &Path,
    rate_hz: Option<f64>,
) -> Result<Drafted, Error> {
    let runs = frames
        .iter()
        .map(|frame| (frame.name.clone(), Logged::Frame(frame)));
    drafted(mechanism, &runs.collect::<Vec<_>>(), path, rate_hz)
}

fn drafted(
    mechanism: &str,
    runs: &[(String, Logged<'_>)],
    path: &Path,
    rate_hz: Option<f64>,
) -> Result<Drafted, Error> {
    if runs.is_empty() {
        let message = "a draft needs the mechanism and its recordings";
        return Err(Error::request(Field::Recordings, message));
    }
    if let Some(rate) = rate_hz.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
        let message = format!("{rate} rows per second are no rate");
        return Err(Error::request(Field::Recordings, message));
    }
    if is_recording(Path::new(mechanism)) {
        let message =
            format!("`{mechanism}` is a recording: the spec or the robot file comes first");
        return Err(Error::request(Field::Recordings, message));
    }
    let source = Source::find(mechanism)?;
    let named = match source.shipped {
        Some(shipped) => shipped.name.to_owned(),
        None => beside(path, Path::new(mechanism))?,
    };
    let draft = Draft {
        mechanism: Spec::from(&source),
        named,
        runs,
        rate_hz,
    };
    let mut drafted = draft.write(path)?;
    if let Some(set) = drafted.set.take() {
        let set = with_doubts(set)?;
        let doubtful =
            |finding: &&Finding| matches!(finding.kind, FindingKind::Unit | FindingKind::Sign);
        let doubts = sentences(set.findings.iter().filter(doubtful));
        drafted.questions.extend(doubts);
        drafted.set = Some(set);
    }
    Ok(drafted)
}

/// Whether a file is a recording, by its extension.
pub fn is_recording(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ["csv", "c3d", "mcap", "npz", "parquet", "tsv"]
        .iter()
        .any(|own| extension == *own)
}

/// The path of a file relative to the folder of a description, which has to contain it.
fn beside(description: &Path, file: &Path) -> Result<String, Error> {
    let missing = |path: &Path| {
        let message = format!("there is no folder or file `{}`", path.display());
        Error::request(Field::Recordings, message)
    };
    let folder = match description.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().map_err(|_| missing(folder))?;
    let absolute = file.canonicalize().map_err(|_| missing(file))?;
    let inside = absolute.strip_prefix(&folder).map_err(|_| {
        let message = format!(
            "`{}` is not in the folder of the description `{}`, which may only name files beside and below it",
            file.display(),
            description.display()
        );
        Error::request(Field::Recordings, message)
    })?;
    Ok(inside.to_string_lossy().replace('\\', "/"))
}

/// The shipped mechanisms.
fn library() -> Vec<(&'static str, Spec)> {
    let shipped = ALL.iter().map(|shipped| {
        let (file, text) = (shipped.file.to_owned(), shipped.spec.to_owned());
        (shipped.name, Spec { file, text })
    });
    shipped.collect()
}

/// Recordings of a mechanism: a folder with a `recording.toml`, or CSV files.
pub(crate) fn read_with(paths: &[PathBuf], source: Option<&Source>) -> Result<DataSet, Error> {
    if let Some(path) = paths.iter().find(|path| !path.exists()) {
        let message = format!("there is no folder or file `{}`", path.display());
        return Err(Error::request(Field::Recordings, message));
    }
    let described = |path: &PathBuf| path.is_dir() || path.ends_with(MANIFEST);
    match (paths, source) {
        ([folder], source) if described(folder) => {
            let spec = source.map(Spec::from);
            with_doubts(appell_recordings::read(folder, &library(), spec)?)
        }
        (paths, _) if paths.iter().any(described) => Err(Error::request(
            Field::Recordings,
            "give one data set, or CSV files and their mechanism",
        )),
        // Columns have the names of the spec, also of one that is made from a robot file.
        (paths, Some(source)) => {
            let (file, text) = (source.file.clone(), source.text.clone());
            with_doubts(appell_recordings::read_bare(Spec { file, text }, paths)?)
        }
        (_, None) => Err(Error::request(Field::Recordings, UNNAMED)),
    }
}

/// The spec of a data set.
pub fn source(set: &DataSet) -> Source {
    let mut shipped = ALL.iter();
    Source {
        shipped: shipped.find(|shipped| shipped.spec == set.spec.text),
        ..Source::of(&*set.spec.file, &*set.spec.text)
    }
}

/// The specs of models: shipped names, paths of specs or robot files.
pub fn specs(models: &[String]) -> Result<Vec<Spec>, Error> {
    let specs = models.iter();
    specs
        .map(|model| Ok(Spec::from(&Source::find(model)?)))
        .collect()
}

/// The data set with warnings about units.
fn with_doubts(mut set: DataSet) -> Result<DataSet, Error> {
    // With a wrong clock, motions do not reveal units.
    let is_slow = |finding: &Finding| finding.kind == FindingKind::SlowClock;
    if set.findings.iter().any(is_slow) {
        return Ok(set);
    }
    let equations = Equations::at_hand(&source(&set))?;
    for doubt in units::doubts(&set, equations.model()) {
        let kind = if doubt.is_sign {
            FindingKind::Sign
        } else {
            FindingKind::Unit
        };
        set.doubt(kind, &doubt.column, doubt.message);
    }
    Ok(set)
}

/// Rejects recordings unsuitable for a fit: of a mechanism at rest, or in doubtful units.
pub fn check(set: &DataSet) -> Result<(), Error> {
    let is_constant = |channel: &Channel| {
        let of_channel = |finding: &Finding| finding.channel.as_ref() == Some(&channel.column);
        let mut findings = set.findings.iter();
        findings.any(|finding| finding.kind == FindingKind::Constant && of_channel(finding))
    };
    let mut measured = (set.channels.iter())
        .filter(|channel| matches!(channel.role, Role::Measures(_)))
        .peekable();
    if let Some(first) = measured.peek().copied()
        && measured.all(is_constant)
    {
        let message = format!(
            "`{}` never changes, and nothing else is measured: recordings of a motion are needed",
            first.column
        );
        let run = set.runs.first().map_or("", |run| &run.name);
        return Err(Error::data(run, message));
    }
    check_rows(set)?;
    check_units(set)
}

/// Refuses runs that are too short for any estimate.
fn check_rows(set: &DataSet) -> Result<(), Error> {
    let mut findings = set.findings.iter();
    let short = findings.find(|finding| finding.kind == FindingKind::FewRows);
    short.map_or(Ok(()), |finding| {
        let run = finding.run.as_deref().unwrap_or_default();
        Err(Error::data(run, &finding.message))
    })
}

/// Rejects times that are probably not in seconds, and channels whose unit contradicts the motion.
pub fn check_units(set: &DataSet) -> Result<(), Error> {
    let doubted = |finding: &&Finding| finding.kind == FindingKind::Unit;
    let slow = |finding: &&Finding| finding.kind == FindingKind::SlowClock;
    let Some(first) = set.findings.iter().find(slow) else {
        return match set.findings.iter().find(doubted) {
            Some(finding) => Err(doubt(set, finding)),
            None => Ok(()),
        };
    };
    let mut runs = set.runs.iter();
    let run = runs.find(|run| first.run.as_ref() == Some(&run.name));
    let seconds = run.map_or(0.0, Run::duration);
    let message = format!(
        "{}: the run lasts {} s, with {}",
        first.channel.as_deref().unwrap_or_default(),
        number(seconds),
        first.message
    );
    Err(Error::data(
        first.run.as_deref().unwrap_or_default(),
        message,
    ))
}

/// The doubt, at the position of the stated unit.
fn doubt(set: &DataSet, finding: &Finding) -> Error {
    let column = finding.channel.as_deref().unwrap_or_default();
    let mut channels = set.channels.iter();
    let channel = channels.find(|channel| channel.column == column);
    let place = channel.and_then(|channel| channel.unit_at.as_ref());
    let place = match (place, set.runs.first()) {
        (Some((file, line, at)), _) => format!("{file}:{line}:{at}"),
        (None, Some(run)) => run.name.clone(),
        (None, None) => String::new(),
    };
    Error::data(&place, format!("{column}: {}", finding.message))
}

/// Warnings about the data that may affect the conclusions, one sentence each.
pub fn warnings(set: &DataSet) -> Vec<String> {
    let findings = set.findings.iter();
    // The interpolation of an input affects the diagnosis.
    let grave = findings.filter(|finding| {
        finding.kind.severity() == Severity::Warning || finding.kind == FindingKind::SmoothInput
    });
    sentences(grave)
}
