//! A motion as it is asked for: numbers with units, laws, inputs, an integrator.

use std::path::PathBuf;

use appell_runtime::integrate::{Ending, Options};
use appell_runtime::model::Model;
use appell_runtime::simulate::{Method, Response, Sampling, SimulationError, Validity};
use appell_runtime::trajectory::Extras;
use appell_runtime::{Simulation, Trajectory};

use crate::Error;
use crate::inputs::controller::Plan;
use crate::inputs::{feedback, tabulated};
use crate::setup::{Assignment, Setup};

/// Rows of a trajectory that fit into memory anywhere.
pub const MOST_ROWS: f64 = 2e6;

/// Where a feedback law stands.
#[derive(Debug, Clone)]
pub enum Law {
    /// In a file.
    File(PathBuf),
    /// In a text, with the name under which its mistakes are reported.
    Text {
        /// The name.
        name: String,
        /// The text.
        text: String,
    },
}

/// What is asked for. Values are texts: `0.3` and `2*10` are in the unit that the spec declares,
/// `30cm` and `5[m/s]/R` are converted and checked. Inputs and laws add up.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Its end in s.
    pub t_end: f64,
    /// Interval between the rows of the trajectory in s; a thousandth of the motion by default.
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
    /// A CSV file with inputs, or a run of a data set such as `rig/recording.toml:run1.csv`.
    pub recorded: Option<PathBuf>,
    /// Feedback laws.
    pub laws: Vec<Law>,
    /// What is recorded besides states and inputs.
    pub extras: Extras,
    /// What is watched, and what happens when it is passed.
    pub validity: Validity,
}

/// A motion that was computed.
#[derive(Debug)]
pub struct Simulated {
    /// The motion, up to where it ended.
    pub trajectory: Trajectory,
    /// Why it ended early, if it did.
    pub failure: Option<String>,
    /// Whether nothing drives the mechanism.
    pub undriven: bool,
}

impl Motion {
    /// The motion of the spec from 0 to `t_end` in s, with outputs and energies.
    pub fn new(t_end: f64) -> Self {
        Self {
            t_end,
            interval: None,
            method: Method::Dop853,
            options: Options::with_tolerances(1e-9, 1e-9),
            parameters: Vec::new(),
            initial: Vec::new(),
            inputs: Vec::new(),
            recorded: None,
            laws: Vec::new(),
            extras: Extras {
                outputs: true,
                energies: true,
                ..Extras::default()
            },
            validity: Validity::default(),
        }
    }

    /// Gives a parameter another value.
    #[must_use]
    pub fn set(mut self, name: &str, value: impl ToString) -> Self {
        self.parameters.push(Assignment::new(name, value));
        self
    }

    /// Gives a state another initial value.
    #[must_use]
    pub fn initial(mut self, name: &str, value: impl ToString) -> Self {
        self.initial.push(Assignment::new(name, value));
        self
    }

    /// Drives an input by an expression in t, states and parameters.
    #[must_use]
    pub fn input(mut self, name: &str, expression: impl ToString) -> Self {
        self.inputs.push(Assignment::new(name, expression));
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

    /// Interval between the rows in s.
    pub fn row_interval(&self) -> f64 {
        self.interval.unwrap_or(self.t_end / 1000.0)
    }

    /// Computes it with the equations and the numbers of a spec, which `name` stands for in messages;
    /// `progress` hears the time in s that is reached.
    pub(crate) fn simulate(
        &self,
        model: &dyn Model,
        mut setup: Setup<'_>,
        name: &str,
        progress: impl Fn(f64),
    ) -> Result<Simulated, Error> {
        let interval = self.row_interval();
        for (what, value) in [("end", self.t_end), ("interval between rows", interval)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::Usage(format!(
                    "the {what} of the motion must be a positive number of seconds, not {value}"
                )));
            }
        }
        let rows = self.t_end / interval;
        if rows > MOST_ROWS {
            return Err(Error::Usage(format!(
                "{rows} rows are too many; choose a longer interval (at most {MOST_ROWS:.0} rows)"
            )));
        }
        setup.watch_ranges = self.validity.ranges == Response::Stop;
        setup.set(&self.parameters)?;
        let plan = self.plan(model, &mut setup, name)?;
        let undriven = plan.is_empty();
        let controller = plan.controller(&setup, self.t_end)?;
        let simulation = Simulation {
            parameters: setup.parameters,
            initial_state: setup.initial,
            inputs: &controller,
            span: [0.0, self.t_end],
            method: self.method,
            options: self.options,
            sampling: Sampling::Every(interval),
            extras: self.extras,
            validity: self.validity,
            progress: Some(Box::new(progress)),
            ..Simulation::new(model)
        };
        let (trajectory, failure) = match simulation.run() {
            Ok(trajectory) => {
                let ended = trajectory.ending == Some(Ending::Stopped);
                let last = trajectory.breaches.last().filter(|_| ended);
                let reason = last.map(|breach| breach.describe_in_full(trajectory.info()));
                (trajectory, reason)
            }
            Err(error) => {
                let reason = error.to_string();
                match error {
                    SimulationError::Integration { trajectory, .. } => (*trajectory, Some(reason)),
                    _ => return Err(Error::Usage(reason)),
                }
            }
        };
        Ok(Simulated {
            trajectory,
            failure,
            undriven,
        })
    }

    /// What drives the inputs. Laws come first: they may ask for initial values, which `initial` overrides.
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
        if let Some(file) = &self.recorded {
            let (table, inputs) = tabulated::read(file, name, setup, model)?;
            plan.recording(table, &inputs, setup)?;
        }
        Ok(plan)
    }
}
