//! State and helpers shared by all parts of the parser: text, findings, descriptions of values.

use toml::de::{DeTable, DeValue};

use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Span;
use crate::visible::is_hidden;

/// Maximum number of diagnostics collected.
const MAX_FINDINGS: usize = 1000;

/// A key of a TOML table, with its position.
pub(super) type TomlKey<'a> = toml::Spanned<std::borrow::Cow<'a, str>>;
/// A value of a TOML table, with its position.
pub(super) type TomlValue<'a> = toml::Spanned<DeValue<'a>>;

/// The text being parsed, and the findings about it.
pub(super) struct Reader<'a> {
    pub(super) text: &'a str,
    pub(super) findings: Vec<Diagnostic>,
    /// The TOML is invalid, so that missing parts may be present in the text.
    pub(super) broken: bool,
    /// Some definition was refused, so that unknown names may refer to it.
    pub(super) incomplete: bool,
}

impl Reader<'_> {
    pub(super) fn tell(&mut self, diagnostic: Diagnostic) {
        if self.findings.len() < MAX_FINDINGS {
            self.findings.push(diagnostic);
        }
    }

    /// An error at a place, with a remedy.
    pub(super) fn error(
        &mut self,
        code: Code,
        at: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.tell(Diagnostic::error(code, message).at(at, "").help(help));
    }

    /// More of something than a limit allows.
    pub(super) fn exceeded(&mut self, at: Span, message: String, count: usize, of: &str) {
        let finding = Diagnostic::error(Code::LimitExceeded, message);
        self.tell(finding.at(at, format!("{count} {of}")));
    }

    pub(super) fn wrong_type(&mut self, value: &TomlValue<'_>, wanted: &str) {
        let found = words(value.get_ref());
        self.tell(
            Diagnostic::error(Code::WrongType, format!("expected {wanted}, found {found}"))
                .at(value.span(), found),
        );
    }
}

/// The entries of a table in the order of the text; the table itself sorts them by name.
pub(super) fn in_text_order<'t, 'a>(
    table: &'t DeTable<'a>,
) -> Vec<(&'t TomlKey<'a>, &'t TomlValue<'a>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// A description of a value for messages.
fn words(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a truth value",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// Hidden characters, except the carriage returns that end lines.
pub fn is_forbidden(c: char) -> bool {
    c != '\r' && is_hidden(c)
}

/// A sentence as the last part of another one.
pub(super) fn phrase(sentence: &str) -> String {
    let mut letters = sentence.chars();
    let first = letters.next().map(|c| c.to_ascii_lowercase());
    first
        .into_iter()
        .chain(letters)
        .collect::<String>()
        .trim_end_matches('.')
        .to_owned()
}
