//! A request for a motion: values with units, feedback laws, inputs, an integrator.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use appell_runtime::inputs::InputSource;
use appell_runtime::integrate::{Ending, Options};
use appell_runtime::model::{Along, Interpolation, Model};
use appell_runtime::real::{Enclosure, Real};
use appell_runtime::simulate::{Method, Response, Sampling, SimulationError, Validity};
use appell_runtime::trajectory::{Extras, NotFinite};
use appell_runtime::{Simulation, Trajectory};

use crate::inputs::controller::{Controller, Plan, Wiring};
use crate::inputs::feedback;
use crate::inputs::tabulated::{self, Remarks};
use crate::setup::{Assignment, Setup, assigning};
use crate::{Error, Field};

/// Maximum number of rows of a trajectory.
pub const MOST_ROWS: f64 = 2e6;

/// Reason of the early end of a cancelled motion.
const INTERRUPTED: &str = "the computation was interrupted";

/// Source of a feedback law.
#[derive(Debug, Clone)]
pub enum Law {
    /// A file.
    File(PathBuf),
    /// A text.
    Text {
        /// Its name in messages.
        name: String,
        /// The text.
        text: String,
    },
}

/// Inputs that a program computes, in SI.
#[derive(Clone)]
pub struct Driven {
    /// The declared inputs that it gives.
    pub inputs: Vec<String>,
    /// Writes all declared inputs; those that it does not give are ignored.
    pub source: Arc<dyn InputSource + Send + Sync>,
}

impl fmt::Debug for Driven {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Driven")
            .field("inputs", &self.inputs)
            .finish_non_exhaustive()
    }
}

/// A request for a motion. Values are texts: `0.3` and `2*10` are in the unit that the spec declares,
/// `30cm` and `5[m/s]/R` are converted and checked. Inputs and feedback laws are added.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Final time in s.
    pub t_end: f64,
    /// Output interval in s; by default a thousandth of the motion.
    pub interval: Option<f64>,
    /// The integrator.
    pub method: Method,
    /// Its tolerances and limits.
    pub options: Options,
    /// Parameters; the others are those of the spec.
    pub parameters: Vec<Assignment>,
    /// Initial values; the others are those of the spec.
    pub initial: Vec<Assignment>,
    /// Inputs as expressions in t, states and parameters.
    pub inputs: Vec<Assignment>,
    /// Inputs from a CSV file, or from a run of a data set, such as `rig/recording.toml:run1.csv`.
    pub recorded: Option<PathBuf>,
    /// Interpolation of the inputs of a CSV file; held by default.
    pub interpolation: Option<Interpolation>,
    /// Inputs as functions or tables of a program.
    pub driven: Vec<Driven>,
    /// Feedback laws.
    pub laws: Vec<Law>,
    /// Additional columns of the trajectory.
    pub extras: Extras,
    /// Validity limits, and the response to a violation.
    pub validity: Validity,
}

/// The result of a simulation.
#[derive(Debug)]
pub struct Simulated {
    /// The motion, possibly ended early.
    pub trajectory: Trajectory,
    /// The reason of an early end.
    pub failure: Option<String>,
    /// Which inputs, outputs and energies are no numbers, if any is.
    pub undefined: Option<String>,
    /// What there is to say about its inputs.
    pub remarks: Remarks,
}

impl Motion {
    /// A motion from 0 to `t_end` in s with the values of the spec; outputs and energies are recorded.
    pub fn new(t_end: f64) -> Self {
        Self {
            t_end,
            interval: None,
            method: Method::Dop853,
            options: Options::default(),
            parameters: Vec::new(),
            initial: Vec::new(),
            inputs: Vec::new(),
            recorded: None,
            interpolation: None,
            driven: Vec::new(),
            laws: Vec::new(),
            extras: Extras {
                outputs: true,
                energies: true,
                ..Extras::default()
            },
            validity: Validity::default(),
        }
    }

    assigning! {
        /// Sets a parameter.
        set to parameters;
        /// Sets an initial value.
        initial to initial;
        /// Drives an input by an expression in t, states and parameters.
        input to inputs;
    }

    /// Drives inputs by a function of time and state, in SI, that writes all declared inputs.
    ///
    /// ```
    /// use appell::{Model, Motion};
    ///
    /// let model = Model::shipped("cart_pole")?;
    /// let push = |t: f64, _: &[f64], u: &mut [f64]| u[0] = (3.0 * t).sin();
    /// let motion = model.simulate(&Motion::new(1.0).drive(&["F"], push))?;
    /// let force = motion.trajectory.column("F").unwrap();
    /// assert!((force[500] - 1.5f64.sin()).abs() < 1e-12);
    /// # Ok::<(), appell::Error>(())
    /// ```
    #[must_use]
    pub fn drive(
        mut self,
        inputs: &[&str],
        source: impl InputSource + Send + Sync + 'static,
    ) -> Self {
        self.driven.push(Driven {
            inputs: inputs.iter().map(ToString::to_string).collect(),
            source: Arc::new(source),
        });
        self
    }

    /// Adds a feedback law, as [`crate::Model::law`] writes it.
    #[must_use]
    pub fn feedback(mut self, law: &str) -> Self {
        self.laws.push(Law::Text {
            name: "feedback law".to_owned(),
            text: law.to_owned(),
        });
        self
    }

    /// The output interval in s, once it and the final time are found valid.
    pub(crate) fn checked_interval(&self) -> Result<f64, Error> {
        let interval = self.row_interval();
        for (field, value) in [(Field::End, self.t_end), (Field::Interval, interval)] {
            if !(value.is_finite() && value > 0.0) {
                let message = format!("{value} is not a positive number of seconds");
                return Err(Error::request(field, message));
            }
        }
        let rows = self.t_end / interval;
        if rows > MOST_ROWS {
            let message = format!(
                "{rows} rows are too many; choose a longer interval (at most {MOST_ROWS:.0} rows)"
            );
            return Err(Error::request(Field::Interval, message));
        }
        Ok(interval)
    }

    /// Output interval in s.
    pub fn row_interval(&self) -> f64 {
        self.interval.unwrap_or(self.t_end / 1000.0)
    }

    /// The validated motion; `name` names the spec in messages.
    pub(crate) fn ready(
        &self,
        model: &dyn Model,
        mut setup: Setup<'_>,
        name: &str,
    ) -> Result<Ready, Error> {
        let interval = self.checked_interval()?;
        setup.watch_ranges = self.validity.ranges == Response::Stop;
        setup.set(&self.parameters)?;
        let plan = self.plan(model, &mut setup, name)?;
        let mut options = self.options;
        let is_opaque = |driven: &Driven| {
            let x: Vec<Enclosure> = setup.initial.iter().map(|&x| Real::constant(x)).collect();
            let mut u = vec![Enclosure::UNKNOWN; model.info().declared_inputs];
            let at_start = Along {
                start: 0.0,
                t: Enclosure::time(0.0, 0.0),
                x: &x,
                u: &[],
                p: &setup.parameters,
            };
            driven.source.bounds(&at_start, &mut u);
            u.contains(&Enclosure::UNKNOWN)
        };
        if self.driven.iter().any(is_opaque) {
            // A program is not sampled between two rows: steps are at most as long as their interval.
            options.max_step = options.max_step.min(interval);
        }
        let mut remarks = plan.remarks.clone();
        remarks.undriven = plan.is_empty();
        remarks.held_from = (remarks.held_from).filter(|from| from + interval < self.t_end);
        let wiring = plan.wiring(&setup, self.t_end)?;
        Ok(Ready {
            wiring,
            parameters: setup.parameters,
            initial: setup.initial,
            interval,
            options,
            remarks,
        })
    }

    /// The motion from a state.
    pub(crate) fn simulation<'r>(
        &self,
        ready: &Ready,
        model: &'r dyn Model,
        inputs: &'r Controller<'_>,
        initial_state: Vec<f64>,
    ) -> Simulation<'r> {
        Simulation {
            parameters: ready.parameters.clone(),
            initial_state,
            inputs,
            span: [0.0, self.t_end],
            method: self.method,
            options: ready.options,
            sampling: Sampling::Every(ready.interval),
            extras: self.extras,
            validity: self.validity,
            ..Simulation::new(model)
        }
    }

    /// Integrates the equations of motion with `run`.
    pub(crate) fn simulate(
        &self,
        model: &dyn Model,
        ready: &Ready,
        run: impl FnOnce(Simulation<'_>) -> Result<Trajectory, SimulationError>,
    ) -> Result<Simulated, Error> {
        let controller = ready
            .wiring
            .controller(model, ready.parameters.clone(), self.t_end);
        let simulation = self.simulation(ready, model, &controller, ready.initial.clone());
        ready.simulated(run(simulation))
    }

    /// The sources of the inputs. Feedback laws come first: `initial` overrides their initial values.
    fn plan(&self, model: &dyn Model, setup: &mut Setup<'_>, name: &str) -> Result<Plan, Error> {
        let mut plan = Plan::new(setup);
        for law in &self.laws {
            let law = match law {
                Law::File(path) => feedback::read(path, setup)?,
                Law::Text { name, text } => feedback::parse(name, text, setup)?,
            };
            law.start(setup)?;
            plan.feedback(law)?;
        }
        setup.start(&self.initial)?;
        for assignment in &self.inputs {
            plan.expression(assignment, setup)?;
        }
        for driven in &self.driven {
            plan.driven(driven, setup)?;
        }
        if let Some(file) = &self.recorded {
            plan.recording(
                tabulated::read(file, name, setup, model, self.t_end, self.interpolation)?,
                setup,
            )?;
        }
        Ok(plan)
    }
}

/// A motion whose request is valid.
pub(crate) struct Ready {
    pub(crate) wiring: Wiring,
    pub(crate) parameters: Vec<f64>,
    pub(crate) initial: Vec<f64>,
    pub(crate) interval: f64,
    pub(crate) options: Options,
    remarks: Remarks,
}

impl Ready {
    /// The result of the motion.
    pub(crate) fn simulated(
        &self,
        result: Result<Trajectory, SimulationError>,
    ) -> Result<Simulated, Error> {
        let (trajectory, failure) = match result {
            Ok(trajectory) => {
                let ended = trajectory.ending == Some(Ending::Stopped);
                let last = trajectory.breaches.last().filter(|_| ended);
                let reason = last.map(|breach| breach.describe_in_full(trajectory.info()));
                let interrupted = matches!(trajectory.ending, Some(Ending::Event(_)));
                let interrupted = interrupted.then(|| INTERRUPTED.to_owned());
                (trajectory, reason.or(interrupted))
            }
            Err(error) => {
                let reason = error.to_string();
                match error {
                    SimulationError::Integration { trajectory, .. } => (*trajectory, Some(reason)),
                    other => return Err(other.into()),
                }
            }
        };
        Ok(Simulated {
            undefined: undefined(&trajectory),
            trajectory,
            failure,
            remarks: self.remarks.clone(),
        })
    }
}

/// Which inputs, outputs and energies of a motion are no numbers, and from when on.
fn undefined(trajectory: &Trajectory) -> Option<String> {
    let one = |bad: &NotFinite| {
        let name = &trajectory.columns()[bad.column].name;
        let t = trajectory.times()[bad.first];
        let rows = if bad.rows == 1 { "row" } else { "rows" };
        format!(
            "`{name}` is not a finite number in {} {rows}, first at t = {t} s",
            bad.rows
        )
    };
    let all = trajectory.not_finite();
    let texts: Vec<String> = all.iter().map(one).collect();
    (!texts.is_empty()).then(|| texts.join("; "))
}
