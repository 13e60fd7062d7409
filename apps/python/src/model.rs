//! A mechanism: its names, its equations and computations.

use std::sync::Arc;

use appell::control::Request;
use appell::derivation::c::{self, Real};
use appell::derivation::{Format, FunctionKind, Stage};
use appell::setup::Assignment;
use appell::steady::Question;
use appell::{Field, ModelInputs, Quantity, Source};
use appell_runtime::inputs::ZeroInputs;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Arguments, Call, Defaults};
use crate::errors::Raise;
use crate::recordings::DataSet;
use crate::watched::watched;

type Array<'py> = Bound<'py, PyArrayDyn<f64>>;
type Any<'a, 'py> = Option<&'a Bound<'py, PyAny>>;
/// Names with their values as texts.
pub(crate) type Values = Vec<(String, String)>;

/// Names of the shipped mechanisms.
#[pyfunction]
pub(crate) fn shipped() -> Vec<&'static str> {
    appell::source::names().collect()
}

pub(crate) fn assignments(values: &Values) -> Vec<Assignment> {
    let values = values.iter();
    values
        .map(|(name, value)| Assignment::new(name, value))
        .collect()
}

/// A mechanism with its equations of motion.
#[pyclass(subclass, frozen)]
pub(crate) struct Model {
    pub(crate) inner: Arc<appell::Model>,
    defaults: Defaults,
    /// Whether its spec is in no file.
    is_text: bool,
}

/// A quantity as a tuple: name, about, unit, scale, value, low, high.
type Told = (String, String, String, f64, f64, f64, f64);

fn told(quantity: &Quantity) -> Told {
    let [name, about, unit] =
        [&quantity.name, &quantity.about, &quantity.unit].map(ToString::to_string);
    let [low, high] = quantity.range;
    (name, about, unit, quantity.scale, quantity.value, low, high)
}

#[pymethods]
impl Model {
    /// A shipped name, the path of a spec, or the text of one.
    #[new]
    #[pyo3(signature = (spec, *, text = false))]
    fn new(py: Python<'_>, spec: &str, text: bool) -> PyResult<Self> {
        let spec = spec.to_owned();
        let model = watched(py, None, move |_| {
            if text {
                appell::Model::from_spec(&spec)
            } else {
                appell::Model::find(&spec)
            }
        })?;
        let info = model.info();
        let mut u = vec![0.0; info.input_len()];
        let x = info.initial_state();
        ModelInputs::new(info, &ZeroInputs)
            .raise(py)?
            .fill(0.0, &x, &mut u);
        // At other times signals have other values.
        u.truncate(info.declared_inputs);
        let defaults = Defaults {
            p: info.default_parameters(),
            x,
            u,
        };
        Ok(Self {
            inner: Arc::new(model),
            defaults,
            is_text: text,
        })
    }

    /// Name, title and source.
    fn _about(&self) -> [String; 3] {
        let info = self.inner.info();
        [&info.name, &info.title, &info.source].map(ToString::to_string)
    }

    /// States, inputs with signals, parameters, outputs.
    fn _quantities(&self) -> [Vec<Told>; 4] {
        let info = self.inner.info();
        [&info.states, &info.inputs, &info.parameters, &info.outputs]
            .map(|list| list.iter().map(told).collect())
    }

    /// Numbers of pseudo-velocities and of declared inputs; names of constraint rows and of reactions.
    fn _structure(&self) -> (usize, usize, Vec<String>, Vec<String>) {
        let info = self.inner.info();
        let rows = info.constraint_rows.iter().map(ToString::to_string);
        let reactions = info.reactions.iter().map(|one| one.name.to_string());
        (
            info.speeds,
            info.declared_inputs,
            rows.collect(),
            reactions.collect(),
        )
    }

    /// Shipped name or path; none of a text.
    #[getter]
    fn _reference(&self) -> Option<&str> {
        let source = self.inner.source();
        let reference = source
            .shipped
            .map_or(source.file.as_str(), |shipped| shipped.name);
        (!self.is_text).then_some(reference)
    }

    /// The text of the spec.
    #[getter]
    fn spec(&self) -> &str {
        &self.inner.source().text
    }

    /// The results of a function at one place or at N; `out` takes them where it is given.
    #[pyo3(signature = (function, x, u, p, t, out, accelerations = None, threads = None))]
    #[expect(clippy::too_many_arguments, reason = "called from Python alone")]
    fn _evaluate<'py>(
        &self,
        py: Python<'py>,
        function: &str,
        x: Any<'_, 'py>,
        u: Any<'_, 'py>,
        p: Any<'_, 'py>,
        t: Any<'_, 'py>,
        out: Option<Vec<Bound<'py, PyAny>>>,
        accelerations: Any<'_, 'py>,
        threads: Option<usize>,
    ) -> PyResult<Vec<Array<'py>>> {
        use FunctionKind as F;
        let model = self.inner.equations();
        let info = model.info();
        let (n, m, k) = (info.state_len(), info.input_len(), info.parameter_len());
        let (s, l, r) = (info.speeds, info.output_len(), info.reactions.len());
        let call = Call {
            py,
            model: &self.inner,
            threads,
            defaults: &self.defaults,
            places: Arguments {
                x,
                u,
                p,
                t,
                accelerations,
            },
            out,
        };
        match function {
            "rates" => call.evaluate(Some(F::Rates), [&[n]], |at, _, [rates]| {
                model.rates(at, rates);
            }),
            "jacobians" => {
                let shapes: [&[usize]; 3] = [&[n], &[n, n], &[n, m]];
                call.evaluate(Some(F::Jacobians), shapes, |at, _, [rates, a, b]| {
                    model.jacobians(at, rates, a, b);
                })
            }
            "parameter_jacobian" => {
                call.evaluate(Some(F::ParameterJacobian), [&[n, k]], |at, _, [by_p]| {
                    model.parameter_jacobian(at, by_p);
                })
            }
            "appell" => call.evaluate(
                None,
                [&[s, s], &[s], &[s]],
                |at, _, [mass, bias, forces]| {
                    model.appell(at, mass, bias, forces);
                },
            ),
            "energies" => call.evaluate(None, [&[]; 4], |at, _, results| {
                let all = model.energies(at);
                let all = [all.kinetic, all.potential, all.power, all.acceleration];
                for (result, energy) in results.into_iter().zip(all) {
                    result[0] = energy;
                }
            }),
            "outputs" => call.evaluate(Some(F::Outputs), [&[l]], |at, _, [outputs]| {
                model.outputs(at, outputs);
            }),
            "output_jacobians" => {
                let model = self.inner.all_equations().raise(py)?;
                let shapes: [&[usize]; 3] = [&[l], &[l, n], &[l, m]];
                call.evaluate(
                    Some(F::OutputJacobians),
                    shapes,
                    |at, _, [outputs, c, d]| {
                        model.output_jacobians(at, outputs, c, d);
                    },
                )
            }
            "constraint_forces" => {
                call.evaluate(Some(F::ConstraintForces), [&[r, 3]], |at, _, [forces]| {
                    model.constraint_forces(at, forces);
                })
            }
            "inverse_dynamics" => {
                call.evaluate(Some(F::InverseDynamics), [&[s]], |at, given, [demand]| {
                    model.inverse_dynamics(at, given, demand);
                })
            }
            "inverse_dynamics_jacobians" => {
                let shapes: [&[usize]; 4] = [&[s], &[s, n], &[s, m], &[s, s]];
                let kind = Some(F::InverseDynamicsJacobians);
                call.evaluate(kind, shapes, |at, given, [demand, by_x, by_u, mass]| {
                    model.inverse_dynamics_jacobians(at, given, demand, by_x, by_u, mass);
                })
            }
            other => {
                let message = format!("there is no function `{other}`");
                Err(PyValueError::new_err(message))
            }
        }
    }

    /// A state of the spec with other values, as numbers in SI.
    fn _state<'py>(&self, py: Python<'py>, values: Values) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut setup = self.inner.setup().raise(py)?;
        setup.start(&assignments(&values)).raise(py)?;
        Ok(PyArray1::from_vec(py, setup.initial))
    }

    /// Parameters of the spec with other values, as numbers in SI.
    fn _parameters<'py>(
        &self,
        py: Python<'py>,
        values: Values,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut setup = self.inner.setup().raise(py)?;
        setup.set(&assignments(&values)).raise(py)?;
        Ok(PyArray1::from_vec(py, setup.parameters))
    }

    /// The value of an input in SI.
    fn _input(&self, py: Python<'_>, name: &str, value: &str) -> PyResult<f64> {
        let setup = self.inner.setup().raise(py)?;
        let input = setup.input(Field::Input, name).raise(py)?;
        let unit = &setup.mechanism.inputs[appell::setup::InputId::new(input)]
            .label
            .unit;
        setup.value(Field::Input, name, value, unit).raise(py)
    }

    /// Steady motions as JSON.
    #[pyo3(signature = (parameters, fix, free, along, require, starts))]
    #[expect(clippy::too_many_arguments, reason = "called by name from Python")]
    fn _steady(
        &self,
        py: Python<'_>,
        parameters: Values,
        fix: Values,
        free: Vec<String>,
        along: Option<(String, String, String)>,
        require: Values,
        starts: Option<usize>,
    ) -> PyResult<String> {
        let mut question = Question {
            parameters: assignments(&parameters),
            fix: assignments(&fix),
            free,
            require: assignments(&require),
            ..Question::default()
        };
        if let Some((name, from, to)) = along {
            question = question.along(&name, from, to);
        }
        question.starts = starts.unwrap_or(question.starts);
        let model = Arc::clone(&self.inner);
        watched(py, None, move |_| {
            let asked = model.resolve(&question)?;
            let answer = asked.answer()?;
            Ok(appell::json::steady(&asked, &answer).to_string())
        })
    }

    /// A design as JSON, and the text of its law.
    #[expect(clippy::too_many_arguments, reason = "called by name from Python")]
    fn _control(
        &self,
        py: Python<'_>,
        parameters: Values,
        at: Values,
        inputs: Vec<String>,
        outputs: Vec<String>,
        poles: Option<String>,
        weights: Option<String>,
        sampled: Option<[f64; 2]>,
    ) -> PyResult<(String, Option<String>)> {
        let request = Request {
            parameters: assignments(&parameters),
            at: assignments(&at),
            inputs,
            outputs,
            poles,
            weights,
            sampled_ms: sampled.map(|[period, _]| period),
            delay_ms: sampled.map(|[_, delay]| delay),
        };
        let model = Arc::clone(&self.inner);
        watched(py, None, move |_| {
            let design = model.control(&request)?;
            let law = design.law.is_some().then(|| model.law(&design));
            let law = law.transpose()?;
            let json = appell::json::design(model.info(), &design);
            Ok((json.to_string(), law))
        })
    }

    /// The derivation up to a stage, as `text`, `latex`, `html` or `formulas`.
    fn _derivation(&self, py: Python<'_>, stage: &str, format: &str) -> PyResult<String> {
        let stage = match stage {
            "motion" => None,
            "kinematics" => Some(Stage::Kinematics),
            "energy" => Some(Stage::Energy),
            "jacobians" => Some(Stage::Jacobians),
            "all" => Some(Stage::All),
            _ => Some(Stage::Equations),
        };
        let format = match format {
            "latex" => Format::Latex,
            "html" => Format::Html,
            "formulas" => Format::Formulas,
            _ => Format::Text,
        };
        self.of_source(py, move |source| match stage {
            Some(stage) => source.derivation(stage, format),
            None => source.equations_of_motion(format),
        })
    }

    /// The drawing as SVG.
    fn _drawing(&self, py: Python<'_>, parameters: Values, initial: Values) -> PyResult<String> {
        self.of_source(py, move |source| {
            source.drawing_at(&assignments(&parameters), &assignments(&initial))
        })
    }

    /// Typed equations of motion against the derived ones, as JSON.
    fn _compare(&self, py: Python<'_>, equations: Values) -> PyResult<String> {
        self.of_source(py, move |source| {
            let compared = source.compare(&assignments(&equations))?;
            Ok(compared.json().to_string())
        })
    }

    /// Base parameters as JSON, estimated where there are recordings.
    #[pyo3(signature = (recordings = None))]
    fn _base(&self, py: Python<'_>, recordings: Option<&DataSet>) -> PyResult<String> {
        let set = recordings.map(DataSet::shared);
        let model = Arc::clone(&self.inner);
        let found = watched(py, None, move |_| model.base_parameters(set.as_deref()))?;
        Ok(found.to_json().to_string())
    }

    /// The regressor as a Python module.
    fn _regressor(&self, py: Python<'_>) -> PyResult<String> {
        self.of_source(py, |source| source.python(&[FunctionKind::Regressor]))
    }

    /// The equations as CUDA C++.
    fn _cuda(&self, py: Python<'_>, single: bool, integrator: bool) -> PyResult<String> {
        self.of_source(py, move |source| {
            let real = if single { Real::Float } else { Real::Double };
            source.cuda(&c::Options {
                functions: source.functions()?,
                real,
                integrator,
            })
        })
    }

    /// The equations as a Python module.
    fn _module(&self, py: Python<'_>) -> PyResult<String> {
        self.of_source(py, |source| source.python(&source.functions()?))
    }
}

impl Model {
    fn of_source(
        &self,
        py: Python<'_>,
        compute: impl FnOnce(&Source) -> Result<String, appell::Error> + Send + 'static,
    ) -> PyResult<String> {
        let model = Arc::clone(&self.inner);
        watched(py, None, move |_| compute(model.source()))
    }
}
