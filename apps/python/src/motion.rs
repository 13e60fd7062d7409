//! Motions: requests and results.

use std::cell::Cell;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use appell::{
    CsvOptions, Driven, Extras, InputSource, Method, Motion, Remarks, TabulatedInputs, Trajectory,
};
use appell_report::figure::Figure;
use appell_runtime::Signal;
use appell_runtime::model::{Interpolation, SignalTable};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::Raise;
use crate::model::{Model, Values, assignments};
use crate::watched::awaited;

/// A motion with its model.
#[pyclass(frozen)]
pub(crate) struct Simulated {
    model: Arc<appell::Model>,
    simulated: appell::Simulated,
}

/// An input computed by Python. The first exception is kept; the motion ends there.
struct Callable {
    input: usize,
    function: Py<PyAny>,
    failed: Arc<Mutex<Option<PyErr>>>,
}

impl InputSource for Callable {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        u.fill(0.0);
        let value = Python::attach(|py| {
            let x = PyArray1::from_slice(py, x);
            self.function.bind(py).call1((t, x))?.extract::<f64>()
        });
        u[self.input] = value.unwrap_or_else(|error| {
            lock(&self.failed).get_or_insert(error);
            f64::NAN
        });
    }
}

fn lock<T>(value: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    // Each assignment is complete, even if a thread has panicked since.
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One input over time.
fn table(
    inputs: usize,
    input: usize,
    times: &[f64],
    values: &[f64],
    interpolation: Interpolation,
) -> Result<TabulatedInputs, appell::Error> {
    let signal = |one: usize| {
        let is_given = one == input;
        Signal::new(&SignalTable {
            name: format!("input {one}").into(),
            times: if is_given { times.to_vec() } else { vec![0.0] }.into(),
            values: if is_given { values.to_vec() } else { vec![0.0] }.into(),
            interpolation,
        })
    };
    let signals = (0..inputs).map(signal).collect::<Result<_, _>>()?;
    Ok(TabulatedInputs::new(signals))
}

/// The interpolation of that name.
fn interpolation(name: &str) -> PyResult<Interpolation> {
    match name {
        "hold" => Ok(Interpolation::Hold),
        "linear" => Ok(Interpolation::Linear),
        "cubic" => Ok(Interpolation::Cubic),
        other => {
            let message = format!("interpolation is `hold`, `linear` or `cubic`, not `{other}`");
            Err(PyValueError::new_err(message))
        }
    }
}

/// Adds columns by name.
fn recorded_too(all: &mut Extras, wanted: &[String]) -> PyResult<()> {
    for extra in wanted {
        let flag = match extra.as_str() {
            "reactions" => &mut all.reactions,
            "contacts" => &mut all.contacts,
            "conditions" => &mut all.conditions,
            "residuals" => &mut all.residuals,
            other => {
                let message = format!(
                    "record names reactions, contacts, conditions, residuals, not `{other}`"
                );
                return Err(PyValueError::new_err(message));
            }
        };
        *flag = true;
    }
    Ok(())
}

/// Integrates the equations of motion: one motion, or one for each row of `starts`. Of the inputs, texts are
/// expressions, pairs of arrays are tables, and the rest are functions of time and state.
#[pyfunction]
#[pyo3(signature = (model, t_end, *, starts, dt, parameters, initial, expressions, tables, functions, recorded, interpolated, laws, method, step, tolerances, max_steps, extras))]
#[expect(clippy::too_many_arguments, reason = "called by name from Python")]
pub(crate) fn simulate(
    py: Python<'_>,
    model: &Bound<'_, Model>,
    t_end: f64,
    starts: Option<PyReadonlyArray2<'_, f64>>,
    dt: Option<f64>,
    parameters: Values,
    initial: Values,
    expressions: Values,
    tables: Vec<(String, PyReadonlyArray1<'_, f64>, PyReadonlyArray1<'_, f64>)>,
    functions: Vec<(String, Py<PyAny>)>,
    recorded: Option<PathBuf>,
    interpolated: Option<String>,
    laws: Vec<String>,
    method: &str,
    step: Option<f64>,
    tolerances: [Option<f64>; 2],
    max_steps: Option<usize>,
    extras: Vec<String>,
) -> PyResult<Vec<Simulated>> {
    let model = &model.get().inner;
    let info = model.info();
    let failed = Arc::new(Mutex::new(None));
    let mut motion = Motion::new(t_end);
    motion.interval = dt;
    motion.parameters = assignments(&parameters);
    motion.initial = assignments(&initial);
    motion.inputs = assignments(&expressions);
    motion.recorded = recorded;
    motion.interpolation = interpolated.as_deref().map(interpolation).transpose()?;
    for law in &laws {
        motion = motion.feedback(law);
    }
    motion.method = match (method, step) {
        ("dop853", _) => Method::Dop853,
        ("dopri5", _) => Method::Dopri5,
        ("rk4", Some(step)) => Method::Rk4 { step },
        ("rk4", None) => return Err(PyValueError::new_err("method `rk4` needs a step in s")),
        (other, _) => {
            let message = format!("method is one of dop853, dopri5, rk4, not `{other}`");
            return Err(PyValueError::new_err(message));
        }
    };
    let [relative, absolute] = tolerances;
    let options = &mut motion.options;
    options.rtol = relative.unwrap_or(options.rtol);
    options.atol = absolute.unwrap_or(options.atol);
    options.max_steps = max_steps.unwrap_or(options.max_steps);
    recorded_too(&mut motion.extras, &extras)?;
    let index = |name: &str| info.input_index(name).unwrap_or(0);
    for (name, times, values) in &tables {
        let source = table(
            info.declared_inputs,
            index(name),
            times.as_slice()?,
            values.as_slice()?,
            motion.interpolation.unwrap_or(Interpolation::Hold),
        );
        motion.driven.push(Driven {
            inputs: vec![name.clone()],
            source: Arc::new(source.raise(py)?),
        });
    }
    for (name, function) in functions {
        let source = Callable {
            input: index(&name),
            function,
            failed: Arc::clone(&failed),
        };
        motion.driven.push(Driven {
            inputs: vec![name],
            source: Arc::new(source),
        });
    }
    let model = Arc::clone(model);
    let told = Arc::clone(&failed);
    let starts = starts.map(|starts| {
        let rows = starts.as_array();
        rows.outer_iter()
            .map(|row| row.to_vec())
            .collect::<Vec<_>>()
    });
    let simulated = awaited(py, move |watch| {
        let goes_on = || watch.goes_on() && lock(&told).is_none();
        let simulated = match &starts {
            None => model.simulate_while(&motion, goes_on).map(|one| vec![one]),
            Some(starts) => model.simulate_batch(&motion, starts, goes_on),
        };
        simulated.map(|simulated| (model, simulated))
    })?;
    if let Some(error) = lock(&failed).take() {
        return Err(error);
    }
    let (model, simulated) = simulated.raise(py)?;
    let one = |simulated| Simulated {
        model: Arc::clone(&model),
        simulated,
    };
    Ok(simulated.into_iter().map(one).collect())
}

/// Contents of a motion: times, rows of columns, parameters, extra columns, cause of an early end and undefined
/// columns, start of held inputs, cost.
type Parts<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Vec<f64>,
    [bool; 6],
    [Option<String>; 2],
    Option<f64>,
    [usize; 3],
);

/// A motion from its parts.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the parts of a motion")]
pub(crate) fn restored(
    model: &Bound<'_, Model>,
    times: PyReadonlyArray1<'_, f64>,
    rows: PyReadonlyArray2<'_, f64>,
    parameters: Vec<f64>,
    extras: [bool; 6],
    texts: [Option<String>; 2],
    held_from: Option<f64>,
    cost: [usize; 3],
) -> PyResult<Simulated> {
    let model = &model.get().inner;
    let info = model.info();
    let (n, m) = (info.state_len(), info.input_len());
    let (times, rows) = (times.as_slice()?.to_vec(), rows.as_array());
    if rows.nrows() != times.len()
        || rows.ncols() < n + m
        || parameters.len() != info.parameter_len()
    {
        return Err(PyValueError::new_err("the motion belongs to another model"));
    }
    let states: Vec<f64> = rows
        .outer_iter()
        .flat_map(|row| row.to_vec().into_iter().take(n))
        .collect();
    // Rows are requested in order.
    let next = Cell::new(0);
    let fill = |_: f64, _: &[f64], u: &mut [f64]| {
        let row = rows.row(next.get());
        next.set(next.get() + 1);
        for (u, value) in u.iter_mut().zip(row.iter().skip(n)) {
            *u = *value;
        }
    };
    let [
        outputs,
        energies,
        reactions,
        contacts,
        conditions,
        residuals,
    ] = extras;
    let extras = Extras {
        outputs,
        energies,
        reactions,
        contacts,
        conditions,
        residuals,
    };
    let mut trajectory =
        Trajectory::evaluate(model.equations(), &parameters, times, &states, fill, extras);
    let [steps, rejected, evaluations] = cost;
    trajectory.statistics.steps = steps;
    trajectory.statistics.rejected = rejected;
    trajectory.statistics.evaluations = evaluations;
    let [failure, undefined] = texts;
    let simulated = appell::Simulated {
        trajectory,
        failure,
        undefined,
        remarks: Remarks {
            held_from,
            ..Remarks::default()
        },
    };
    Ok(Simulated {
        model: Arc::clone(model),
        simulated,
    })
}

#[pymethods]
impl Simulated {
    /// Its contents; see [`restored`].
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let simulated = &self.simulated;
        let trajectory = &simulated.trajectory;
        let extras = trajectory.extras();
        let cost = trajectory.statistics;
        Ok((
            self.times(py),
            self.values(py)?,
            trajectory.parameters().to_vec(),
            [
                extras.outputs,
                extras.energies,
                extras.reactions,
                extras.contacts,
                extras.conditions,
                extras.residuals,
            ],
            [simulated.failure.clone(), simulated.undefined.clone()],
            simulated.remarks.held_from,
            [cost.steps, cost.rejected, cost.evaluations],
        ))
    }

    /// Times in s.
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.simulated.trajectory.times())
    }

    /// All columns in SI, a row a time.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let motion = &self.simulated.trajectory;
        let all: Vec<f64> = (0..motion.len())
            .flat_map(|row| motion.row(row).iter().copied())
            .collect();
        PyArray1::from_vec(py, all).reshape([motion.len(), motion.columns().len()])
    }

    /// Name, meaning, unit and scale of the columns.
    fn columns(&self) -> Vec<(String, String, String, f64)> {
        let columns = self.simulated.trajectory.columns().iter();
        columns
            .map(|column| {
                let [name, about, unit] =
                    [&column.name, &column.about, &column.unit].map(ToString::to_string);
                (name, about, unit, column.scale)
            })
            .collect()
    }

    /// The reason of an early end.
    #[getter]
    fn failure(&self) -> Option<&str> {
        self.simulated.failure.as_deref()
    }

    /// The first non-finite inputs, outputs and energies.
    #[getter]
    fn undefined(&self) -> Option<&str> {
        self.simulated.undefined.as_deref()
    }

    /// The time from which the last values of recorded inputs are held.
    #[getter]
    fn held_from(&self) -> Option<f64> {
        self.simulated.remarks.held_from
    }

    /// Recorded inputs that look sampled from a continuous signal.
    #[getter]
    fn smooth(&self) -> Option<&str> {
        self.simulated.remarks.smooth.as_deref()
    }

    /// Steps, rejected steps, evaluations.
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let statistics = &self.simulated.trajectory.statistics;
        let told = PyDict::new(py);
        told.set_item("steps", statistics.steps)?;
        told.set_item("rejected", statistics.rejected)?;
        told.set_item("evaluations", statistics.evaluations)?;
        Ok(told)
    }

    /// The summary of a simulation as JSON.
    fn summary(&self) -> String {
        appell::json::motion(&self.simulated.trajectory, self.failure()).to_string()
    }

    /// The page that animates the motion.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        self.model
            .page(&self.simulated.trajectory, self.failure())
            .raise(py)
    }

    /// States and inputs over time as SVG.
    fn figure(&self) -> String {
        Figure::of_states_and_inputs(&self.simulated.trajectory).to_svg()
    }

    /// Comma-separated values in the units of the spec.
    fn csv(&self) -> PyResult<Vec<u8>> {
        let mut text = Vec::new();
        self.simulated
            .trajectory
            .write_csv(&mut text, CsvOptions::default())?;
        Ok(text)
    }
}
