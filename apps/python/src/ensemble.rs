//! Ensembles: a study, its chunks and the statistics of their rows.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use appell::ensemble::{self, Chunk, Ensemble, Folder, Memory, Running, Shard, Store, Watch};
use appell::{Error, json};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::Raise;
use crate::watched::watched;

/// A compiled study, and the store of its rows.
#[pyclass(frozen)]
pub(crate) struct Study {
    ensemble: Arc<Ensemble>,
    store: Arc<dyn Store>,
}

/// A column: name, about, unit, scale; of a course its name and the time.
type Told = (String, String, String, f64, Option<(String, f64)>);
type Numbers<'py> = Bound<'py, PyArray1<f64>>;

fn running(jobs: Option<usize>, shard: Option<&str>, chunk: Option<u64>) -> PyResult<Running> {
    let shard = shard.map(str::parse::<Shard>).transpose();
    Ok(Running {
        jobs,
        shard: shard.map_err(PyValueError::new_err)?,
        chunk,
    })
}

fn names(chunks: Vec<Chunk>) -> impl Iterator<Item = String> {
    chunks.into_iter().map(|chunk| chunk.name)
}

#[pymethods]
impl Study {
    /// A study file, or its text with the folder that has the files it names. Without `out` rows stay in memory.
    #[new]
    #[pyo3(signature = (study, folder, out, on_card))]
    fn new(
        py: Python<'_>,
        study: String,
        folder: Option<PathBuf>,
        out: Option<PathBuf>,
        on_card: bool,
    ) -> PyResult<Self> {
        let ensemble = watched(py, None, move |_| {
            let ensemble = match folder {
                Some(folder) => Ensemble::parse("study.toml", &study, &folder),
                None => Ensemble::from_file(Path::new(&study)),
            }?;
            if on_card {
                ensemble.on_card()
            } else {
                Ok(ensemble)
            }
        })?;
        let store: Arc<dyn Store> = match out {
            Some(out) => Arc::new(Folder::new(&out).map_err(Error::computation).raise(py)?),
            None => Arc::new(Memory::default()),
        };
        Ok(Self {
            ensemble: Arc::new(ensemble),
            store,
        })
    }

    /// The CUDA sources of its motions.
    fn cuda(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.ensemble.cuda().raise(py)
    }

    /// Number of cases.
    #[getter]
    fn cases(&self) -> u64 {
        self.ensemble.design().cases()
    }

    /// Names of all chunks.
    #[pyo3(signature = (chunk = None))]
    fn chunks(&self, py: Python<'_>, chunk: Option<u64>) -> PyResult<Vec<String>> {
        let all = self.ensemble.chunks(chunk).raise(py)?;
        let replicates = self.ensemble.replicates();
        let chunks = (0..all.count()).map(|number| all.chunk(number));
        let rare = replicates
            .iter()
            .flat_map(|all| (0..all.count()).map(|n| all.chunk(n)));
        Ok(names(chunks.chain(rare).collect()).collect())
    }

    /// Names of the missing chunks.
    #[pyo3(signature = (shard = None, chunk = None))]
    fn missing(
        &self,
        py: Python<'_>,
        shard: Option<&str>,
        chunk: Option<u64>,
    ) -> PyResult<Vec<String>> {
        let running = running(None, shard, chunk)?;
        let store = self.store.as_ref();
        let cases = self.ensemble.missing(store, running).raise(py)?;
        let replicates = self.ensemble.missing_replicates(store, running).raise(py)?;
        Ok(names(cases.chunks)
            .chain(names(replicates.chunks))
            .collect())
    }

    /// Runs chunks by their names, or the missing ones.
    #[pyo3(signature = (chunks = None, jobs = None, shard = None, chunk = None, progress = None))]
    fn run(
        &self,
        py: Python<'_>,
        chunks: Option<Vec<String>>,
        jobs: Option<usize>,
        shard: Option<&str>,
        chunk: Option<u64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let running = running(jobs, shard, chunk)?;
        let (ensemble, store) = (Arc::clone(&self.ensemble), Arc::clone(&self.store));
        watched(py, progress, move |told| {
            let store = store.as_ref();
            let [cases, replicates] = match chunks {
                Some(names) => ensemble.named(&names)?,
                None => [
                    ensemble.missing(store, running)?.chunks,
                    ensemble.missing_replicates(store, running)?.chunks,
                ],
            };
            let watch = Watch {
                go_on: &|| told.goes_on(),
                done: &|_| {},
            };
            told.stage("cases");
            ensemble.fill(store, &cases, running, watch)?;
            if !replicates.is_empty() {
                told.stage("rare event");
                ensemble.fill_replicates(store, &replicates, running, watch)?;
            }
            Ok(())
        })
    }

    /// Numbers of the cases, the columns in SI, when the motions ended, and why they did early.
    fn rows<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Numbers<'py>, Vec<Numbers<'py>>, Numbers<'py>, Vec<String>)> {
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); self.ensemble.columns().len()];
        let (mut cases, mut ends, mut reasons) = (Vec::new(), Vec::new(), Vec::new());
        let read = py.detach(|| {
            self.ensemble.scan(self.store.as_ref(), |rows| {
                for (all, own) in values.iter_mut().zip(&rows.values) {
                    all.extend_from_slice(own);
                }
                cases.extend((rows.first..).take(rows.len()).map(|case| case as f64));
                ends.extend_from_slice(&rows.ends);
                reasons.extend_from_slice(&rows.reasons);
            })
        });
        read.raise(py)?;
        let array = |list| PyArray1::from_vec(py, list);
        let columns = values.into_iter().map(array).collect();
        Ok((array(cases), columns, array(ends), reasons))
    }

    /// Name, meaning, unit and scale of the columns; of courses also their name and time.
    fn columns(&self) -> Vec<Told> {
        let columns = self.ensemble.columns().iter();
        columns
            .map(|column| {
                let course = match &column.role {
                    ensemble::Role::Course { of, t } => Some((of.clone(), *t)),
                    _ => None,
                };
                let [name, about, unit] = [&column.name, &column.about, &column.unit];
                (
                    name.clone(),
                    about.clone(),
                    unit.clone(),
                    column.scale,
                    course,
                )
            })
            .collect()
    }

    /// The statistics as JSON, as text, and as a page.
    fn summary(&self, py: Python<'_>) -> PyResult<(String, String, String)> {
        let summary = py.detach(|| self.ensemble.summary(self.store.as_ref()));
        let summary = summary.raise(py)?;
        let about = self.ensemble.about(&summary);
        let fields = json::ensemble(self.ensemble.columns(), &summary).to_string();
        Ok((fields, ensemble::text(&about), ensemble::page(&about)))
    }
}
