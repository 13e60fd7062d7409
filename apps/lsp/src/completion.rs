//! Candidates inside a string: names, functions, units. Sections and keys are completed by the JSON schema.

use std::collections::BTreeSet;

use appell_spec::expr::{Function, Span, Word};
use appell_spec::language::{Form, Target};
use appell_spec::occurrences::{Namespace, named_by};
use appell_spec::outline::{Outline, Part};
use appell_spec::units::{PREFIXES, UNITS};
use appell_spec::{Code, Reading};
use lsp_types::{CompletionItem, CompletionItemKind, Documentation, Position, TextEdit};

use crate::document::Document;

/// The candidates at a position.
pub(crate) fn completion(document: &Document, position: Position) -> Vec<CompletionItem> {
    let at = document.text.offset(position);
    let text = document.text.as_str();
    let Some(string) = document.outline.string_at(text, at) else {
        return Vec::new();
    };
    let Some(key) = document.outline.key_of(text, &string.path) else {
        return Vec::new();
    };
    match key.form {
        Form::Unit => {
            let content = Outline::content(text, string);
            written_units(document, &content).chain(units()).collect()
        }
        Form::Reference(target) => named(document, target, Some(&string.path)),
        Form::Quaternion => named(document, Target::Coordinate, None),
        Form::Two(target) => named(document, target, None),
        // A single word is not an expression.
        Form::Direction if !is_in_list(text, string) => Vec::new(),
        Form::Expression | Form::Components | Form::Matrix | Form::Inertia(_) | Form::Direction => {
            let before = document.text.part(&(string.span.start + 1..at));
            in_expression(document, string, before)
        }
        _ => Vec::new(),
    }
}

fn is_in_list(text: &str, string: &Part) -> bool {
    let before = text.get(..string.span.start).unwrap_or_default();
    before.trim_end().ends_with(['[', ','])
}

fn item(label: &str, kind: CompletionItemKind, detail: impl Into<String>) -> CompletionItem {
    CompletionItem {
        label: label.to_owned(),
        kind: Some(kind),
        detail: Some(detail.into()),
        ..CompletionItem::default()
    }
}

/// The units of the table, then the prefixed ones.
fn units() -> impl Iterator<Item = CompletionItem> {
    let plain = UNITS.iter().map(|unit| (String::new(), unit));
    let prefixed = PREFIXES.iter().flat_map(|(prefix, _)| {
        let units = UNITS.iter().filter(|unit| unit.prefixed);
        units.map(|unit| ((*prefix).to_owned(), unit))
    });
    plain.chain(prefixed).map(|(prefix, unit)| CompletionItem {
        sort_text: Some(format!("{}{}{prefix}", prefix.len(), unit.symbol)),
        ..item(&(prefix + unit.symbol), CompletionItemKind::UNIT, unit.name)
    })
}

/// The units used elsewhere in the spec, each for a whole string.
fn written_units(document: &Document, content: &Span) -> impl Iterator<Item = CompletionItem> {
    let sections = document.reading.ast.sections.iter();
    let items = sections.flat_map(|section| &section.items);
    let units = items.filter_map(|item| Some(item.unit("unit")?.value.text.as_str()));
    let compound = units.filter(|unit| unit.contains(|c: char| !c.is_alphabetic()));
    let units: BTreeSet<&str> = compound.collect();
    let range = document.text.range(content);
    units.into_iter().map(move |unit| CompletionItem {
        text_edit: Some(TextEdit::new(range, unit.to_owned()).into()),
        ..item(unit, CompletionItemKind::UNIT, "a unit of this spec")
    })
}

/// The names that a reference admits, without the item itself.
fn named(document: &Document, target: Target, from: Option<&[String]>) -> Vec<CompletionItem> {
    let supplied = match target {
        Target::Frame => vec![item("ground", CompletionItemKind::STRUCT, "frame")],
        Target::Point => vec![item("O", CompletionItemKind::STRUCT, "point")],
        _ => Vec::new(),
    };
    let own = from.filter(|path| path[0] == target.section() || path[0] == "joints");
    let own = own.and_then(|path| path.get(1)).map(String::as_str);
    let mut all = defined(document, target.section(), target.word());
    all.retain(|item| Some(item.label.as_str()) != own);
    supplied.into_iter().chain(all).collect()
}

/// The items of a section.
fn defined(document: &Document, section: &str, word: &str) -> Vec<CompletionItem> {
    let kind = match Namespace::of_section(section) {
        Some(Namespace::Quantity) => CompletionItemKind::VARIABLE,
        _ => CompletionItemKind::STRUCT,
    };
    let items = document.reading.expanded().items(section).iter();
    items
        .map(|defined| {
            let unit = defined.unit("unit").map(|unit| &unit.value.text);
            let detail = unit.map_or_else(|| word.to_owned(), |unit| format!("{word}, {unit}"));
            let about = defined.text("about").map(|about| about.value.to_owned());
            CompletionItem {
                documentation: about.map(Documentation::String),
                ..item(&defined.name.value, kind, detail)
            }
        })
        .collect()
}

/// `before` is the expression up to the cursor.
fn in_expression(document: &Document, string: &Part, before: &str) -> Vec<CompletionItem> {
    if before.rfind('[') > before.rfind(']') {
        return units().collect();
    }
    if let Some((function, place)) = call_around(before) {
        if function == "dot" {
            return defined(document, "coordinates", "coordinate");
        }
        if let Some(word) = Word::from_name(function) {
            return match place {
                0 => named(document, named_by(word), None),
                1 => ["x", "y", "z"]
                    .map(|axis| item(axis, CompletionItemKind::CONSTANT, "axis"))
                    .into(),
                _ => named(document, Target::Frame, None),
            };
        }
    }
    let is_allowed = |expression: &str| is_allowed(document, string, expression);
    let mut all = Vec::new();
    for (section, word) in [
        ("parameters", "parameter"),
        ("coordinates", "coordinate"),
        ("pseudo_velocities", "pseudo-velocity"),
        ("inputs", "input"),
        ("signals", "signal"),
        ("definitions", "definition"),
    ] {
        let items = defined(document, section, word);
        // All of a kind are allowed, or none.
        if items.first().is_some_and(|first| is_allowed(&first.label)) {
            all.extend(items);
        }
    }
    let function = CompletionItemKind::FUNCTION;
    let coordinates = document.reading.expanded().items("coordinates");
    let mut rate = coordinates.iter().take(1);
    if rate.any(|q| is_allowed(&format!("dot({})", q.name.value))) {
        all.push(item("dot", function, "dot(q), the rate of a coordinate"));
    }
    if is_allowed("t") {
        all.push(item("t", CompletionItemKind::CONSTANT, "time, s"));
    }
    all.push(item("pi", CompletionItemKind::CONSTANT, "circle constant"));
    all.push(item("if", function, "if(a < b, x, y)"));
    for (_, name, arity) in Function::ALL {
        let arguments = ["a", "b", "c"].get(..*arity).unwrap_or_default();
        let detail = format!("{name}({})", arguments.join(", "));
        all.push(item(name, function, detail));
    }
    let moves = is_allowed("speed(O)");
    let words = Word::ALL.iter().filter(|(word, _, example)| match word {
        Word::Position | Word::Velocity | Word::Speed | Word::AngularVelocity => moves,
        _ => is_allowed(example),
    });
    all.extend(words.map(|(_, name, example)| item(name, function, *example)));
    all
}

/// The function whose argument list contains the cursor, and the number of arguments before the cursor.
fn call_around(before: &str) -> Option<(&str, usize)> {
    let (mut depth, mut place) = (0, 0);
    for (at, letter) in before.char_indices().rev() {
        match letter {
            ')' => depth += 1,
            '(' if depth == 0 => {
                let ends = |c: char| !c.is_ascii_alphanumeric() && c != '_';
                let function = before[..at].rsplit(ends).next()?;
                return Some((function, place));
            }
            '(' => depth -= 1,
            ',' if depth == 0 => place += 1,
            _ => {}
        }
    }
    None
}

/// Whether an expression is valid in the string at the cursor, decided by the checks of the spec.
fn is_allowed(document: &Document, string: &Part, expression: &str) -> bool {
    let span = &string.span;
    let mut tried = document.text.as_str().to_owned();
    tried.replace_range(span.clone(), &format!("\"{expression}\""));
    let end = span.start + expression.len() + 2;
    let refuses = |finding: &appell_spec::Diagnostic| {
        let place = finding.labels.first().map(|(place, _)| place.start);
        finding.code == Code::NotAllowedHere
            && place.is_some_and(|place| (span.start..end).contains(&place))
    };
    let findings = Reading::new("", &tried).findings;
    !findings.iter().any(refuses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_innermost_call_is_found() {
        assert_eq!(call_around("2*dot("), Some(("dot", 0)));
        assert_eq!(call_around("velocity(P, x, "), Some(("velocity", 2)));
        assert_eq!(call_around("max(sin(a), (b"), Some(("", 0)));
        assert_eq!(call_around("max(sin(a), b"), Some(("max", 1)));
        assert_eq!(call_around("sin(a) + "), None);
        assert_eq!(call_around("𝛂(é"), Some(("", 0)));
    }
}
