//! The cases of `appell evaluate`, with every mistake told at its place in the file.

use std::collections::BTreeMap;

use appell_runtime::model::{ModelInfo, Quantity};
use appell_spec::expr::Span;
use appell_spec::{Code, Diagnostic, Report};
use serde_json::value::RawValue;

use crate::failure::Failure;
use crate::setup::instead;

/// Where the equations are evaluated, in SI.
#[derive(Debug)]
pub(crate) struct Case {
    /// Time in s.
    pub(crate) t: f64,
    /// State.
    pub(crate) x: Vec<f64>,
    /// Inputs; those left out are zero, or the value of their signal.
    pub(crate) u: Vec<Option<f64>>,
    /// Parameters.
    pub(crate) p: Vec<f64>,
}

/// An object of a JSON text whose values keep their places.
type Object<'a> = BTreeMap<String, &'a RawValue>;

/// Reads `{"cases": [{"parameters": {…}, "state": {…}, "inputs": {…}, "t": 0}, …]}`.
pub(crate) fn read_cases(file: &str, text: &str, info: &ModelInfo) -> Result<Vec<Case>, Failure> {
    let top: Object<'_> = serde_json::from_str(text).map_err(|error| broken(file, text, &error))?;
    let mut reader = Reader {
        text,
        findings: Vec::new(),
    };
    reader.keys(&top, 0..0, &["cases"]);
    let cases: Vec<&RawValue> = match top.get("cases") {
        Some(list) => reader.parse(list, "a list of cases"),
        None => None,
    }
    .unwrap_or_default();
    let cases = cases
        .into_iter()
        .map(|raw| reader.case(raw, info))
        .collect();
    if reader.findings.is_empty() {
        Ok(cases)
    } else {
        Err(Failure::Reports(vec![Report::new(
            file,
            text,
            reader.findings,
        )]))
    }
}

/// JSON that does not parse ends at its first mistake.
fn broken(file: &str, text: &str, error: &serde_json::Error) -> Failure {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let shown: String = text
        .lines()
        .nth(line.saturating_sub(1))
        .unwrap_or_default()
        .chars()
        .take(160)
        .collect();
    Failure::Data(format!(
        "not the JSON expected: {message}\n  --> {file}:{line}:{column}\n{line:>4} | {shown}"
    ))
}

struct Reader<'a> {
    text: &'a str,
    findings: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    /// Where a value stands: it is a part of the text.
    fn span(&self, raw: &RawValue) -> Span {
        let start = (raw.get().as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..(start + raw.get().len()).min(self.text.len())
    }

    /// The start of a value; whole objects would fill the screen.
    fn head(&self, raw: &RawValue) -> Span {
        let span = self.span(raw);
        span.start..(span.start + 1).min(span.end)
    }

    fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: impl Into<String>) {
        self.findings
            .push(Diagnostic::error(code, message).at(at, "").help(help));
    }

    fn parse<T: serde::Deserialize<'a>>(&mut self, raw: &'a RawValue, wanted: &str) -> Option<T> {
        let parsed = serde_json::from_str(raw.get()).ok();
        if parsed.is_none() {
            self.tell(
                Code::WrongType,
                format!("this is not {wanted}"),
                self.head(raw),
                format!("write {wanted}"),
            );
        }
        parsed
    }

    fn keys(&mut self, object: &Object<'_>, at: Span, known: &[&str]) {
        for (key, value) in object {
            if !known.contains(&key.as_str()) {
                let help = format!("the keys are {}", known.join(", "));
                self.tell(
                    Code::UnknownKey,
                    format!("unknown key `{key}`"),
                    self.head(value),
                    help,
                );
            }
        }
        let required = if known.contains(&"state") {
            "state"
        } else {
            "cases"
        };
        if !object.contains_key(required) {
            self.tell(
                Code::MissingKey,
                format!("the key `{required}` is missing"),
                at,
                format!("add \"{required}\""),
            );
        }
    }

    fn case(&mut self, raw: &'a RawValue, info: &ModelInfo) -> Case {
        let object: Object<'a> = self.parse(raw, "an object").unwrap_or_default();
        self.keys(
            &object,
            self.head(raw),
            &["parameters", "state", "inputs", "t"],
        );
        let mut numbers = |key: &str, what: &str, list: &[Quantity]| match object.get(key) {
            Some(raw) => self.numbers(raw, what, list),
            None => vec![None; list.len()],
        };
        let state = numbers("state", "state", &info.states);
        let u = numbers("inputs", "input", &info.inputs);
        let parameters = numbers("parameters", "parameter", &info.parameters);
        if let Some(raw) = object.get("state") {
            let given = info.states.iter().zip(&state);
            let missing: Vec<&str> = given
                .filter(|(_, value)| value.is_none())
                .map(|(q, _)| q.name.as_ref())
                .collect();
            // A wrong number has been told already.
            let named: Object<'a> = serde_json::from_str(raw.get()).unwrap_or_default();
            let missing: Vec<&str> = missing
                .into_iter()
                .filter(|name| !named.contains_key(*name))
                .collect();
            if !missing.is_empty() {
                let message = format!("the state lacks {}", missing.join(", "));
                self.tell(
                    Code::MissingKey,
                    message,
                    self.head(raw),
                    "give a number in SI for every state",
                );
            }
        }
        let t = object.get("t").and_then(|raw| self.number(raw));
        Case {
            t: t.unwrap_or(0.0),
            x: state
                .into_iter()
                .map(|value| value.unwrap_or(0.0))
                .collect(),
            u,
            p: parameters
                .iter()
                .zip(info.parameters.iter())
                .map(|(v, q)| v.unwrap_or(q.value))
                .collect(),
        }
    }

    /// Numbers by name, in the order of a list.
    fn numbers(&mut self, raw: &'a RawValue, what: &str, list: &[Quantity]) -> Vec<Option<f64>> {
        let mut values = vec![None; list.len()];
        let object: Object<'a> = self.parse(raw, "an object of numbers").unwrap_or_default();
        for (name, raw) in object {
            if let Some(index) = list.iter().position(|quantity| quantity.name == name) {
                values[index] = self.number(raw);
                continue;
            }
            let names = list.iter().map(|quantity| quantity.name.as_ref());
            let help = instead(&name, names);
            let message = format!("there is no {what} `{name}`");
            self.tell(Code::UnknownName, message, self.span(raw), help);
        }
        values
    }

    fn number(&mut self, raw: &'a RawValue) -> Option<f64> {
        let number: Option<f64> = serde_json::from_str(raw.get())
            .ok()
            .filter(|x: &f64| x.is_finite());
        if number.is_none() {
            self.tell(
                Code::WrongType,
                "this is not a finite number",
                self.head(raw),
                "write a number in SI",
            );
        }
        number
    }
}
