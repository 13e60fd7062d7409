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
use appell_spec::expr::{Expr, Span};
use appell_spec::limits::MAX_FILE;
use appell_spec::mechanism::InputId;
use appell_spec::units::Unit;
use appell_spec::{Code, Diagnostic, Report, Scope, Snippet, formula};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::setup::{Setup, bracketed, instead};
use crate::{Error, files};

mod by_model;
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
        reader.feedback(table.get_ref())
    } else {
        None
    };
    match feedback {
        Some(feedback) if reader.findings.is_empty() => Ok(feedback),
        _ => Err(Report::new(file, text, reader.findings).into()),
    }
}

type Value<'t> = Spanned<DeValue<'t>>;

struct Reader<'r> {
    file: &'r str,
    text: &'r str,
    setup: &'r Setup<'r>,
    findings: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: &str) {
        let diagnostic = Diagnostic::error(code, message).at(at, "");
        self.findings.push(if help.is_empty() {
            diagnostic
        } else {
            diagnostic.help(help)
        });
    }

    /// Parses the file; an invalid entry is reported and skipped, so that all errors are found.
    fn feedback(&mut self, table: &DeTable<'_>) -> Option<Feedback> {
        if let Some(law) = table.get("law") {
            return by_model::read(self, table, law);
        }
        self.keys(table);
        let inputs = self.inputs(table);
        let states = self.list(table, "states", Self::state);
        let switching_times = self.list(table, "switching_times_s", Self::number);
        let desired = self.by_state(table, "desired", Scope::Schedule, "the desired value");
        let initial = self.by_state(table, "initial", Scope::Constant, "the initial value");
        for (state, _, at) in &desired {
            if states
                .as_ref()
                .is_some_and(|states| !states.contains(state))
            {
                let message = "a desired value for a state without a gain";
                let help = "add the state to `states`, with its gain";
                self.tell(Code::UnknownReference, message, at.clone(), help);
            }
        }
        let scheduled = table.get("over").is_some() || table.get("at").is_some();
        let gains = self.gains(table, "gains");
        let sampling = self.sampling(table);
        let pending_gains = self.gains(table, "pending_gains");
        let (inputs, states) = inputs.zip(states)?;
        let offsets = self.offsets(table, &inputs);
        if let Some(gains) = &gains {
            self.count_gains(table, "gains", gains, inputs.len(), states.len());
        }
        let sampled = sampling.map(|sampling| {
            let pending = sampling.pending() * inputs.len();
            if let Some(gains) = &pending_gains {
                self.count_gains(table, "pending_gains", gains, inputs.len(), pending);
            }
            Sampled {
                sampling,
                pending_gains: pending_gains.unwrap_or(vec![vec![0.0; pending]; inputs.len()]),
            }
        });
        let gains = if scheduled {
            schedule::read(self, table, &inputs, &states)?
        } else {
            Gains::Fixed(gains?)
        };
        let wanted = |state: usize| {
            let found = desired.iter().find(|(other, ..)| *other == state);
            found.map(|(_, expr, _)| expr.clone())
        };
        Some(Feedback {
            file: self.file.to_owned(),
            offsets,
            states: states
                .into_iter()
                .map(|state| (state, wanted(state)))
                .collect(),
            gains,
            sampled,
            inputs,
            switching_times: switching_times.unwrap_or_default(),
            initial: initial
                .into_iter()
                .map(|(state, expr, _)| (state, expr))
                .collect(),
        })
    }

    /// Reports unknown and missing keys, and a law for another mechanism.
    fn keys(&mut self, table: &DeTable<'_>) {
        self.known_keys(table, KEYS);
        let needs = "a law needs `input` or `inputs`, `states`, and `gains` or a schedule";
        let replaced = |key: &str| match key {
            "input" => table.get("inputs").is_some(),
            "gains" => table.get("over").is_some() || table.get("at").is_some(),
            _ => false,
        };
        for key in ["input", "states", "gains"] {
            if table.get(key).is_none() && !replaced(key) {
                let message = format!("the key `{key}` is missing");
                self.tell(Code::MissingKey, message, 0..0, needs);
            }
        }
        self.right_mechanism(table);
    }

    fn known_keys(&mut self, table: &DeTable<'_>, known: &[&str]) {
        for key in table.keys() {
            if !known.contains(&key.get_ref().as_ref()) {
                let message = format!("unknown key `{}`", key.get_ref());
                let help = format!("the keys are {}", known.join(", "));
                self.tell(Code::UnknownKey, message, key.span(), &help);
            }
        }
    }

    fn right_mechanism(&mut self, table: &DeTable<'_>) {
        let ours = &self.setup.mechanism.name;
        if let Some((name, at)) = table.get("mechanism").and_then(|value| self.string(value))
            && name != *ours
        {
            let message = format!("the law is for `{name}`, not for `{ours}`");
            self.tell(Code::UnknownReference, message, at, "");
        }
    }

    /// The inputs of the law.
    fn inputs(&mut self, table: &DeTable<'_>) -> Option<Vec<usize>> {
        match (table.get("input"), table.get("inputs")) {
            (Some(_), Some(both)) => {
                let message = "a law has `input` or `inputs`, not both";
                self.tell(Code::UnknownKey, message, both.span(), "remove one of them");
                None
            }
            (Some(one), None) => Some(vec![self.input(one)?]),
            (None, _) => self.list(table, "inputs", Self::input),
        }
    }

    fn input(&mut self, value: &Value<'_>) -> Option<usize> {
        let (name, at) = self.string(value)?;
        let inputs = self.setup.mechanism.inputs.iter();
        let names: Vec<String> = inputs.map(|input| input.label.name.clone()).collect();
        self.find(&name, "input", &names, at)
    }

    /// One expression, or a list of them for several inputs.
    fn offsets(&mut self, table: &DeTable<'_>, inputs: &[usize]) -> Vec<Option<Expr>> {
        let Some(value) = table.get("offset") else {
            return vec![None; inputs.len()];
        };
        let values = match value.get_ref() {
            DeValue::Array(values) => values.iter().collect(),
            _ => vec![value],
        };
        self.count("offset", values.len(), "input", inputs.len(), value.span());
        let setup = self.setup;
        let units = inputs
            .iter()
            .map(|&input| &setup.mechanism.inputs[InputId::new(input)].label.unit);
        let pairs = values.into_iter().zip(units);
        pairs
            .map(|(value, unit)| self.expression(value, Scope::Law, "the offset", unit))
            .collect()
    }

    /// Numbers: a list for one input, a list of lists for several.
    fn gains(&mut self, table: &DeTable<'_>, key: &'static str) -> Option<Vec<Vec<f64>>> {
        let first = table.get(key)?.get_ref().get(0);
        if first.is_some_and(|first| first.get_ref().is_array()) {
            self.list(table, key, Self::numbers)
        } else {
            Some(vec![self.list(table, key, Self::number)?])
        }
    }

    /// Reports gains that do not form a list for each input with a number for each column.
    fn count_gains(
        &mut self,
        table: &DeTable<'_>,
        key: &'static str,
        gains: &[Vec<f64>],
        inputs: usize,
        columns: usize,
    ) {
        let at = table.get(key).map_or(0..0, Spanned::span);
        self.count("list of gains", gains.len(), "input", inputs, at.clone());
        let what = if key == "gains" {
            "state"
        } else {
            "pending input"
        };
        for row in gains {
            self.count("gain", row.len(), what, columns, at.clone());
        }
    }

    /// Reports a wrong number of entries.
    fn count(&mut self, what: &str, given: usize, each: &str, needed: usize, at: Span) {
        if given != needed {
            let plural = |count: usize, noun: &str| {
                let ending = if count == 1 { "" } else { "s" };
                format!("{count} {noun}{ending}")
            };
            let message = format!("{} for {}", plural(given, what), plural(needed, each));
            let help = format!("write one {what} for each {each}, in the same order");
            self.tell(Code::WrongType, message, at, &help);
        }
    }

    /// Sampling of the controller; `None` for a continuous-time or an invalid one.
    fn sampling(&mut self, table: &DeTable<'_>) -> Option<Sampling> {
        let Some(period) = table.get("sampled_ms") else {
            for key in ["delay_ms", "pending_gains"] {
                if let Some(value) = table.get(key) {
                    let message = format!("`{key}` needs `sampled_ms`");
                    let help = "only a discrete-time controller has a delay";
                    self.tell(Code::MissingKey, message, value.span(), help);
                }
            }
            return None;
        };
        let delay = match table.get("delay_ms") {
            Some(delay) => self.number(delay)?,
            None => 0.0,
        };
        match Sampling::new(self.number(period)? / 1e3, delay / 1e3) {
            Ok(sampling) => Some(sampling),
            Err(error) => {
                self.tell(Code::WrongType, error.to_string(), period.span(), "");
                None
            }
        }
    }

    fn numbers(&mut self, value: &Value<'_>) -> Option<Vec<f64>> {
        let DeValue::Array(elements) = value.get_ref() else {
            let help = "write a list of numbers for each input";
            self.tell(
                Code::WrongType,
                "expected a list of numbers",
                value.span(),
                help,
            );
            return None;
        };
        let read: Vec<Option<f64>> = elements.iter().map(|value| self.number(value)).collect();
        read.into_iter().collect()
    }

    /// A list under a key; nothing where the key or an element is missing or wrong.
    fn list<T>(
        &mut self,
        table: &DeTable<'_>,
        key: &str,
        element: fn(&mut Self, &Value<'_>) -> Option<T>,
    ) -> Option<Vec<T>> {
        let value = table.get(key)?;
        let DeValue::Array(elements) = value.get_ref() else {
            self.tell(
                Code::WrongType,
                format!("`{key}` must be a list"),
                value.span(),
                "write it in brackets",
            );
            return None;
        };
        let read: Vec<Option<T>> = elements.iter().map(|value| element(self, value)).collect();
        read.into_iter().collect()
    }

    /// Expressions by the name of a state, with the place of each.
    fn by_state(
        &mut self,
        table: &DeTable<'_>,
        key: &str,
        scope: Scope,
        what: &'static str,
    ) -> Vec<(usize, Expr, Span)> {
        let Some(value) = table.get(key) else {
            return Vec::new();
        };
        let DeValue::Table(entries) = value.get_ref() else {
            let help = "write `name = \"expression\"` for each state";
            self.tell(
                Code::WrongType,
                format!("`{key}` must be a table"),
                value.span(),
                help,
            );
            return Vec::new();
        };
        let mut read = Vec::new();
        for (name, value) in entries {
            let Some(state) = self.find(name.get_ref(), "state", &self.states(), name.span())
            else {
                continue;
            };
            let unit = self.setup.unit_of_state(state);
            if let Some(expr) = self.expression(value, scope, what, unit) {
                read.push((state, expr, name.span()));
            }
        }
        read
    }

    /// The value of a quantity: a number, a number with a unit, or an expression.
    fn expression(
        &mut self,
        value: &Value<'_>,
        scope: Scope,
        what: &'static str,
        unit: &Unit,
    ) -> Option<Expr> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(_) | DeValue::Float(_) => self.text[value.span()].to_owned(),
            _ => {
                self.tell(
                    Code::WrongType,
                    "expected an expression, as a string",
                    value.span(),
                    "",
                );
                return None;
            }
        };
        let text = bracketed(text.trim());
        let snippet = Snippet {
            document: self.text,
            text: &text,
            whole: value.span(),
        };
        match formula(self.setup.spec, &snippet, what, scope, unit) {
            Ok(expr) => Some(expr),
            Err(findings) => {
                self.findings.extend(findings);
                None
            }
        }
    }

    fn states(&self) -> Vec<String> {
        self.setup
            .info
            .states
            .iter()
            .map(|state| state.name.to_string())
            .collect()
    }

    fn state(&mut self, value: &Value<'_>) -> Option<usize> {
        let (name, at) = self.string(value)?;
        self.find(&name, "state", &self.states(), at)
    }

    /// Position of a name; tells where it is unknown.
    fn find(&mut self, name: &str, what: &str, names: &[String], at: Span) -> Option<usize> {
        let found = names.iter().position(|other| other == name);
        if found.is_none() {
            let help = instead(name, names.iter().map(String::as_str));
            self.tell(
                Code::UnknownName,
                format!("there is no {what} `{name}`"),
                at,
                &help,
            );
        }
        found
    }

    fn string(&mut self, value: &Value<'_>) -> Option<(String, Span)> {
        if let DeValue::String(text) = value.get_ref() {
            return Some((text.to_string(), value.span()));
        }
        self.tell(
            Code::WrongType,
            "expected a name, as a string",
            value.span(),
            "put it in quotes",
        );
        None
    }

    fn number(&mut self, value: &Value<'_>) -> Option<f64> {
        let text = match value.get_ref() {
            DeValue::Integer(number) => number.as_str().to_owned(),
            DeValue::Float(number) => number.as_str().to_owned(),
            _ => String::new(),
        };
        match text.replace('_', "").parse::<f64>() {
            Ok(number) if number.is_finite() => Some(number),
            _ => {
                self.tell(
                    Code::WrongType,
                    "expected a finite number",
                    value.span(),
                    "",
                );
                None
            }
        }
    }
}
