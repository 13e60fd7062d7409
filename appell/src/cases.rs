//! Cases at which equations are evaluated; every error is reported with its position in the file.

use std::collections::BTreeSet;
use std::fmt;

use appell_runtime::model::{ModelInfo, Quantity};
use appell_spec::expr::Span;
use appell_spec::{Code, Diagnostic, Report};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use crate::Error;
use crate::evaluation::quantities;
use crate::setup::instead;

/// Arguments of the equations, in SI.
#[derive(Debug)]
pub struct Case {
    /// Time in s.
    pub t: f64,
    /// State.
    pub x: Vec<f64>,
    /// Inputs; omitted ones are zero, or the value of their signal.
    pub u: Vec<Option<f64>>,
    /// Parameters.
    pub p: Vec<f64>,
    /// Pseudo-accelerations for inverse dynamics, if requested; omitted ones are zero.
    pub accelerations: Option<Vec<f64>>,
}

/// The entries of a JSON object in the order of the text; values keep their positions.
#[derive(Default)]
struct Object<'a>(Vec<(String, &'a RawValue)>);

impl<'a> Object<'a> {
    fn get(&self, key: &str) -> Option<&'a RawValue> {
        let found = self.0.iter().find(|(name, _)| name == key);
        found.map(|(_, value)| *value)
    }
}

impl<'de> Deserialize<'de> for Object<'de> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = Object<'de>;

            fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
                to.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Object<'de>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Object(entries))
            }
        }
        from.deserialize_map(Entries)
    }
}

/// Largest file of cases, in bytes.
pub const MAX_BYTES: u64 = 1 << 28;

/// Maximum number of errors reported for a file.
const MOST: usize = 20;

/// Validated cases, as text of their file: each is parsed on request, so that memory does not grow with their
/// number.
pub struct Cases<'a> {
    text: &'a str,
    info: &'a ModelInfo,
    list: Vec<&'a RawValue>,
    quantities: BTreeSet<&'static str>,
}

impl<'a> Cases<'a> {
    /// Reads `{"cases": [{"parameters": {…}, "state": {…}, "inputs": {…}, "t": 0}, …]}`; a case may have
    /// `"accelerations"` by pseudo-velocity. A list `"quantities"` beside the cases names the wanted ones, by default
    /// all. All errors are reported at once.
    pub fn read(file: &str, text: &'a str, info: &'a ModelInfo) -> Result<Self, Error> {
        let mut reader = Reader::new(text);
        let (list, quantities) = match serde_json::from_str(text) {
            Ok(top) => reader.top(top),
            Err(error) => {
                reader.broken(&error);
                Default::default()
            }
        };
        for case in &list {
            if reader.findings.len() >= MOST {
                break;
            }
            reader.case(case, info);
        }
        if reader.findings.is_empty() {
            Ok(Self {
                text,
                info,
                list,
                quantities,
            })
        } else {
            Err(Report::new(file, text, reader.findings).into())
        }
    }

    /// The quantities to be evaluated.
    pub fn quantities(&self) -> BTreeSet<&'static str> {
        self.quantities.clone()
    }

    /// The cases in the order of the file.
    pub fn iter(&self) -> impl Iterator<Item = Case> {
        let mut reader = Reader::new(self.text);
        let cases = self.list.iter();
        cases.map(move |case| reader.case(case, self.info))
    }
}

struct Reader<'a> {
    text: &'a str,
    findings: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            text,
            findings: Vec::new(),
        }
    }

    /// Reports the first syntax error.
    fn broken(&mut self, error: &serde_json::Error) {
        let line = error.line().saturating_sub(1);
        let before: usize = self
            .text
            .split_inclusive('\n')
            .take(line)
            .map(str::len)
            .sum();
        let at = before + error.column().saturating_sub(1);
        // In a truncated text the error follows the last character.
        let end = self.text.trim_end().len();
        let at = if error.is_eof() { end } else { at.min(end) };
        let message = error.to_string();
        let message = message.split(" at line ").next().unwrap_or_default();
        let help = "write {\"cases\": [{\"state\": {…}}]}";
        self.tell(
            Code::WrongType,
            format!("this is not JSON: {message}"),
            at..at,
            help,
        );
    }

    /// The list of cases, and the quantities.
    fn top(&mut self, top: &'a RawValue) -> (Vec<&'a RawValue>, BTreeSet<&'static str>) {
        let Some(object) = self.object(top, "an object") else {
            return Default::default();
        };
        self.keys(&object, self.head(top), &["cases", "quantities"], "cases");
        let list = object.get("cases");
        let list = list.and_then(|list| self.parse(list, "a list of cases"));
        let named = object.get("quantities").map(|raw| self.quantities(raw));
        let quantities = named.unwrap_or_else(|| quantities().collect());
        (list.unwrap_or_default(), quantities)
    }

    /// Quantities by their keys.
    fn quantities(&mut self, raw: &'a RawValue) -> BTreeSet<&'static str> {
        let list: Option<Vec<&'a RawValue>> = self.parse(raw, "a list of quantities");
        let mut named = BTreeSet::new();
        for raw in list.unwrap_or_default() {
            let Some(name) = self.parse::<String>(raw, "the name of a quantity") else {
                continue;
            };
            if let Some(known) = quantities().find(|known| *known == name) {
                named.insert(known);
                continue;
            }
            let help = instead(&name, quantities());
            let message = format!("there is no quantity `{name}`");
            self.tell(Code::UnknownName, message, self.span(raw), help);
        }
        named
    }

    /// The position of a value in the text.
    fn span(&self, raw: &RawValue) -> Span {
        let start = (raw.get().as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..(start + raw.get().len()).min(self.text.len())
    }

    /// The first character of a value, to keep excerpts short.
    fn head(&self, raw: &RawValue) -> Span {
        let span = self.span(raw);
        span.start..(span.start + 1).min(span.end)
    }

    fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: impl Into<String>) {
        self.findings
            .push(Diagnostic::error(code, message).at(at, "").help(help));
    }

    fn parse<T: Deserialize<'a>>(&mut self, raw: &'a RawValue, wanted: &str) -> Option<T> {
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

    /// An object whose keys are unique.
    fn object(&mut self, raw: &'a RawValue, wanted: &str) -> Option<Object<'a>> {
        let object: Object<'a> = self.parse(raw, wanted)?;
        let mut seen = BTreeSet::new();
        for (key, value) in &object.0 {
            if !seen.insert(key.as_str()) {
                let message = format!("the key `{key}` is given twice");
                let help = "remove one of the two";
                self.tell(Code::DuplicateName, message, self.head(value), help);
            }
        }
        Some(object)
    }

    fn keys(&mut self, object: &Object<'_>, at: Span, known: &[&str], required: &str) {
        for (key, value) in &object.0 {
            if !known.contains(&key.as_str()) {
                let help = format!("the keys are {}", known.join(", "));
                let message = format!("unknown key `{key}`");
                self.tell(Code::UnknownKey, message, self.head(value), help);
            }
        }
        if object.get(required).is_none() {
            self.tell(
                Code::MissingKey,
                format!("the key `{required}` is missing"),
                at,
                format!("add \"{required}\""),
            );
        }
    }

    fn case(&mut self, raw: &'a RawValue, info: &ModelInfo) -> Case {
        let object = self.object(raw, "an object").unwrap_or_default();
        let known = ["parameters", "state", "inputs", "accelerations", "t"];
        self.keys(&object, self.head(raw), &known, "state");
        let mut numbers = |key: &str, what: &str, list: &[Quantity]| match object.get(key) {
            Some(raw) => self.numbers(raw, what, list),
            None => vec![None; list.len()],
        };
        let state = numbers("state", "state", &info.states);
        let u = numbers("inputs", "input", &info.inputs);
        let parameters = numbers("parameters", "parameter", &info.parameters);
        let accelerations = object.get("accelerations").map(|raw| {
            let given = self.numbers(raw, "pseudo-velocity", info.speed_quantities());
            given.into_iter().map(Option::unwrap_or_default).collect()
        });
        if let Some(raw) = object.get("state") {
            // A wrong number has been reported already.
            let named: Object<'a> = serde_json::from_str(raw.get()).unwrap_or_default();
            let names = info.states.iter().map(|state| state.name.as_ref());
            let missing: Vec<&str> = names.filter(|name| named.get(name).is_none()).collect();
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
            accelerations,
        }
    }

    /// Numbers by name, in the order of a list.
    fn numbers(&mut self, raw: &'a RawValue, what: &str, list: &[Quantity]) -> Vec<Option<f64>> {
        let mut values = vec![None; list.len()];
        let object = self.object(raw, "an object of numbers").unwrap_or_default();
        for (name, raw) in object.0 {
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
