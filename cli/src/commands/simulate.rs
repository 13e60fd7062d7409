//! `appell simulate`

use std::path::{Path, PathBuf};

use appell_report::figure::Figure;
use appell_runtime::integrate::{Ending, Options};
use appell_runtime::model::ModelInfo;
use appell_runtime::simulate::{Method, Response, Sampling, SimulationError, Validity};
use appell_runtime::trajectory::{CsvOptions, Extras};
use appell_runtime::{Simulation, Trajectory};

use crate::engine::{Engine, equations};
use crate::failure::note;
use crate::output;
use crate::{film, picture, progress, summary};
use appell::Error;
use appell::engine::Equations;
use appell::files;
use appell::inputs::controller::Plan;
use appell::inputs::feedback;
use appell::inputs::tabulated;
use appell::setup::{Assignment, Setup};
use appell::source::Source;

/// Integrates the equations of motion and summarises the motion.
/// Plain numbers, such as `20`, `2*10` or `5*sin(2*t)`, are in the unit that the spec declares for
///the quantity. Names and numbers with a unit, such as `30cm` or `5[m/s]/R`, are converted and
///checked. Expressions for inputs may contain `t`, states and parameters; a plain coefficient of a
///state, as in `-3*x - v`, is a gain in SI. Inputs and feedback are added.
#[derive(Debug, clap::Args)]
pub(crate) struct Simulate {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// End of the motion in s
    #[arg(
        long,
        value_name = "S",
        default_value_t = 10.0,
        allow_negative_numbers = true
    )]
    t_end_s: f64,
    /// Output interval in s; the integrator chooses its own steps [default: a thousandth of the motion]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    dt_s: Option<f64>,
    /// The integrator
    #[arg(long, value_enum, default_value_t = Integrator::Dop853)]
    method: Integrator,
    /// Relative error tolerance
    #[arg(long, default_value = "1e-9", allow_negative_numbers = true)]
    rtol: f64,
    /// Absolute error tolerance, in SI
    #[arg(long, default_value = "1e-9", allow_negative_numbers = true)]
    atol: f64,
    /// Maximum number of steps, rejected ones included
    #[arg(long, value_name = "N", default_value_t = Options::default().max_steps)]
    max_steps: usize,
    /// A parameter, such as R=0.3 or R=30cm
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Assignment>,
    /// An initial value; the others are those of the spec
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    initial: Vec<Assignment>,
    /// An input as an expression in t, states and parameters
    #[arg(long, value_name = "NAME=EXPR", allow_hyphen_values = true)]
    input: Vec<Assignment>,
    /// Inputs from a CSV file with the columns t and inputs, each value held until the next row, or from
    /// a run of a data set, such as rig/recording.toml:run1.csv
    #[arg(long, value_name = "FILE")]
    inputs: Option<PathBuf>,
    /// A feedback law (docs/examples/feedback)
    #[arg(long, value_name = "FILE.toml")]
    feedback: Vec<PathBuf>,
    /// Allow states to leave their declared ranges
    #[arg(long)]
    ignore_ranges: bool,
    /// Coefficient of friction of all contacts, instead of those of the spec
    #[arg(long, value_name = "MU", allow_negative_numbers = true)]
    friction: Option<f64>,
    /// Response when a contact is lost or slips, a state leaves its range, or a linear system is
    /// nearly singular [default: leaving a range ends the motion, the others are reported]
    #[arg(long, value_enum, value_name = "WHAT")]
    on_event: Option<OnEvent>,
    /// How the equations are evaluated [default: emitted for shipped mechanisms, else jit]
    #[arg(long, value_enum)]
    engine: Option<Engine>,
    /// Also compute the constraint forces, as columns `reaction_…` in the ground frame (in N at a
    /// point, else the multiplier), and at contacts `normal_force_…`, `tangential_force_…` and
    /// `friction_demand_…`
    #[arg(long)]
    reactions: bool,
    /// Also compute condition numbers, as columns `condition_…`
    #[arg(long)]
    conditions: bool,
    /// Write the motion: time, states, inputs, outputs, energies, in the units of the spec; `-` is
    /// standard output, with the summary on standard error
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Draw states and inputs over time
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write a self-contained HTML page that animates the mechanism
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Write a summary as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The integrators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Integrator {
    /// Order 8, step-size control
    Dop853,
    /// Order 5, step-size control
    Dopri5,
    /// Order 4, fixed steps of the output interval
    Rk4,
}

/// The response to an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum OnEvent {
    /// End the motion
    Stop,
    /// Report it and continue
    Warn,
}

impl Simulate {
    pub(super) fn run(&self) -> Result<(), Error> {
        positive("--t-end-s", self.t_end_s)?;
        let interval = self.dt_s.unwrap_or(self.t_end_s / 1000.0);
        positive("--dt-s", interval)?;
        if self.t_end_s / interval > MOST_ROWS {
            return Err(Error::Usage(format!(
                "{} rows are too many; choose a larger `--dt-s` (at most {MOST_ROWS:.0} rows)",
                self.t_end_s / interval
            )));
        }
        let source = Source::find(&self.model)?;
        let equations = equations(&source, self.engine)?;
        let mut setup = Setup::new(&source.file, &source.text, equations.model().info())?;
        let validity = self.validity(setup.info)?;
        setup.watch_ranges = validity.ranges == Response::Stop;
        setup.set(&self.set)?;
        let mut plan = Plan::new(&setup);
        for file in &self.feedback {
            let law = feedback::read(file, &setup)?;
            setup.start_from_law(&law)?;
            plan.feedback(law)?;
        }
        setup.start(&self.initial)?;
        for assignment in &self.input {
            plan.expression(assignment, &setup)?;
        }
        if let Some(file) = &self.inputs {
            let (table, inputs) = tabulated::read(file, &self.model, &setup, equations.model())?;
            plan.recording(table, &inputs, &setup)?;
        }
        let method = match self.method {
            Integrator::Dop853 => Method::Dop853,
            Integrator::Dopri5 => Method::Dopri5,
            Integrator::Rk4 => Method::Rk4 { step: interval },
        };
        let run = Run {
            equations: &equations,
            setup: &setup,
            t_end: self.t_end_s,
            interval,
            method,
            options: Options {
                max_steps: self.max_steps,
                ..Options::with_tolerances(self.rtol, self.atol)
            },
            extras: Extras {
                reactions: self.reactions,
                contacts: self.reactions,
                conditions: self.conditions,
                ..standard_extras()
            },
            validity,
        };
        let undriven = plan.is_empty();
        let (trajectory, failure) = run.run(plan)?;

        for [wanted, name] in trajectory.renamed() {
            note(&format!(
                "the spec uses the name `{wanted}`; the computed column is `{name}`"
            ));
        }
        if let Some(path) = &self.csv {
            write_csv(path, &trajectory)?;
        }
        if let Some(path) = &self.plot {
            picture::write(path, &Figure::of_states_and_inputs(&trajectory).to_svg())?;
        }
        if let Some(path) = &self.html {
            let page = film::page(&equations, &setup, &trajectory, failure.as_deref())?;
            files::write(path, &page)?;
        }
        if let Some(path) = &self.json {
            files::write_json(path, &summary::json(&trajectory, failure.as_deref()))?;
        }
        let mut text = summary::text(&trajectory);
        if undriven && failure.is_none() && summary::rests(&trajectory) {
            text += &hint(&setup);
        }
        output::print_beside(&text, &[&self.csv, &self.plot, &self.html, &self.json])?;
        match failure {
            None => Ok(()),
            Some(reason) => Err(Error::Computation(reason)),
        }
    }

    /// The watched limits and the response to each.
    fn validity(&self, info: &ModelInfo) -> Result<Validity, Error> {
        if let Some(friction) = self.friction {
            if !(friction.is_finite() && friction >= 0.0) {
                return Err(Error::Usage(format!(
                    "`--friction {friction}` must be a non-negative number"
                )));
            }
            if !info.contacts.iter().any(|contact| contact.grips) {
                return Err(Error::Usage(
                    "`--friction`: the mechanism has no rolling contact with known forces"
                        .to_owned(),
                ));
            }
        }
        let (ranges, others) = match self.on_event {
            None => (Response::Stop, Response::Report),
            Some(OnEvent::Stop) => (Response::Stop, Response::Stop),
            Some(OnEvent::Warn) => (Response::Report, Response::Report),
        };
        Ok(Validity {
            ranges: if self.ignore_ranges {
                Response::Ignore
            } else {
                ranges
            },
            contacts: others,
            friction: self.friction,
            conditions: others,
            ..Validity::default()
        })
    }
}

/// Largest number of output rows.
const MOST_ROWS: f64 = 2e6;

fn positive(flag: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "`{flag} {value}` must be a positive number of seconds"
    )))
}

fn hint(setup: &Setup<'_>) -> String {
    let first = setup.info.coordinate_quantities().last();
    let name = first.map_or("NAME", |coordinate| coordinate.name.as_ref());
    format!(
        "  nothing moves: the mechanism starts in equilibrium and has no input; try `--initial \
         {name}=0.1`\n"
    )
}

/// The columns recorded by default.
pub(super) fn standard_extras() -> Extras {
    Extras {
        outputs: true,
        energies: true,
        ..Extras::default()
    }
}

/// A simulation to be run.
pub(super) struct Run<'a> {
    /// Equations of motion.
    pub(super) equations: &'a Equations,
    /// Parameters and initial values.
    pub(super) setup: &'a Setup<'a>,
    /// End in s.
    pub(super) t_end: f64,
    /// Output interval in s.
    pub(super) interval: f64,
    /// The integrator.
    pub(super) method: Method,
    /// Its tolerances.
    pub(super) options: Options,
    /// What is recorded besides states and inputs.
    pub(super) extras: Extras,
    /// What is watched.
    pub(super) validity: Validity,
}

impl Run<'_> {
    /// The motion, and the reason if it ends early.
    pub(super) fn run(&self, plan: Plan) -> Result<(Trajectory, Option<String>), Error> {
        let controller = plan.controller(self.setup, self.t_end)?;
        let clock = progress::clock(self.t_end);
        let simulation = Simulation {
            parameters: self.setup.parameters.clone(),
            initial_state: self.setup.initial.clone(),
            inputs: &controller,
            span: [0.0, self.t_end],
            method: self.method,
            options: self.options,
            sampling: Sampling::Every(self.interval),
            extras: self.extras,
            validity: self.validity,
            progress: Some(Box::new(|t| clock.set_position(progress::milliseconds(t)))),
            ..Simulation::new(self.equations.model())
        };
        let outcome = simulation.run();
        clock.finish_and_clear();
        match outcome {
            Ok(trajectory) => {
                let ended = trajectory.ending == Some(Ending::Stopped);
                let last = trajectory.breaches.last().filter(|_| ended);
                let reason = last.map(|breach| breach.describe_in_full(trajectory.info()));
                Ok((trajectory, reason))
            }
            Err(error) => {
                let reason = error.to_string();
                match error {
                    SimulationError::Integration { trajectory, .. } => {
                        Ok((*trajectory, Some(reason)))
                    }
                    _ => Err(Error::Usage(reason)),
                }
            }
        }
    }
}

/// Writes a trajectory as CSV.
pub(super) fn write_csv(path: &Path, trajectory: &Trajectory) -> Result<(), Error> {
    files::write_with(path, |to| trajectory.write_csv(to, CsvOptions::default()))
}
