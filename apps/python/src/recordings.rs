//! Recordings, identification and diagnosis.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use appell::diagnosis::{Library, Options, Report};
use appell::engine::Engine;
use appell::gap_report::GapReport;
use appell::identification::{Answer, Begin};
use appell::recording::Frame;
use appell::{Source, identification};
use appell_report::identification as identified;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{Raise, exception};
use crate::watched::watched;

/// Recordings of a mechanism.
#[pyclass(subclass, frozen)]
pub(crate) struct DataSet(Arc<appell::DataSet>);

/// Estimated parameters.
#[pyclass(frozen)]
pub(crate) struct Identified {
    set: Arc<appell::DataSet>,
    answer: Answer,
}

/// A diagnosed gap.
#[pyclass(frozen)]
pub(crate) struct Gap {
    set: Arc<appell::DataSet>,
    report: Report,
    /// Shipped effects that were replaced, and warnings about the data.
    findings: Vec<String>,
}

impl DataSet {
    /// The recordings, for another thread.
    pub(crate) fn shared(&self) -> Arc<appell::DataSet> {
        Arc::clone(&self.0)
    }
}

type Numbers<'py> = Bound<'py, PyArray1<f64>>;
/// The name of a run, and its columns by name.
type NamedColumns<'py> = (String, Vec<(String, PyReadonlyArray1<'py, f64>)>);

fn frame((name, columns): NamedColumns<'_>) -> Frame {
    let (columns, values) = columns
        .iter()
        .map(|(name, values)| (name.clone(), values.as_array().to_vec()))
        .unzip();
    Frame {
        name,
        columns,
        values,
    }
}

type Progress<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

#[pymethods]
impl DataSet {
    /// A folder with a `recording.toml`, or CSV files of a mechanism, which is a shipped name or the path of a spec.
    /// With `frames`, names of runs with their columns, those; their description is the path and the text of a
    /// `recording.toml`.
    #[new]
    #[pyo3(signature = (paths, model = None, frames = None, description = None))]
    fn new(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        model: Option<String>,
        frames: Option<Vec<NamedColumns<'_>>>,
        description: Option<(PathBuf, String)>,
    ) -> PyResult<Self> {
        let frames = frames.map(|frames| frames.into_iter().map(frame).collect::<Vec<_>>());
        let set = watched(py, None, move |_| match &frames {
            None => appell::recording::read(&paths, model.as_deref()),
            Some(frames) => {
                let described = description.as_ref();
                let described = described.map(|(path, text)| (path.as_path(), text.as_str()));
                appell::recording::read_frames(frames, described, model.as_deref())
            }
        })?;
        Ok(Self(Arc::new(set)))
    }

    /// The drafted text of a `recording.toml` at a path, and what the recordings do not tell.
    #[staticmethod]
    fn _draft(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        frames: Option<Vec<NamedColumns<'_>>>,
        model: String,
        path: PathBuf,
        rate_hz: Option<f64>,
    ) -> PyResult<(String, Vec<String>)> {
        let frames = frames.map(|frames| frames.into_iter().map(frame).collect::<Vec<_>>());
        let drafted = watched(py, None, move |_| match &frames {
            None => appell::recording::draft(&model, &paths, &path, rate_hz),
            Some(frames) => appell::recording::draft_frames(&model, frames, &path, rate_hz),
        })?;
        Ok((drafted.text, drafted.questions))
    }

    /// Runs, channels, noise and findings as JSON.
    fn json(&self) -> String {
        appell::json::recording(&self.0).to_string()
    }

    /// Warnings that may affect conclusions.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        appell::recording::warnings(&self.0)
    }

    /// The file of the mechanism.
    fn _file(&self) -> &str {
        &self.0.spec.file
    }

    #[pyo3(signature = (free, also, drifting, shooting, progress))]
    fn _identify(
        &self,
        py: Python<'_>,
        free: Option<Vec<String>>,
        also: Vec<String>,
        drifting: Vec<(String, f64)>,
        shooting: bool,
        progress: Progress<'_, '_>,
    ) -> PyResult<Identified> {
        let set = Arc::clone(&self.0);
        let options = identification::Options {
            free,
            additional: also,
            drifting,
            allow_none: false,
            begin: if shooting {
                Begin::Shooting
            } else {
                Begin::Nominal
            },
            rough: false,
        };
        let answer = watched(py, progress, move |watch| {
            let model = appell::Model::of(appell::recording::source(&set), Some(Engine::Jit))?;
            model.identify(&set, &options, |stage| watch.stage(stage))
        })?;
        Ok(Identified {
            set: Arc::clone(&self.0),
            answer,
        })
    }

    #[pyo3(signature = (effects, without, horizon, tolerance, limits, alternatives, against, progress))]
    #[expect(clippy::too_many_arguments, reason = "called by name from Python")]
    fn _diagnose(
        &self,
        py: Python<'_>,
        effects: Vec<PathBuf>,
        without: Vec<String>,
        horizon: Option<f64>,
        tolerance: Option<f64>,
        limits: Vec<(String, [f64; 2])>,
        alternatives: Vec<String>,
        against: Option<&Self>,
        progress: Progress<'_, '_>,
    ) -> PyResult<Gap> {
        if horizon.is_some_and(|horizon| !(horizon.is_finite() && horizon > 0.0)) {
            return Err(PyValueError::new_err(
                "horizon is a positive number of seconds",
            ));
        }
        if tolerance.is_some_and(|part| !(0.0..1.0).contains(&part)) {
            return Err(PyValueError::new_err(
                "tolerance is a part of one, such as 0.02",
            ));
        }
        let set = Arc::clone(&self.0);
        let before = against.map(|before| Arc::clone(&before.0));
        watched(py, progress, move |watch| {
            let library = Library::of(&without, &effects)?;
            let options = Options {
                pictures: true,
                limits,
                alternatives: appell::recording::specs(&alternatives)?,
                horizon,
                tolerance,
                present: Vec::new(),
            };
            let stage = |stage| watch.stage(stage);
            let report = library.diagnose(before.as_deref(), &set, &options, stage)?;
            let findings = [library.warnings, appell::recording::warnings(&set)].concat();
            Ok(Gap {
                set,
                report,
                findings,
            })
        })
    }

    /// Times in s and a column for each channel, in SI, of a run.
    fn _run<'py>(&self, py: Python<'py>, name: &str) -> Option<(Numbers<'py>, Vec<Numbers<'py>>)> {
        let mut runs = self.0.runs.iter();
        let run = runs.find(|run| run.name == name)?;
        let columns = run.values.iter();
        let columns = columns.map(|values| PyArray1::from_slice(py, values));
        Some((PyArray1::from_slice(py, &run.times), columns.collect()))
    }

    /// The scale of a channel's unit.
    fn _scale(&self, column: &str) -> Option<f64> {
        let mut channels = self.0.channels.iter();
        let channel = channels.find(|channel| channel.column == column)?;
        Some(channel.unit.scale)
    }
}

#[pymethods]
impl Identified {
    fn json(&self) -> String {
        appell::json::identification(&self.set, &self.answer).to_string()
    }

    fn text(&self) -> String {
        identified::text(&self.set, &self.answer)
    }

    fn page(&self) -> String {
        identified::page(&self.set, &self.answer)
    }

    fn figure(&self) -> String {
        identified::figure(&self.set, &self.answer).to_svg()
    }
}

#[pymethods]
impl Gap {
    /// The gap report as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        let report = appell::json::diagnosis(&self.report, None, &self.findings);
        let report = appell::json::in_names_of(&self.set, report);
        let text = serde_json::to_string_pretty(&report);
        text.map(|text| text + "\n")
            .map_err(|error| exception(py, &error.into()))
    }

    /// The diagnosis in one sentence.
    fn sentence(&self) -> String {
        let sentence = appell_report::gap::sentence(&self.report);
        self.set.named(&sentence).into_owned()
    }

    fn page(&self) -> String {
        appell::diagnosis::page(&self.set, &self.report)
    }

    /// The inputs proposed for the next experiment, as CSV.
    fn experiment(&self) -> Option<String> {
        let experiment = self.report.experiment.as_ref()?;
        Some(appell::diagnosis::experiment_inputs(&self.set, experiment))
    }

    /// The robot file that was diagnosed, if it is one.
    fn _robot(&self) -> Option<&str> {
        Some(&self.set.robot.as_ref()?.file)
    }

    /// Text and file of the diagnosed spec.
    fn _spec(&self) -> (&str, &str) {
        (&self.set.spec.file, &self.set.spec.text)
    }
}

/// The spec with a hypothesis of a gap report applied, and a summary of the changes.
#[pyfunction]
#[pyo3(signature = (spec, text, report, hypothesis, out))]
pub(crate) fn apply(
    py: Python<'_>,
    spec: String,
    text: String,
    report: &str,
    hypothesis: Option<usize>,
    out: &str,
) -> PyResult<(String, String)> {
    let source = Source::of(spec, text);
    let report = GapReport::parse("gap report", report).raise(py)?;
    let improved = source.improved(&report, hypothesis, out).raise(py)?;
    let summary = improved.summary(out);
    Ok((improved.text, summary))
}

/// Writes a folder with recordings of a simulated rig; the names of the files.
#[pyfunction]
pub(crate) fn sample(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<&'static str>> {
    let folder: &Path = &folder;
    appell::sample::rig(folder).raise(py)
}
