//! Functions of a model over arrays in the memory of a graphics card.

use std::sync::Arc;

use appell::card::{self, Memory, Places};
use appell::derivation::FunctionKind;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::Raise as _;
use crate::model::Model;
use crate::watched::watched;

/// The functions of a model, compiled for a card.
#[pyclass(frozen)]
pub(crate) struct OnCard(Arc<card::OnCard>);

/// Numbers in the memory of a card.
#[pyclass(frozen)]
pub(crate) struct CardMemory(Memory);

/// A function: its name, the width of its additional argument, names and shapes of its results.
type Told = (String, Option<usize>, Vec<(String, Vec<usize>)>);

fn function(name: &str) -> PyResult<FunctionKind> {
    let found = FunctionKind::ALL
        .into_iter()
        .find(|kind| kind.name() == name);
    found.ok_or_else(|| PyValueError::new_err(format!("there is no function `{name}`")))
}

#[pymethods]
impl OnCard {
    #[new]
    fn new(py: Python<'_>, model: &Model, functions: Vec<String>) -> PyResult<Self> {
        let kinds = functions.iter().map(|name| function(name));
        let kinds = kinds.collect::<PyResult<Vec<_>>>()?;
        let model = Arc::clone(&model.inner);
        let made = watched(py, None, move |_| card::OnCard::new(model.source(), &kinds))?;
        Ok(Self(Arc::new(made)))
    }

    /// Its functions.
    fn functions(&self) -> Vec<Told> {
        let told = self.0.functions().map(|kernel| {
            let name = kernel.function.name().to_owned();
            (name, kernel.own, kernel.results.clone())
        });
        told.collect()
    }

    /// A copy of numbers in the memory of the card.
    fn copy(&self, py: Python<'_>, numbers: PyReadonlyArray1<'_, f64>) -> PyResult<CardMemory> {
        let copied = self.0.copy(numbers.as_slice()?);
        Ok(CardMemory(copied.raise(py)?))
    }

    /// The results of a function at so many places; arrays are addresses in the memory of the card: p with whether each
    /// place has its own, x, u, and the additional argument.
    #[expect(clippy::too_many_arguments, reason = "the arguments of the equations")]
    fn call(
        &self,
        py: Python<'_>,
        name: &str,
        count: usize,
        t: f64,
        p: u64,
        each: bool,
        x: u64,
        u: u64,
        own: Option<u64>,
    ) -> PyResult<Vec<CardMemory>> {
        let function = function(name)?;
        let places = Places {
            count,
            t,
            parameters: p,
            each,
            states: x,
            inputs: u,
            own,
        };
        let results = py.detach(|| self.0.call(function, &places));
        Ok(results.raise(py)?.into_iter().map(CardMemory).collect())
    }
}

#[pymethods]
impl CardMemory {
    /// The address in the memory of the card.
    #[getter]
    fn address(&self) -> u64 {
        self.0.address()
    }

    /// A copy.
    fn read<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let read = py
            .detach(|| self.0.read())
            .map_err(appell::Error::computation);
        Ok(PyArray1::from_vec(py, read.raise(py)?))
    }
}
