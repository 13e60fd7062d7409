//! Positions of keys and strings in the text of a spec, also in one that is being typed.
//!
//! The syntax tree contains only valid parts, and a name that occurs in several headers only once.
//! Editors need the rest as well.

use toml_parser::parser::{Event, EventKind, RecursionGuard, parse_document};

use crate::expr::Span;
use crate::language::{Form, Key, SECTIONS, Section, Shape};
use crate::limits::{MAX_FILE, MAX_NAME};

/// Deeper tables are skipped, as by the parser of specs.
const MAX_NESTED: u32 = 80;
/// Maximum length of a path of keys, which bounds the memory for input with many dots.
const MAX_KEYS: usize = 8;

/// A key or a string, with its position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// The keys that lead to it, from the section; those of a key end with itself.
    pub path: Vec<String>,
    /// Its position, quotes included.
    pub span: Span,
}

/// The keys and strings of a text.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    /// Keys, those of headers included, in the order of the text.
    pub keys: Vec<Part>,
    /// Values that are strings, in the order of the text.
    pub strings: Vec<Part>,
}

impl Outline {
    /// Reads a text; invalid TOML is skipped.
    pub fn new(text: &str) -> Self {
        let mut reader = Reader::default();
        if text.len() <= MAX_FILE {
            let source = toml_parser::Source::new(text);
            let tokens = source.lex().into_vec();
            let mut events = |event: Event| reader.see(source, event);
            let mut guarded = RecursionGuard::new(&mut events, MAX_NESTED);
            parse_document(&tokens, &mut guarded, &mut ());
        }
        reader.outline
    }

    /// The string around a position, quotes excluded; an unterminated one ends with its line.
    pub fn string_at(&self, text: &str, at: usize) -> Option<&Part> {
        let mut strings = self.strings.iter();
        strings.find(|part| {
            let written = text.get(part.span.clone()).unwrap_or_default();
            let is_closed = unquoted(written) != written;
            part.span.start < at && (at < part.span.end || at == part.span.end && !is_closed)
        })
    }

    /// The span between the quotes of a string.
    pub fn content(text: &str, string: &Part) -> Span {
        let written = text.get(string.span.clone()).unwrap_or_default();
        let closing = usize::from(unquoted(written) != written);
        let start = string.span.end.min(string.span.start + 1);
        start..start.max(string.span.end - closing)
    }

    /// The key at a path.
    pub fn key_of(&self, text: &str, path: &[String]) -> Option<&'static Key> {
        let [section, item, rest @ ..] = path else {
            return None;
        };
        let section: &Section = SECTIONS.iter().find(|s| s.name == section)?;
        let (keys, only) = match section.shape {
            Shape::Items(keys, only) => (keys, only),
            Shape::Kinds(kinds) => {
                let above = [section.name, item.as_str(), "kind"];
                let word = self.strings.iter().find(|part| part.path == above)?;
                let word = unquoted(text.get(word.span.clone())?);
                (kinds.iter().find(|kind| kind.word == word)?.keys, None)
            }
            Shape::Table(_) | Shape::States => return None,
        };
        let named = |keys: &'static [Key], name: &str| keys.iter().find(|key| key.name == name);
        let Some((first, inner)) = rest.split_first() else {
            return named(keys, only?);
        };
        inner
            .iter()
            .try_fold(named(keys, first)?, |key, name| match key.form {
                Form::Table(keys) | Form::Tables(keys) | Form::Inertia(keys) => named(keys, name),
                _ => None,
            })
    }
}

/// Without the quotes around it, if there are any.
pub(crate) fn unquoted(written: &str) -> &str {
    ["\"", "'"]
        .into_iter()
        .find_map(|quote| written.strip_prefix(quote)?.strip_suffix(quote))
        .unwrap_or(written)
}

/// Follows the events of a parser.
#[derive(Default)]
struct Reader {
    outline: Outline,
    /// Keys of the last header.
    header: Vec<String>,
    /// Keys above the next value, those of the header included.
    path: Vec<String>,
    /// The number of them for each open table, the innermost last.
    open: Vec<usize>,
    in_header: bool,
    /// Whether a key goes on after a dot.
    goes_on: bool,
}

impl Reader {
    fn see(&mut self, source: toml_parser::Source<'_>, event: Event) {
        let span = event.span().start()..event.span().end();
        match event.kind() {
            EventKind::StdTableOpen | EventKind::ArrayTableOpen => {
                self.path.clear();
                self.open.clear();
                (self.in_header, self.goes_on) = (true, false);
            }
            EventKind::StdTableClose | EventKind::ArrayTableClose => {
                self.header.clone_from(&self.path);
                self.in_header = false;
            }
            EventKind::SimpleKey => {
                if !self.goes_on && !self.in_header {
                    let base = self.open.last().copied().unwrap_or(self.header.len());
                    self.path.truncate(base);
                }
                self.goes_on = false;
                let mut key = String::new();
                if let Some(raw) = source.get(event) {
                    raw.decode_key(&mut key, &mut ());
                }
                // A longer key is no name, and would be repeated in the paths of all keys below.
                if key.len() > MAX_NAME {
                    key.clear();
                }
                self.path.push(key);
                self.outline.keys.extend(self.part(span));
            }
            EventKind::KeySep => self.goes_on = true,
            EventKind::InlineTableOpen => self.open.push(self.path.len()),
            EventKind::InlineTableClose => {
                if let Some(above) = self.open.pop() {
                    self.path.truncate(above);
                }
            }
            EventKind::Scalar if event.encoding().is_some() => {
                self.outline.strings.extend(self.part(span));
            }
            _ => {}
        }
    }

    fn part(&self, span: Span) -> Option<Part> {
        (self.path.len() <= MAX_KEYS).then(|| Part {
            path: self.path.clone(),
            span,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(parts: &[Part]) -> Vec<String> {
        parts.iter().map(|part| part.path.join("/")).collect()
    }

    #[test]
    fn keys_stand_below_their_headers_and_tables() {
        let text = "\
[bodies.wheel]
centre = 'G'
[bodies.wheel.inertia]
in = 'tilted'
[frames]
a.turns = [{ about_axis = 'x', by = 'p' }, { about_axis = 'y' }]
b = { parent = 'a' }
";
        let outline = Outline::new(text);
        assert_eq!(
            paths(&outline.strings),
            [
                "bodies/wheel/centre",
                "bodies/wheel/inertia/in",
                "frames/a/turns/about_axis",
                "frames/a/turns/by",
                "frames/a/turns/about_axis",
                "frames/b/parent",
            ]
        );
        let wheels = outline
            .keys
            .iter()
            .filter(|key| key.path == ["bodies", "wheel"]);
        assert_eq!(wheels.count(), 2);
    }

    #[test]
    fn strings_know_their_keys_while_they_are_typed() {
        let text = "[loads]\npush = { kind = 'force', on = '";
        let outline = Outline::new(text);
        let string = outline.strings.last().expect("a string");
        let key = outline.key_of(text, &string.path).expect("a key");
        assert_eq!(key.name, "on");
    }
}
