//! Entries of a feedback file: names of states and inputs, numbers, lists and expressions.

use appell_analysis::control::sampled::Sampling;
use appell_runtime::model::Quantity;
use appell_spec::expr::{Expr, Span};
use appell_spec::units::Unit;
use appell_spec::{Code, Diagnostic, Scope, Snippet, formula};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::setup::{Setup, bracketed, instead};

pub(super) type Value<'t> = Spanned<DeValue<'t>>;

/// Reader of a file, with its findings.
pub(super) struct Reader<'r> {
    pub(super) text: &'r str,
    pub(super) setup: &'r Setup<'r>,
    pub(super) findings: Vec<Diagnostic>,
}

impl Reader<'_> {
    pub(super) fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: &str) {
        let help = (!help.is_empty()).then(|| help.to_owned());
        let diagnostic = Diagnostic::error(code, message).at(at, "");
        self.findings.push(diagnostic.maybe_help(help));
    }

    pub(super) fn wrong_type(&mut self, value: &Value<'_>, message: impl Into<String>, help: &str) {
        self.tell(Code::WrongType, message, value.span(), help);
    }

    pub(super) fn missing(&mut self, key: &str, help: &str) {
        let message = format!("the key `{key}` is missing");
        self.tell(Code::MissingKey, message, 0..0, help);
    }

    pub(super) fn known_keys(&mut self, table: &DeTable<'_>, known: &[&str]) {
        for key in table.keys() {
            if !known.contains(&key.get_ref().as_ref()) {
                let message = format!("unknown key `{}`", key.get_ref());
                let help = format!("the keys are {}", known.join(", "));
                self.tell(Code::UnknownKey, message, key.span(), &help);
            }
        }
    }

    pub(super) fn right_mechanism(&mut self, table: &DeTable<'_>) {
        let ours = &self.setup.mechanism.name;
        if let Some((name, at)) = table.get("mechanism").and_then(|value| self.string(value))
            && name != *ours
        {
            let message = format!("the law is for `{name}`, not for `{ours}`");
            self.tell(Code::UnknownReference, message, at, "");
        }
    }

    /// Sampling of the controller; `None` for a continuous-time or an invalid one.
    pub(super) fn sampling(&mut self, table: &DeTable<'_>) -> Option<Sampling> {
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
        let sampling = Sampling::new(self.number(period)? / 1e3, delay / 1e3);
        sampling
            .map_err(|error| self.wrong_type(period, error.to_string(), ""))
            .ok()
    }

    /// The inputs of the law.
    pub(super) fn inputs(&mut self, table: &DeTable<'_>) -> Option<Vec<usize>> {
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

    pub(super) fn input(&mut self, value: &Value<'_>) -> Option<usize> {
        let (name, at) = self.string(value)?;
        self.find(&name, "input", self.setup.declared_inputs().iter(), at)
    }

    pub(super) fn state(&mut self, value: &Value<'_>) -> Option<usize> {
        let (name, at) = self.string(value)?;
        self.find(&name, "state", self.setup.info.states.iter(), at)
    }

    /// Offsets of inputs: one expression, or a list of them for several inputs.
    pub(super) fn offsets(&mut self, table: &DeTable<'_>, inputs: &[usize]) -> Vec<(usize, Expr)> {
        let Some(value) = table.get("offset") else {
            return Vec::new();
        };
        let values = match value.get_ref() {
            DeValue::Array(values) => values.iter().collect(),
            _ => vec![value],
        };
        self.count("offset", values.len(), "input", inputs.len(), value.span());
        let setup = self.setup;
        let pairs = values.into_iter().zip(inputs);
        let offsets = pairs.filter_map(|(value, &input)| {
            let unit = setup.unit_of_input(input);
            Some((
                input,
                self.expression(value, Scope::Law, "the offset", unit)?,
            ))
        });
        offsets.collect()
    }

    /// Numbers: a list for one input, a list of lists for several.
    pub(super) fn gains(
        &mut self,
        table: &DeTable<'_>,
        key: &'static str,
    ) -> Option<Vec<Vec<f64>>> {
        let first = table.get(key)?.get_ref().get(0);
        if first.is_some_and(|first| first.get_ref().is_array()) {
            self.list(table, key, Self::numbers)
        } else {
            Some(vec![self.list(table, key, Self::number)?])
        }
    }

    /// Reports gains that do not form a list for each input with a number for each column.
    pub(super) fn count_gains(
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
    pub(super) fn count(&mut self, what: &str, given: usize, each: &str, needed: usize, at: Span) {
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

    pub(super) fn numbers(&mut self, value: &Value<'_>) -> Option<Vec<f64>> {
        let DeValue::Array(elements) = value.get_ref() else {
            let help = "write a list of numbers for each input";
            self.wrong_type(value, "expected a list of numbers", help);
            return None;
        };
        let read: Vec<Option<f64>> = elements.iter().map(|value| self.number(value)).collect();
        read.into_iter().collect()
    }

    /// A list under a key; nothing if the key is missing or an element is invalid.
    pub(super) fn list<T>(
        &mut self,
        table: &DeTable<'_>,
        key: &str,
        element: fn(&mut Self, &Value<'_>) -> Option<T>,
    ) -> Option<Vec<T>> {
        let value = table.get(key)?;
        let DeValue::Array(elements) = value.get_ref() else {
            let message = format!("`{key}` must be a list");
            self.wrong_type(value, message, "write it in brackets");
            return None;
        };
        let read: Vec<Option<T>> = elements.iter().map(|value| element(self, value)).collect();
        read.into_iter().collect()
    }

    /// Expressions by the name of a state, with the position of each.
    pub(super) fn by_state(
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
            self.wrong_type(value, format!("`{key}` must be a table"), help);
            return Vec::new();
        };
        let setup = self.setup;
        let entries = entries.iter().filter_map(|(name, value)| {
            let states = setup.info.states.iter();
            let state = self.find(name.get_ref(), "state", states, name.span())?;
            let unit = setup.unit_of_state(state);
            let expr = self.expression(value, scope, what, unit)?;
            Some((state, expr, name.span()))
        });
        entries.collect()
    }

    /// The value of a quantity: a number, a number with a unit, or an expression.
    pub(super) fn expression(
        &mut self,
        value: &Value<'_>,
        scope: Scope,
        what: &'static str,
        unit: &Unit,
    ) -> Option<Expr> {
        let text = match value.get_ref() {
            DeValue::String(text) => text.as_ref(),
            DeValue::Integer(_) | DeValue::Float(_) => &self.text[value.span()],
            _ => {
                self.wrong_type(value, "expected an expression, as a string", "");
                return None;
            }
        };
        let text = bracketed(text.trim());
        let snippet = Snippet {
            document: self.text,
            text: &text,
            whole: value.span(),
        };
        formula(self.setup.spec, &snippet, what, scope, unit)
            .map_err(|findings| self.findings.extend(findings))
            .ok()
    }

    /// Index of the quantity of a name; an unknown one is reported.
    pub(super) fn find<'q>(
        &mut self,
        name: &str,
        what: &str,
        among: impl Iterator<Item = &'q Quantity> + Clone,
        at: Span,
    ) -> Option<usize> {
        let names = among.map(|quantity| quantity.name.as_ref());
        let found = names.clone().position(|other| other == name);
        if found.is_none() {
            let message = format!("there is no {what} `{name}`");
            self.tell(Code::UnknownName, message, at, &instead(name, names));
        }
        found
    }

    pub(super) fn string(&mut self, value: &Value<'_>) -> Option<(String, Span)> {
        if let DeValue::String(text) = value.get_ref() {
            return Some((text.to_string(), value.span()));
        }
        self.wrong_type(value, "expected a name, as a string", "put it in quotes");
        None
    }

    pub(super) fn number(&mut self, value: &Value<'_>) -> Option<f64> {
        let text = match value.get_ref() {
            DeValue::Integer(number) => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => "",
        };
        let number = text.replace('_', "").parse::<f64>().ok();
        let number = number.filter(|number| number.is_finite());
        if number.is_none() {
            self.wrong_type(value, "expected a finite number", "");
        }
        number
    }
}
