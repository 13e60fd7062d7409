//! Tables of a TOML file, read with positions. Errors are reported and skipped, so that all of them are
//! reported at once.

use appell_spec::diagnostic::MAX_SHOWN;
use appell_spec::expr::Span;
use appell_spec::units::{self, Unit};
use appell_spec::{Code, Diagnostic, Report, Severity, did_you_mean, shown};
use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};

/// An integer of any base as a number.
fn whole(integer: &DeInteger<'_>) -> Option<f64> {
    match integer.radix() {
        10 => integer.as_str().parse().ok(),
        base => i64::from_str_radix(integer.as_str(), base)
            .ok()
            .map(|whole| whole as f64),
    }
}

/// A tolerance, one standard deviation.
pub enum Tolerance {
    /// In the unit of the value.
    Absolute(f64),
    /// As a share of the value.
    Relative(f64),
}

/// A value with its position.
pub type Value<'t> = Spanned<DeValue<'t>>;

/// The text of a file, with findings.
pub struct Fields<'t> {
    file: &'t str,
    text: &'t str,
    findings: Vec<Diagnostic>,
}

impl<'t> Fields<'t> {
    /// Parses a file.
    pub fn new(file: &'t str, text: &'t str) -> (Self, Spanned<DeTable<'t>>) {
        let (table, errors) = DeTable::parse_recoverable(text);
        let findings = errors.iter().map(|error| {
            let message = error.message().lines().next().unwrap_or_default();
            Diagnostic::error(Code::TomlSyntax, message).at(error.span().unwrap_or(0..0), "")
        });
        let fields = Self {
            file,
            text,
            findings: findings.take(crate::limits::MAX_MISTAKES).collect(),
        };
        (fields, table)
    }

    /// Adds a finding, up to the number that a report shows.
    pub fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: &str) {
        if self.findings.len() > MAX_SHOWN && self.is_wrong() {
            return;
        }
        let diagnostic = Diagnostic::error(code, message).at(at, "");
        let help = (!help.is_empty()).then(|| help.to_owned());
        self.findings.push(diagnostic.maybe_help(help));
    }

    /// Whether there are errors.
    pub fn is_wrong(&self) -> bool {
        self.findings
            .iter()
            .any(|finding| finding.severity == Severity::Error)
    }

    /// All findings.
    pub fn report(self) -> Report {
        Report::new(self.file, self.text, self.findings)
    }

    /// The table of a section; `None` if it is absent.
    pub fn section<'a, 'd>(
        &mut self,
        table: &'a DeTable<'d>,
        name: &str,
    ) -> Option<&'a DeTable<'d>> {
        let value = table.get(name)?;
        self.table(value, &format!("a table `[{name}]`"))
    }

    /// The table of a section that has to be there.
    pub(crate) fn needed_section<'a, 'd>(
        &mut self,
        table: &'a DeTable<'d>,
        name: &str,
        help: &str,
    ) -> Option<&'a DeTable<'d>> {
        if table.get(name).is_none() {
            let message = format!("the section `[{name}]` is missing");
            self.tell(Code::MissingSection, message, 0..0, help);
        }
        self.section(table, name)
    }

    /// A value that is a table.
    pub(crate) fn table<'a, 'd>(
        &mut self,
        value: &'a Value<'d>,
        wanted: &str,
    ) -> Option<&'a DeTable<'d>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            self.wrong_type(value, wanted);
        }
        table
    }

    /// Reports that a key is missing.
    pub(crate) fn missing(&mut self, key: &str, at: Span, help: &str) {
        let message = format!("the key `{key}` is missing");
        self.tell(Code::MissingKey, message, at, help);
    }

    /// Reports unknown keys.
    pub fn only(&mut self, table: &DeTable<'_>, keys: &[&str]) {
        for key in table.keys() {
            let name = key.get_ref().as_ref();
            if !keys.contains(&name) {
                let help = did_you_mean(name, keys.iter().copied(), || {
                    format!("the keys are {}", keys.join(", "))
                });
                let message = format!("unknown key `{}`", shown(name));
                self.tell(Code::UnknownKey, message, key.span(), &help);
            }
        }
    }

    /// An optional string.
    pub fn string(&mut self, table: &DeTable<'_>, key: &str) -> Option<(String, Span)> {
        let value = table.get(key)?;
        self.text_of(value)
    }

    fn text_of(&mut self, value: &Value<'_>) -> Option<(String, Span)> {
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(value, "a string");
        }
        Some((text?.to_owned(), value.span()))
    }

    /// A list of texts; empty where it is absent.
    pub fn strings(&mut self, table: &DeTable<'_>, key: &str) -> Vec<(String, Span)> {
        let Some(value) = table.get(key) else {
            return Vec::new();
        };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong_type(value, "a list of names");
            return Vec::new();
        };
        let texts = list.iter().map(|value| self.text_of(value));
        texts.collect::<Vec<_>>().into_iter().flatten().collect()
    }

    /// A finite number.
    pub fn number(&mut self, value: &Value<'_>) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) => whole(integer),
            _ => {
                self.wrong_type(value, "a number");
                return None;
            }
        };
        let finite = number.filter(|number| number.is_finite());
        if finite.is_none() {
            let help = "write a decimal number";
            self.tell(Code::NotFinite, "not a finite number", value.span(), help);
        }
        finite
    }

    /// A truth value; false where it is absent.
    pub fn flag(&mut self, table: &DeTable<'_>, key: &str) -> bool {
        let Some(value) = table.get(key) else {
            return false;
        };
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(value, "true or false");
        }
        flag.unwrap_or(false)
    }

    /// File, line and column of a position.
    pub fn place(&self, at: Span) -> (String, usize, usize) {
        let report = Report::new(self.file, self.text, Vec::new());
        let (line, column) = report.line_column(at.start);
        (self.file.to_owned(), line, column)
    }

    /// A number that may be absent and is not negative.
    pub fn deviation(&mut self, table: &DeTable<'_>, key: &str) -> Option<f64> {
        let value = table.get(key)?;
        let number = self.number(value)?;
        if number < 0.0 {
            let message = format!("`{key}` is a standard deviation, which is not negative");
            self.tell(Code::ValueOutsideLimits, message, value.span(), "");
            return None;
        }
        Some(number)
    }

    /// A tolerance that may be absent: a number, or a text in per cent of the value, `"3 %"`.
    pub fn tolerance(&mut self, table: &DeTable<'_>, key: &str) -> Option<Tolerance> {
        let value = table.get(key)?;
        let Some(text) = value.get_ref().as_str() else {
            return self.deviation(table, key).map(Tolerance::Absolute);
        };
        let share = text.strip_suffix('%').map(str::trim);
        let share = share.and_then(|share| share.parse::<f64>().ok());
        let share = share.filter(|share| share.is_finite() && *share >= 0.0);
        if share.is_none() {
            self.wrong_type(value, "a number, or a share of the value such as \"3 %\"");
        }
        share.map(|share| Tolerance::Relative(share / 100.0))
    }

    /// A unit that may be absent: then the one of the quantity. One of another dimension is reported.
    pub fn unit(&mut self, table: &DeTable<'_>, of: Option<(&str, &Unit)>) -> Option<Unit> {
        let Some((text, at)) = self.string(table, "unit") else {
            return of.map(|(_, unit)| unit.clone());
        };
        let unit = match units::parse(&text) {
            Ok(unit) => unit,
            Err(error) => {
                // Between the quotes, unless escapes make the text another one.
                let start = at.start + 1;
                let same = self.text.get(start..start + text.len()) == Some(text.as_str());
                let place = |part: std::ops::Range<usize>| {
                    if same {
                        start + part.start..start + part.end
                    } else {
                        at.clone()
                    }
                };
                self.findings
                    .push(appell_spec::parse::unit_diagnostic(&error, place));
                return None;
            }
        };
        if let Some((name, own)) = of
            && own.dimension != unit.dimension
        {
            let wanted = units::quantity_name(&own.dimension);
            let found = units::quantity_name(&unit.dimension);
            let message = format!("`{name}` is {wanted}, `{text}` is {found}");
            let help = format!("the spec measures it in `{}`", own.text);
            self.tell(Code::UnitMismatch, message, at, &help);
            return None;
        }
        Some(unit)
    }

    /// Tells that a value has another form.
    pub fn wrong_type(&mut self, value: &Value<'_>, wanted: &str) {
        let message = format!("expected {wanted}");
        self.tell(Code::WrongType, message, value.span(), "");
    }

    /// Reports a name that is none of those that are known.
    pub(crate) fn unknown<'n>(
        &mut self,
        what: &str,
        name: &str,
        at: Span,
        known: impl Iterator<Item = &'n str> + Clone,
    ) {
        let help = did_you_mean(name, known.clone(), || {
            let list: Vec<&str> = known.collect();
            if list.is_empty() {
                format!("the mechanism has no {what}")
            } else {
                format!("there are {}", list.join(", "))
            }
        });
        let message = format!("the spec has no {what} `{}`", shown(name));
        self.tell(Code::UnknownName, message, at, &help);
    }
}
