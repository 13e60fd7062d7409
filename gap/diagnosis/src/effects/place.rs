//! Errors of the file of an effect, reported at positions of this file: they are found only when the effect is part of
//! a spec, whose text the author of the effect does not know.

use std::ops::ControlFlow;

use appell_spec::expr::Span;
use appell_spec::{Code, Diagnostic, Report};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::EffectError;
use super::candidate::filled;

/// Keys on the path to a value; those of a list are numbers.
type Path = Vec<String>;

/// The file of an effect, and the texts of its placeholders at a site of a mechanism.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub(super) file: String,
    pub(super) text: String,
    pub(super) words: Vec<(String, String)>,
}

impl Source {
    /// The errors of a spec with the effect as errors of its file.
    pub(super) fn blamed(&self, report: &Report, spec: &str) -> EffectError {
        let diagnostics = report.diagnostics().iter();
        let diagnostics = diagnostics.map(|one| self.translated(one, spec));
        EffectError::from(Report::new(&*self.file, &*self.text, diagnostics.collect()))
    }

    /// An error at a path of the file; without one, in all of it.
    pub(super) fn wrong(&self, path: &[&str], message: &str) -> EffectError {
        let path: Vec<String> = path.iter().map(|&key| key.to_owned()).collect();
        let (table, _) = DeTable::parse_recoverable(&self.text);
        let at = self.follow(table.get_ref(), &path).unwrap_or(0..0);
        let diagnostic = Diagnostic::error(Code::WrongType, self.in_its_words(message));
        let diagnostic = diagnostic.at(at, "");
        Report::new(&*self.file, &*self.text, vec![diagnostic]).into()
    }

    fn translated(&self, diagnostic: &Diagnostic, spec: &str) -> Diagnostic {
        let mut labels: Vec<(Span, String)> = Vec::new();
        for (at, words) in &diagnostic.labels {
            if let Some(place) = self.place(spec, at) {
                labels.push((place, self.in_its_words(words)));
            }
        }
        if labels.is_empty() {
            labels.push((self.input().unwrap_or(0..0), String::new()));
        }
        let site = self.words.iter().find(|(word, _)| word == "site");
        if let (Some((_, site)), Some((_, words))) = (site, labels.first_mut()) {
            let at = format!("where `{{site}}` is `{site}`");
            *words = if words.is_empty() {
                at
            } else {
                format!("{words}, {at}")
            };
        }
        Diagnostic {
            message: self.in_its_words(&diagnostic.message),
            labels,
            help: (diagnostic.help.as_deref()).map(|help| self.in_its_words(help)),
            ..diagnostic.clone()
        }
    }

    /// A text with the name of the effect replaced by `{effect}`. Texts of other placeholders are too short to be
    /// recognised.
    fn in_its_words(&self, text: &str) -> String {
        let effect = self.words.iter().find(|(word, _)| word == "effect");
        effect.map_or_else(
            || text.to_owned(),
            |(_, name)| text.replace(name.as_str(), "{effect}"),
        )
    }

    /// The position in the file that corresponds to one in a spec; `None` for text that is not from this file.
    fn place(&self, spec: &str, at: &Span) -> Option<Span> {
        let (table, _) = DeTable::parse_recoverable(spec);
        let path = path_to(&table, at)?;
        let (table, _) = DeTable::parse_recoverable(&self.text);
        let whole = self.follow(table.get_ref(), &path)?;
        let (part, own) = (spec.get(at.clone())?, self.text.get(whole.clone())?);
        // Within a text the same part, if it is found.
        let same = [part.to_owned(), self.in_its_words(part)];
        let mut found = same.iter().filter(|words| !words.is_empty());
        let found = found.find_map(|words| Some((own.find(words.as_str())?, words.len())));
        Some(found.map_or(whole.clone(), |(start, len)| {
            whole.start + start..whole.start + start + len
        }))
    }

    /// The position of the deepest value on a path of the spec; `None` if the item is not from this file.
    fn follow(&self, table: &DeTable<'_>, path: &[String]) -> Option<Span> {
        let words: Vec<(&str, &str)> = (self.words.iter())
            .map(|(word, meaning)| (word.as_str(), meaning.as_str()))
            .collect();
        let (section, rest) = path.split_first()?;
        let (name, rest) = rest.split_first()?;
        let items = table.get(section.as_str())?.get_ref().as_table()?;
        let mut items = items.iter();
        let (key, mut value) = items.find(|(key, _)| filled(key.get_ref(), &words) == *name)?;
        let mut last = key.span();
        for key in rest {
            let next = match value.get_ref() {
                DeValue::Table(table) => table.get(key.as_str()),
                DeValue::Array(parts) => key.parse::<usize>().ok().and_then(|i| parts.get(i)),
                _ => None,
            };
            let Some(next) = next else { break };
            (value, last) = (next, next.span());
        }
        Some(last)
    }

    /// The section `[input]` or `[geometry]`, whose terms appear within expressions of the spec itself.
    fn input(&self) -> Option<Span> {
        let (table, _) = DeTable::parse_recoverable(&self.text);
        let mut sections = ["input", "geometry"].into_iter();
        let section = sections.find_map(|section| table.get_ref().get(section))?;
        let inputs = section.get_ref().as_table()?;
        inputs.values().next().map(Spanned::span)
    }
}

/// The keys on the path to a position.
fn path_to(table: &Spanned<DeTable<'_>>, at: &Span) -> Option<Path> {
    let mut path = Vec::new();
    let found = search(table.get_ref(), at, &mut path);
    found.is_break().then_some(path)
}

fn search(table: &DeTable<'_>, at: &Span, path: &mut Path) -> ControlFlow<()> {
    for (key, value) in table {
        path.push(key.get_ref().to_string());
        if holds(&key.span(), at) {
            return ControlFlow::Break(());
        }
        within(value, at, path)?;
        path.pop();
    }
    ControlFlow::Continue(())
}

fn within(value: &Spanned<DeValue<'_>>, at: &Span, path: &mut Path) -> ControlFlow<()> {
    match value.get_ref() {
        // The position of a section is its heading alone.
        DeValue::Table(table) => search(table, at, path)?,
        DeValue::Array(parts) => {
            for (index, part) in parts.iter().enumerate() {
                path.push(index.to_string());
                within(part, at, path)?;
                path.pop();
            }
        }
        _ => {}
    }
    if holds(&value.span(), at) {
        return ControlFlow::Break(());
    }
    ControlFlow::Continue(())
}

fn holds(whole: &Span, at: &Span) -> bool {
    whole.start <= at.start && at.end <= whole.end
}
