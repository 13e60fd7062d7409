//! Entries of a feedback file: names of states and inputs, numbers, lists and expressions.

use appell_spec::expr::{Expr, Span};
use appell_spec::mechanism::InputId;
use appell_spec::units::Unit;
use appell_spec::{Code, Diagnostic, Scope, Snippet, formula};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::setup::{Setup, bracketed, instead};

pub(super) type Value<'t> = Spanned<DeValue<'t>>;

/// Reader of a file, with its findings.
pub(super) struct Reader<'r> {
    pub(super) file: &'r str,
    pub(super) text: &'r str,
    pub(super) setup: &'r Setup<'r>,
    pub(super) findings: Vec<Diagnostic>,
}

impl Reader<'_> {
    pub(super) fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: &str) {
        let diagnostic = Diagnostic::error(code, message).at(at, "");
        self.findings.push(if help.is_empty() {
            diagnostic
        } else {
            diagnostic.help(help)
        });
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
        let inputs = self.setup.mechanism.inputs.iter();
        let names: Vec<String> = inputs.map(|input| input.label.name.clone()).collect();
        self.find(&name, "input", &names, at)
    }

    /// One expression, or a list of them for several inputs.
    pub(super) fn offsets(&mut self, table: &DeTable<'_>, inputs: &[usize]) -> Vec<Option<Expr>> {
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

    /// A list under a key; nothing if the key is missing or an element is invalid.
    pub(super) fn list<T>(
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
    pub(super) fn expression(
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

    pub(super) fn states(&self) -> Vec<String> {
        self.setup
            .info
            .states
            .iter()
            .map(|state| state.name.to_string())
            .collect()
    }

    pub(super) fn state(&mut self, value: &Value<'_>) -> Option<usize> {
        let (name, at) = self.string(value)?;
        self.find(&name, "state", &self.states(), at)
    }

    /// Index of a name; an unknown one is reported.
    pub(super) fn find(
        &mut self,
        name: &str,
        what: &str,
        names: &[String],
        at: Span,
    ) -> Option<usize> {
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

    pub(super) fn string(&mut self, value: &Value<'_>) -> Option<(String, Span)> {
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

    pub(super) fn number(&mut self, value: &Value<'_>) -> Option<f64> {
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
