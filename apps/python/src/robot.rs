//! Robot files as specs.

use std::path::PathBuf;
use std::str::FromStr;

use appell::gap_report::GapReport;
use appell::robot::{self, Letters, Lock, Options, Without};
use appell::{correction, files};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::Raise;
use crate::watched::watched;

/// The text of a robot file with a hypothesis of a gap report, and a summary of the changes.
#[pyfunction]
#[pyo3(signature = (file, report, hypothesis))]
pub(crate) fn corrected_robot(
    py: Python<'_>,
    file: PathBuf,
    report: &str,
    hypothesis: Option<usize>,
) -> PyResult<(String, String)> {
    let text = files::read(&file, files::MAX_DATA).raise(py)?;
    let report = GapReport::parse("gap report", report).raise(py)?;
    let better = correction::correct(&file, &text, &report, hypothesis).raise(py)?;
    Ok((better.text, better.lines))
}

/// The spec of a robot file, and a report of the import as JSON.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "called from Python alone")]
pub(crate) fn import_robot(
    py: Python<'_>,
    file: PathBuf,
    parameters: &str,
    without: Vec<String>,
    lock: Vec<(String, Option<f64>)>,
    snap: bool,
    floating: bool,
    actuators: bool,
    root: Option<PathBuf>,
) -> PyResult<(String, String)> {
    let without = without.iter().map(|word| Without::from_str(word));
    let options = Options {
        letters: Letters::read(parameters),
        without: without
            .collect::<Result<_, _>>()
            .map_err(PyValueError::new_err)?,
        lock: lock
            .into_iter()
            .map(|(joint, value)| Lock { joint, value })
            .collect(),
        snap,
        floating,
        actuators,
        ..Options::default()
    };
    let name = file.to_string_lossy().into_owned();
    let robot = watched(py, None, move |_| {
        robot::read(&file, root.as_deref(), &options)
    })?;
    Ok((
        robot.spec.clone(),
        appell::json::robot(&name, &robot).to_string(),
    ))
}

/// Writes a folder with a robot arm as URDF and as MJCF; the names of the files.
#[pyfunction]
pub(crate) fn sample_robot(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<&'static str>> {
    appell::sample::robot(&folder).raise(py)
}
