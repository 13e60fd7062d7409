//! Text to syntax tree.

mod expression;
mod items;
mod lexer;
mod reader;
mod source;
mod values;

use toml::de::{DeTable, DeValue};

use crate::ast::{ExprAst, SectionAst, SpecAst};
use crate::diagnostic::{Code, Diagnostic, MAX_SHOWN};
use crate::expr::Span;
use crate::language::{Presence, SECTIONS, Section};
use crate::limits::MAX_FILE;
use crate::suggest::{self, shown};

use reader::{Reader, in_text_order, phrase};

pub use expression::unit_diagnostic;
pub(crate) use expression::{SECOND_RATE, zero};
pub use reader::is_forbidden;

/// Parses a spec; invalid parts are omitted from the tree and reported in the diagnostics.
pub fn parse(text: &str) -> (SpecAst, Vec<Diagnostic>) {
    let mut reader = Reader {
        text,
        findings: Vec::new(),
        broken: false,
        incomplete: false,
    };
    let mut sections = Vec::new();
    if text.len() > MAX_FILE {
        reader.broken = true;
        reader.tell(Diagnostic::error(
            Code::LimitExceeded,
            format!(
                "a spec has at most {MAX_FILE} bytes, this one has {}",
                text.len()
            ),
        ));
    } else if let Some(at) = markup(text) {
        reader.broken = true;
        reader.tell(
            Diagnostic::error(Code::TomlSyntax, "this is XML, and a spec is TOML")
                .at(at..at + 1, "a tag")
                .help(
                    "a robot file with its recordings needs their description, which `appell recording` drafts from \
                     both; `appell import robot.xml` makes a spec of it, `appell new NAME` begins another one",
                ),
        );
    } else {
        reader.characters();
        let (table, errors) = DeTable::parse_recoverable(text);
        let broken_lines = reader.syntax_errors(&errors);
        sections = reader.sections(table.get_ref());
        reader.forget_findings_on(&broken_lines);
    }
    let ast = SpecAst {
        sections,
        broken: reader.broken || reader.incomplete,
    };
    (ast, reader.findings)
}

/// Parses generated items with their sections.
pub(crate) fn made(text: &str) -> (Vec<SectionAst>, Vec<Diagnostic>) {
    let mut reader = Reader {
        text,
        findings: Vec::new(),
        broken: false,
        // The other required parts of a spec are not in this text.
        incomplete: true,
    };
    let (table, errors) = DeTable::parse_recoverable(text);
    reader.syntax_errors(&errors);
    let sections = reader.sections(table.get_ref());
    (sections, reader.findings)
}

/// The tag at the beginning of an XML text, such as a robot file, which is not TOML at all.
fn markup(text: &str) -> Option<usize> {
    let start = text.trim_start_matches('\u{feff}').trim_start();
    start.starts_with('<').then(|| text.len() - start.len())
}

/// Parses an expression at the position `whole` of a document.
pub fn expression_in(document: &str, text: &str, whole: Span) -> Result<ExprAst, Diagnostic> {
    expression::parse(&source::Source::new(document, text, whole))
}

impl Reader<'_> {
    /// Refuses invisible characters and those that reorder text, also in comments.
    fn characters(&mut self) {
        let hidden: Vec<(usize, char)> = self
            .text
            .char_indices()
            .filter(|(at, c)| is_forbidden(*c) && !(*at == 0 && *c == '\u{feff}'))
            .collect();
        for (at, c) in hidden.into_iter().take(5) {
            let message = format!("the character U+{:04X} is not allowed", u32::from(c));
            let finding = Diagnostic::error(Code::ForbiddenCharacter, message);
            self.tell(
                finding
                    .at(at..at + c.len_utf8(), "hidden here")
                    .help("remove it"),
            );
        }
    }

    /// Reports syntax errors of the TOML, one per line; returns the lines.
    fn syntax_errors(&mut self, errors: &[toml::de::Error]) -> Vec<Span> {
        let mut lines: Vec<Span> = Vec::new();
        for error in errors {
            self.broken = true;
            if lines.len() >= MAX_SHOWN {
                break;
            }
            let at = error.span().unwrap_or(0..0);
            if lines.iter().any(|line| line.contains(&at.start)) {
                continue;
            }
            lines.push(self.line(at.start));
            let message = error.message().lines().next().unwrap_or_default();
            let diagnostic = if message.contains("duplicate key") {
                let name = self.text.get(at.clone()).unwrap_or_default();
                Diagnostic::error(Code::DuplicateName, format!("`{name}` is defined twice"))
                    .help("names are unique within a section; rename or remove one")
            } else {
                Diagnostic::error(Code::TomlSyntax, message)
            };
            self.tell(diagnostic.at(at, ""));
        }
        lines
    }

    /// Drops further errors on a line with invalid TOML, as they are consequences.
    fn forget_findings_on(&mut self, lines: &[Span]) {
        if lines.is_empty() {
            return;
        }
        self.findings.retain(|finding| {
            matches!(finding.code, Code::TomlSyntax | Code::DuplicateName)
                // Placeholders of the parser for invalid values have no position.
                || !finding.labels.first().is_some_and(|(at, _)| {
                    *at == (0..0) || lines.iter().any(|line| line.contains(&at.start))
                })
        });
    }

    /// The line around a position, its line break included.
    fn line(&self, at: usize) -> Span {
        let at = self.text.floor_char_boundary(at);
        let start = self.text[..at].rfind('\n').map_or(0, |i| i + 1);
        let end = self.text[at..]
            .find('\n')
            .map_or(self.text.len() + 1, |i| at + i + 1);
        start..end
    }

    fn sections(&mut self, table: &DeTable<'_>) -> Vec<SectionAst> {
        let mut sections = Vec::new();
        for (key, value) in in_text_order(table) {
            let name = key.get_ref().as_ref();
            let Some(section) = SECTIONS.iter().find(|s| s.name == name) else {
                self.unknown_section(name, key.span());
                continue;
            };
            if let DeValue::Table(table) = value.get_ref() {
                sections.push(SectionAst {
                    section,
                    span: key.span(),
                    items: self.items(section, key, table),
                });
            } else {
                self.wrong_type(value, "a table");
            }
        }
        if !self.broken && !self.incomplete {
            self.missing_sections(&sections);
        }
        sections
    }

    fn unknown_section(&mut self, name: &str, at: Span) {
        let known = || SECTIONS.iter().map(|s: &Section| s.name);
        let help = suggest::closest(name, known()).map_or_else(
            || format!("the sections are {}", suggest::list(known())),
            |similar| suggest::meant(&format!("[{similar}]")),
        );
        self.incomplete = true;
        let message = format!("unknown section `{}`", shown(name));
        self.error(Code::UnknownSection, at, message, help);
    }

    fn missing_sections(&mut self, found: &[SectionAst]) {
        for section in SECTIONS {
            let is_there = |name: &str| {
                let mut all = found.iter();
                all.any(|s| s.section.name == name && !s.items.is_empty())
            };
            match section.presence {
                Presence::Optional => continue,
                Presence::Unless(other) if is_there(other) => continue,
                Presence::Required | Presence::Unless(_) => {}
            }
            let present = found.iter().find(|s| s.section.name == section.name);
            if present.is_none_or(|s| s.items.is_empty()) {
                let at = present.map_or(0..0, |s| s.span.clone());
                let state = if present.is_some() {
                    "empty"
                } else {
                    "missing"
                };
                let message = format!("the section `[{}]` is {state}", section.name);
                let help = phrase(section.about);
                self.error(Code::MissingSection, at, message, help);
            }
        }
    }
}
