//! Hover text: the meaning of a name, its uses, and the equations that contain it.

use appell_spec::ast::{Entry, ItemAst, SpecAst, ValueAst};
use appell_spec::expr::Span;
use appell_spec::joints;
use appell_spec::occurrences::{Namespace, Occurrence};
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind, Position};

use crate::document::Document;
use crate::markdown::{block, code, prose};

/// Limit on listed uses; beyond it, only their number is given.
const MOST_USES: usize = 8;
/// Limit in characters on a value shown as written.
const MOST_LETTERS: usize = 80;

/// The text about the name at a position.
pub(crate) fn hover(document: &Document, position: Position) -> Option<Hover> {
    let name = document.name_at(position)?;
    let written = definition(&document.reading.ast, name);
    let mut paragraphs = match written {
        Some((section, item)) => described(document, section, item),
        None => made(document, name).or_else(|| Some(vec![supplied(name)?.to_owned()]))?,
    };
    paragraphs.extend(uses(document, name));
    let contributions = document.contributions.as_ref();
    let key = (name.namespace, name.name.clone());
    paragraphs.extend(contributions.and_then(|all| all.get(&key)).cloned());
    Some(Hover {
        contents: HoverContents::Markup(MarkupContent {
            kind: MarkupKind::Markdown,
            value: paragraphs.join("\n\n"),
        }),
        range: Some(document.text.range(&name.span)),
    })
}

/// The section of a name, and its item.
fn definition<'a>(ast: &'a SpecAst, name: &Occurrence) -> Option<(&'static str, &'a ItemAst)> {
    ast.sections.iter().find_map(|section| {
        let word = section.section.name;
        let mut items = section.items.iter();
        let is_here = Namespace::of_section(word) == Some(name.namespace);
        let item = items.find(|item| is_here && item.name.value == name.name)?;
        Some((word, item))
    })
}

/// The origin of a name that a joint defines: its title, and the joint.
fn made(document: &Document, name: &Occurrence) -> Option<Vec<String>> {
    let joint = joints::maker(&document.reading.ast, name.namespace, &name.name)?;
    let mut all = described(document, "joints", joint);
    if let Some((section, item)) = definition(document.reading.expanded(), name) {
        let unit = item.unit("unit").map(|unit| unit.value.text.as_str());
        let unit = unit.map_or_else(String::new, |unit| format!(", in {}", prose(unit)));
        let title = format!(
            "**{}** {}{unit}, made by the",
            singular(section),
            code(&name.name)
        );
        all.insert(0, title);
    }
    Some(all)
}

/// One item of a section, in words.
fn singular(section: &str) -> &str {
    match section {
        "pseudo_velocities" => "pseudo-velocity",
        "bodies" => "body",
        other => other.strip_suffix('s').unwrap_or(other),
    }
}

/// The name with its value, its description, and the other keys of its table.
fn described(document: &Document, section: &str, item: &ItemAst) -> Vec<String> {
    let written = |span: &Span| written(document, span);
    let plain = |span: &Span| prose(&written(span));
    let kind = item.kind.map(|kind| kind.word.replace('_', " "));
    let unit = item.unit("unit").map(|unit| unit.value.text.as_str());
    let value = match (item.number("value"), unit) {
        (Some(value), Some(unit)) => format!(" = {} {}", plain(&value.span), prose(unit)),
        (Some(value), None) => format!(" = {}", plain(&value.span)),
        (None, Some(unit)) => format!(", in {}", prose(unit)),
        (None, None) => kind.map_or_else(String::new, |kind| format!(", {kind}")),
    };
    let title = format!(
        "**{}** {}{value}",
        singular(section),
        code(&item.name.value)
    );
    let about = item.text("about").map(|about| prose(about.value));
    let is_told = |entry: &Entry| {
        let is_value = entry.key.name == "value" && matches!(entry.value, ValueAst::Number(_));
        is_value || matches!(entry.key.name, "about" | "unit")
    };
    let rest = item.entries.iter().filter(|entry| !is_told(entry));
    let rest = rest.map(|entry| format!("{} = {}", entry.key.name, written(&entry.span)));
    let rest: Vec<String> = rest.collect();
    let rest = (!rest.is_empty()).then(|| block(&rest));
    [Some(title), about, rest].into_iter().flatten().collect()
}

/// A value as written, on one line.
fn written(document: &Document, span: &Span) -> String {
    let words = document.text.part(span).split_whitespace();
    let line = words.collect::<Vec<_>>().join(" ");
    if line.chars().count() <= MOST_LETTERS {
        return line;
    }
    line.chars().take(MOST_LETTERS).chain(['…']).collect()
}

fn supplied(name: &Occurrence) -> Option<&'static str> {
    match (name.namespace, name.name.as_str()) {
        (Namespace::Frame, "ground") => Some("**frame** `ground`, the inertial frame"),
        (Namespace::Point, "O") => Some("**point** `O`, the origin of the ground"),
        _ => None,
    }
}

fn uses(document: &Document, name: &Occurrence) -> Option<String> {
    let places = document.places(name.namespace, &name.name);
    let mut places: Vec<&str> = places
        .filter(|place| !place.defines)
        .map(|place| place.within.as_str())
        .collect();
    places.dedup();
    let shown = places.iter().take(MOST_USES);
    let shown: Vec<String> = shown.map(|place| code(place)).collect();
    let more = match places.len().saturating_sub(MOST_USES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!shown.is_empty()).then(|| format!("Used in {}{more}", shown.join(", ")))
}
