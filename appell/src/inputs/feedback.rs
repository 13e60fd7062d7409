//! Feedback files: `u = offset - K (y - y_desired(t))`, y being some of the states.
//!
//! ```toml
//! input  = "u"                             # or inputs = ["u", "v"], with a list of gains for each
//! states = ["theta", "omega_1"]
//! gains  = [40, 12]
//! sampled_ms = 10                          # sampling period; inputs are held in between
//! delay_ms = 5                             # from a measurement to its effect
//! pending_gains = [0.1]                    # gains of inputs that do not act yet
//! switching_times_s = [2]                  # where a desired value jumps or kinks
//! desired = { theta = "if(t < 2, 0, 0.1)" }
//! initial = { theta = "5deg" }             # unless the request sets it
//! ```
//!
//! A law with the key `law` computes its inputs by inverse dynamics ([`Aim`]).
//!
//! A gain-scheduled law has, instead of `gains` and `offset`, the scheduling variable `over`, a state or
//! parameter, and a table `[[at]]` for each of its values.

use std::path::Path;

use appell_analysis::control::sampled::Sampling;
use appell_analysis::control::schedule::GainSchedule;
use appell_spec::expr::Expr;
use appell_spec::limits::MAX_FILE;
use appell_spec::{Code, Diagnostic, Report, Scope};
use toml::de::DeTable;

use crate::setup::Setup;
use crate::{Error, files};
use reading::Reader;

mod by_model;
mod reading;
mod schedule;

pub use by_model::{Aim, Followed, ModelLaw};
pub use schedule::SchedulingVariable;

/// A law for one input or several.
#[derive(Debug)]
pub struct Feedback {
    /// The file.
    pub file: String,
    /// The inputs.
    pub inputs: Vec<usize>,
    /// Offset of each input.
    pub offsets: Vec<Option<Expr>>,
    /// The states, with their desired values.
    pub states: Vec<(usize, Option<Expr>)>,
    /// In SI.
    pub gains: Gains,
    /// Sampling of a discrete-time controller.
    pub sampled: Option<Sampled>,
    /// Times in s at which the law has a jump or a kink.
    pub switching_times: Vec<f64>,
    /// Initial values by state.
    pub initial: Vec<(usize, Expr)>,
}

impl Feedback {
    /// A law of gains alone.
    fn of(inputs: Vec<usize>, gains: Gains) -> Self {
        Self {
            file: String::new(),
            offsets: vec![None; inputs.len()],
            states: Vec::new(),
            gains,
            sampled: None,
            switching_times: Vec::new(),
            initial: Vec::new(),
            inputs,
        }
    }

    /// Sets the initial values of the law.
    pub fn start(&self, setup: &mut Setup<'_>) -> Result<(), Error> {
        for (state, expr) in &self.initial {
            let told = |message| Error::data(&self.file, message);
            let name = &setup.info.states[*state].name;
            let value = setup.constant(expr).ok_or_else(|| {
                told(format!(
                    "the initial value of `{name}` is not a finite number"
                ))
            })?;
            setup.place(*state, value).map_err(told)?;
        }
        Ok(())
    }
}

/// Gains of a law.
#[derive(Debug)]
pub enum Gains {
    /// A row for each input, a number for each state.
    Fixed(Vec<Vec<f64>>),
    /// Gains that depend on a scheduling variable.
    Scheduled(SchedulingVariable, GainSchedule),
    /// None: the inputs follow from the equations of motion.
    ByModel(ModelLaw),
}

/// A discrete-time controller.
#[derive(Debug)]
pub struct Sampled {
    /// Sampling period and delay.
    pub sampling: Sampling,
    /// A row for each input: gains of the pending inputs, those of the oldest measurement first.
    pub pending_gains: Vec<Vec<f64>>,
}

const KEYS: &[&str] = &[
    "about",
    "at",
    "mechanism",
    "input",
    "inputs",
    "law",
    "offset",
    "over",
    "states",
    "gains",
    "sampled_ms",
    "delay_ms",
    "pending_gains",
    "switching_times_s",
    "desired",
    "initial",
];

/// Reads a feedback file.
pub fn read(path: &Path, setup: &Setup<'_>) -> Result<Feedback, Error> {
    parse(
        &path.to_string_lossy(),
        &files::read(path, MAX_FILE as u64)?,
        setup,
    )
}

/// Reads the text of a feedback file.
pub fn parse(file: &str, text: &str, setup: &Setup<'_>) -> Result<Feedback, Error> {
    let mut reader = Reader {
        file,
        text,
        setup,
        findings: Vec::new(),
    };
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        let message = error.message().lines().next().unwrap_or_default();
        let at = error.span().unwrap_or(0..0);
        reader
            .findings
            .push(Diagnostic::error(Code::TomlSyntax, message).at(at, ""));
    }
    let feedback = if errors.is_empty() {
        feedback(&mut reader, table.get_ref())
    } else {
        None
    };
    match feedback {
        Some(feedback) if reader.findings.is_empty() => Ok(feedback),
        _ => Err(Report::new(file, text, reader.findings).into()),
    }
}

/// Parses the file; an invalid entry is reported and skipped, so that all errors are found.
fn feedback(reader: &mut Reader<'_>, table: &DeTable<'_>) -> Option<Feedback> {
    let switching_times = reader.list(table, "switching_times_s", Reader::number);
    let initial = reader.by_state(table, "initial", Scope::Constant, "the initial value");
    let law = match table.get("law") {
        Some(law) => {
            let (inputs, law) = by_model::read(reader, table, law)?;
            let sampled = sampling(reader, table).map(|sampling| Sampled {
                sampling,
                pending_gains: Vec::new(),
            });
            Feedback {
                sampled,
                ..Feedback::of(inputs, Gains::ByModel(law))
            }
        }
        None => by_gains(reader, table)?,
    };
    Some(Feedback {
        file: reader.file.to_owned(),
        switching_times: switching_times.unwrap_or_default(),
        initial: initial
            .into_iter()
            .map(|(state, expr, _)| (state, expr))
            .collect(),
        ..law
    })
}

/// A law `u = offset - K (y - y_desired)`.
fn by_gains(reader: &mut Reader<'_>, table: &DeTable<'_>) -> Option<Feedback> {
    keys(reader, table);
    let inputs = reader.inputs(table);
    let states = reader.list(table, "states", Reader::state);
    let desired = reader.by_state(table, "desired", Scope::Schedule, "the desired value");
    for (state, _, at) in &desired {
        if states
            .as_ref()
            .is_some_and(|states| !states.contains(state))
        {
            let message = "a desired value for a state without a gain";
            let help = "add the state to `states`, with its gain";
            reader.tell(Code::UnknownReference, message, at.clone(), help);
        }
    }
    let scheduled = table.get("over").is_some() || table.get("at").is_some();
    let gains = reader.gains(table, "gains");
    let sampling = sampling(reader, table);
    let pending_gains = reader.gains(table, "pending_gains");
    let (inputs, states) = inputs.zip(states)?;
    let offsets = reader.offsets(table, &inputs);
    if let Some(gains) = &gains {
        reader.count_gains(table, "gains", gains, inputs.len(), states.len());
    }
    let sampled = sampling.map(|sampling| {
        let pending = sampling.pending() * inputs.len();
        if let Some(gains) = &pending_gains {
            reader.count_gains(table, "pending_gains", gains, inputs.len(), pending);
        }
        Sampled {
            sampling,
            pending_gains: pending_gains.unwrap_or(vec![vec![0.0; pending]; inputs.len()]),
        }
    });
    let gains = if scheduled {
        let (over, schedule) = schedule::read(reader, table, &inputs, &states)?;
        Gains::Scheduled(over, schedule)
    } else {
        Gains::Fixed(gains?)
    };
    let wanted = |state: usize| {
        let found = desired.iter().find(|(other, ..)| *other == state);
        found.map(|(_, expr, _)| expr.clone())
    };
    Some(Feedback {
        offsets,
        states: states
            .into_iter()
            .map(|state| (state, wanted(state)))
            .collect(),
        sampled,
        ..Feedback::of(inputs, gains)
    })
}

/// Reports unknown and missing keys, and a law for another mechanism.
fn keys(reader: &mut Reader<'_>, table: &DeTable<'_>) {
    reader.known_keys(table, KEYS);
    let needs = "a law needs `input` or `inputs`, `states`, and `gains` or a schedule";
    let replaced = |key: &str| match key {
        "input" => table.get("inputs").is_some(),
        "gains" => table.get("over").is_some() || table.get("at").is_some(),
        _ => false,
    };
    for key in ["input", "states", "gains"] {
        if table.get(key).is_none() && !replaced(key) {
            let message = format!("the key `{key}` is missing");
            reader.tell(Code::MissingKey, message, 0..0, needs);
        }
    }
    reader.right_mechanism(table);
}

/// Sampling of the controller; `None` for a continuous-time or an invalid one.
fn sampling(reader: &mut Reader<'_>, table: &DeTable<'_>) -> Option<Sampling> {
    let Some(period) = table.get("sampled_ms") else {
        for key in ["delay_ms", "pending_gains"] {
            if let Some(value) = table.get(key) {
                let message = format!("`{key}` needs `sampled_ms`");
                let help = "only a discrete-time controller has a delay";
                reader.tell(Code::MissingKey, message, value.span(), help);
            }
        }
        return None;
    };
    let delay = match table.get("delay_ms") {
        Some(delay) => reader.number(delay)?,
        None => 0.0,
    };
    match Sampling::new(reader.number(period)? / 1e3, delay / 1e3) {
        Ok(sampling) => Some(sampling),
        Err(error) => {
            reader.tell(Code::WrongType, error.to_string(), period.span(), "");
            None
        }
    }
}
