//! `appell simulate`

use std::path::{Path, PathBuf};

use crate::failure::Error;
use appell::setup::Assignment;
use appell::{Law, Model, Motion, Remarks, Simulated, files};
use appell_report::figure::Figure;
use appell_report::text::number;
use appell_runtime::Trajectory;
use appell_runtime::integrate::Options;
use appell_runtime::model::{Interpolation, ModelInfo};
use appell_runtime::simulate::{Method, Response, Validity};
use appell_runtime::trajectory::{CsvOptions, Extras};

use crate::engine::{self, Engine};
use crate::failure::note;
use crate::{output, picture, progress, summary};

/// Integrates the equations of motion and summarises the motion.
///
/// Expressions without units, such as `20`, `2*10` or `5*sin(2*t)`, are in the declared unit of the
/// quantity. Names and numbers with a unit, such as `30cm` or `5[m/s]/R`, are converted and
/// checked. Expressions for inputs may contain `t`, states and parameters; a plain coefficient of a
/// state, as in `-3*x - v`, is a gain in SI. Inputs and feedback are summed.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell simulate my_pendulum.toml --initial theta=60deg --plot motion.svg
  appell simulate my_pendulum.toml --set l=30cm --input \"F=5*sin(2*t)\" --csv motion.csv
  appell simulate rolling_wheel --initial theta=20deg --initial omega_2=10 --html wheel.html")]
pub(crate) struct Simulate {
    /// Name of a shipped mechanism, or path of a spec or a robot file
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
    #[arg(long, default_value = "1e-11", allow_negative_numbers = true)]
    rtol: f64,
    /// Absolute error tolerance, in SI
    #[arg(long, default_value = "1e-11", allow_negative_numbers = true)]
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
    /// How the inputs of a CSV file run from row to row [default: hold]
    #[arg(long, value_enum, value_name = "HOW", requires = "inputs")]
    interpolation: Option<Between>,
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

/// Inputs between the rows of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Between {
    /// Held until the next row, as a drive does with a command
    Hold,
    /// Straight lines from row to row, for rows of a continuous signal
    Linear,
    /// A natural cubic spline through the rows, for rows of a smooth signal
    Cubic,
}

impl Between {
    fn of_rows(self) -> Interpolation {
        match self {
            Self::Hold => Interpolation::Hold,
            Self::Linear => Interpolation::Linear,
            Self::Cubic => Interpolation::Cubic,
        }
    }
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
        let model = engine::model(&self.model, &self.set, self.engine)?;
        let whole = Motion {
            interval: self.dt_s,
            ..Motion::new(self.t_end_s)
        };
        let motion = Motion {
            method: match self.method {
                Integrator::Dop853 => Method::Dop853,
                Integrator::Dopri5 => Method::Dopri5,
                Integrator::Rk4 => Method::Rk4 {
                    step: whole.row_interval(),
                },
            },
            options: Options {
                max_steps: self.max_steps,
                ..Options::with_tolerances(self.rtol, self.atol)
            },
            parameters: self.set.clone(),
            initial: self.initial.clone(),
            inputs: self.input.clone(),
            recorded: self.inputs.clone(),
            interpolation: self.interpolation.map(Between::of_rows),
            laws: self.feedback.iter().cloned().map(Law::File).collect(),
            extras: Extras {
                outputs: true,
                energies: true,
                reactions: self.reactions,
                contacts: self.reactions,
                conditions: self.conditions,
                ..Extras::default()
            },
            validity: self.validity(model.info())?,
            ..whole
        };
        let Simulated {
            trajectory,
            failure,
            undefined,
            remarks,
        } = simulated(&model, &motion)?;
        let failure = failure.or(undefined);
        for text in notes(&remarks, &trajectory) {
            note(&text);
        }
        if let Some(path) = &self.csv {
            write_csv(path, &trajectory)?;
        }
        if let Some(path) = &self.plot {
            picture::write(path, &Figure::of_states_and_inputs(&trajectory).to_svg())?;
        }
        if let Some(path) = &self.html {
            let page = model.page(&trajectory, failure.as_deref())?;
            files::write(path, &page)?;
        }
        output::json(self.json.as_deref(), || {
            appell::json::motion(&trajectory, failure.as_deref())
        })?;
        let mut text = summary::text(&trajectory);
        if remarks.undriven && failure.is_none() && summary::rests(&trajectory) {
            text += &hint(model.info(), &self.initial);
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

/// What there is to say about the inputs and the columns of a motion.
fn notes(remarks: &Remarks, trajectory: &Trajectory) -> Vec<String> {
    let held = remarks.held_from.map(|from| {
        let from = number(from);
        format!("the recorded inputs end at {from} s; their last values are held from there on")
    });
    let begins = remarks.begins.as_ref().map(|begins| {
        format!("the run begins at {begins}; to compare with it, begin there too by --initial")
    });
    let differs = remarks.differs.iter().map(|difference| {
        format!("in the run {difference}, which the motion leaves out; --set gives a parameter another value")
    });
    let smooth = (remarks.smooth.as_ref()).map(|remark| format!("{remark} after --interpolation"));
    let renamed = trajectory.renamed().into_iter().map(|[wanted, name]| {
        format!("the spec uses the name `{wanted}`; the computed column is `{name}`")
    });
    let single = held.into_iter().chain(begins);
    single.chain(differs).chain(smooth).chain(renamed).collect()
}

/// Proposes a coordinate, or a pseudo-velocity where a coordinate did not set anything in motion.
fn hint(info: &ModelInfo, tried: &[Assignment]) -> String {
    let is_coordinate = |given: &Assignment| {
        let state = info.state_index(&given.name);
        state.is_some_and(|state| state >= info.speeds)
    };
    let proposed = if tried.iter().any(is_coordinate) {
        info.states.first()
    } else {
        info.coordinate_quantities().last()
    };
    let name = proposed.map_or("NAME", |quantity| quantity.name.as_ref());
    format!(
        "  nothing moves: the mechanism starts in equilibrium and has no input; try `--initial \
         {name}=0.1`\n"
    )
}

/// The motion, under a bar.
pub(super) fn simulated(model: &Model, motion: &Motion) -> Result<Simulated, Error> {
    let clock = progress::clock(motion.t_end);
    let simulated =
        model.simulate_watched(motion, |t| clock.set_position(progress::milliseconds(t)));
    clock.finish_and_clear();
    Ok(simulated?)
}

/// Writes a trajectory as CSV.
pub(super) fn write_csv(path: &Path, trajectory: &Trajectory) -> Result<(), Error> {
    Ok(files::write_with(path, |to| {
        trajectory.write_csv(to, CsvOptions::default())
    })?)
}
