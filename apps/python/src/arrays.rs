//! Arrays from Python: a single point, or one per row.

use appell::Model;
use appell::derivation::FunctionKind;
use appell::places::{Places, Rows};
use appell_runtime::model::At;
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::errors::Raise as _;

type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// An array argument: one row, or several.
struct Given<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    width: usize,
    count: Option<usize>,
}

impl<'py> Given<'py> {
    /// Rows of one of some widths. Contiguous arrays are not copied.
    fn new(value: &Bound<'py, PyAny>, widths: &[usize], name: &str) -> PyResult<Self> {
        let array = contiguous(value)?;
        let shape = array.shape();
        let width = shape.last().copied().unwrap_or(1);
        let count = match shape {
            [_] => None,
            [count, _] => Some(*count),
            _ => return Err(wrong_shape(name, widths, shape)),
        };
        if !widths.contains(&width) {
            return Err(wrong_shape(name, widths, shape));
        }
        Ok(Self {
            array: array.readonly(),
            width,
            count,
        })
    }

    fn numbers(&self) -> PyResult<&[f64]> {
        Ok(self.array.as_slice()?)
    }
}

fn wrong_shape(name: &str, widths: &[usize], shape: &[usize]) -> PyErr {
    let wanted = widths
        .iter()
        .map(|width| format!("({width},) or (N, {width})"));
    let wanted = wanted.collect::<Vec<_>>().join(" or ");
    PyValueError::new_err(format!("{name} has the shape {shape:?}; it needs {wanted}"))
}

/// An array of doubles, row by row.
fn contiguous<'py>(value: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
    {
        return Ok(array.clone());
    }
    let made = value.py().import("appell._values")?;
    let made = made.getattr("contiguous")?.call1((value,))?;
    Ok(made.cast_into::<PyArrayDyn<f64>>()?)
}

/// Arguments of a call; omitted ones have the values of the spec.
pub(crate) struct Arguments<'a, 'py> {
    pub(crate) x: Option<&'a Bound<'py, PyAny>>,
    pub(crate) u: Option<&'a Bound<'py, PyAny>>,
    pub(crate) p: Option<&'a Bound<'py, PyAny>>,
    pub(crate) t: Option<&'a Bound<'py, PyAny>>,
    /// Pseudo-accelerations, for functions that take them.
    pub(crate) accelerations: Option<&'a Bound<'py, PyAny>>,
}

/// Values of the spec.
pub(crate) struct Defaults {
    pub(crate) x: Vec<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) p: Vec<f64>,
}

/// The numbers of one argument.
fn numbers<'a>(rows: Option<&'a Given<'_>>, default: &'a [f64]) -> PyResult<Rows<'a>> {
    let Some(rows) = rows else {
        return Ok(Rows::same(default));
    };
    let numbers = rows.numbers()?;
    Ok(match rows.count {
        Some(_) => Rows::each(numbers, rows.width),
        None => Rows::same(numbers),
    })
}

/// A call of a function of the equations.
pub(crate) struct Call<'a, 'py> {
    pub(crate) py: Python<'py>,
    pub(crate) model: &'a Model,
    /// Number of threads; all processors where many places are worth it.
    pub(crate) threads: Option<usize>,
    pub(crate) defaults: &'a Defaults,
    pub(crate) places: Arguments<'a, 'py>,
    /// Arrays for the results.
    pub(crate) out: Option<Vec<Bound<'py, PyAny>>>,
}

impl<'py> Call<'_, 'py> {
    /// Evaluates a function at one point or at each of N: `alone` at a point with its pseudo-accelerations, which are zero
    /// if omitted, and `together`, which has the same results, at many. `shapes` are the shapes of the results at one point.
    pub(crate) fn evaluate<const R: usize>(
        self,
        together: Option<FunctionKind>,
        shapes: [&[usize]; R],
        alone: impl Fn(At<'_>, &[f64], [&mut [f64]; R]) + Send + Sync,
    ) -> PyResult<Vec<Array<'py>>> {
        let Self {
            py,
            model,
            threads,
            defaults,
            places,
            out,
        } = self;
        let info = model.info();
        let (m, declared) = (info.input_len(), info.declared_inputs);
        let rows = |value: Option<&Bound<'py, PyAny>>, widths: &[usize], name| {
            let rows = value.map(|value| Given::new(value, widths, name));
            rows.transpose()
        };
        let x = rows(places.x, &[info.state_len()], "x")?;
        let u = rows(places.u, &[declared, m][..=usize::from(m != declared)], "u")?;
        let p = rows(places.p, &[info.parameter_len()], "p")?;
        let accelerations = rows(places.accelerations, &[info.speeds], "accelerations")?;
        let times = places.t.map(contiguous).transpose()?;
        let t_count = times
            .as_ref()
            .filter(|t| t.ndim() > 0)
            .map(PyUntypedArrayMethods::len);
        let all = [&x, &u, &p, &accelerations];
        let counts = all.map(|rows| rows.as_ref().and_then(|rows| rows.count));
        let count = common(
            ["x", "u", "p", "accelerations", "t"]
                .into_iter()
                .zip(counts.into_iter().chain([t_count])),
        )?;

        let arrays = results(py, count, &shapes, out)?;
        let mut writers = Vec::with_capacity(R);
        for array in &arrays {
            let writer = array.try_readwrite();
            writers.push(writer.map_err(|error| PyValueError::new_err(format!("out: {error}")))?);
        }
        let mut slices = Vec::with_capacity(R);
        for writer in &mut writers {
            slices.push(writer.as_slice_mut()?);
        }
        let mut slices = slices.into_iter();
        let written: [&mut [f64]; R] = std::array::from_fn(|_| slices.next().unwrap_or_default());

        let still = vec![0.0; info.speeds];
        let times = times.as_ref().map(PyArrayMethods::readonly);
        let t: &[f64] = match &times {
            Some(times) => times.as_slice()?,
            None => &[0.0],
        };
        let places = Places {
            t: match t_count {
                Some(_) => Rows::each(t, 1),
                None => Rows::same(t),
            },
            x: numbers(x.as_ref(), &defaults.x)?,
            u: numbers(u.as_ref(), &defaults.u)?,
            p: numbers(p.as_ref(), &defaults.p)?,
            accelerations: numbers(accelerations.as_ref(), &still)?,
        };
        let compute = || {
            let count = count.unwrap_or(1);
            model.at_places(together, &places, count, written, threads, alone)
        };
        match count {
            Some(_) => py.detach(compute),
            // Shorter than releasing and reacquiring the lock.
            None => compute(),
        }
        .raise(py)?;
        drop(writers);
        Ok(arrays)
    }
}

/// The common number of rows of all arguments with several rows.
fn common(counts: impl Iterator<Item = (&'static str, Option<usize>)>) -> PyResult<Option<usize>> {
    let mut first: Option<(&str, usize)> = None;
    for (name, count) in counts {
        match (count, first) {
            (Some(count), Some((of, wanted))) if count != wanted => {
                let message = format!("{of} has {wanted} rows, and {name} has {count}");
                return Err(PyValueError::new_err(message));
            }
            (Some(count), None) => first = Some((name, count)),
            _ => {}
        }
    }
    Ok(first.map(|(_, count)| count))
}

/// A new array.
fn zeros(py: Python<'_>, shape: Vec<usize>) -> PyResult<Array<'_>> {
    /// `numpy` reports if there is not enough memory.
    const MANY: usize = 1 << 24;
    if shape
        .iter()
        .try_fold(1_usize, |all, &one| all.checked_mul(one))
        .is_some_and(|all| all < MANY)
    {
        return Ok(PyArrayDyn::zeros(py, shape, false));
    }
    let made = py.import("numpy")?.call_method1("zeros", (shape,))?;
    Ok(made.cast_into::<PyArrayDyn<f64>>()?)
}

/// New arrays, or the given ones.
fn results<'py>(
    py: Python<'py>,
    count: Option<usize>,
    shapes: &[&[usize]],
    out: Option<Vec<Bound<'py, PyAny>>>,
) -> PyResult<Vec<Array<'py>>> {
    let shapes = shapes
        .iter()
        .map(|shape| count.into_iter().chain(shape.iter().copied()).collect());
    let shapes: Vec<Vec<usize>> = shapes.collect();
    let Some(out) = out else {
        return shapes.into_iter().map(|shape| zeros(py, shape)).collect();
    };
    if out.len() != shapes.len() {
        let message = format!("out needs {} arrays, not {}", shapes.len(), out.len());
        return Err(PyValueError::new_err(message));
    }
    let taken = out.into_iter().zip(shapes).map(|(out, shape)| {
        let array = out.cast_into::<PyArrayDyn<f64>>();
        let array = array.map_err(|_| PyTypeError::new_err("out needs an array of float64"))?;
        if array.shape() != shape {
            let found = array.shape();
            let message = format!("out has the shape {found:?}; it needs {shape:?}");
            return Err(PyValueError::new_err(message));
        }
        if !array.is_c_contiguous() {
            let message = "out is not contiguous row by row";
            return Err(PyValueError::new_err(message));
        }
        Ok(array)
    });
    taken.collect()
}
