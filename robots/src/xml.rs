//! Elements and attributes with their positions; collection of findings about them.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use appell_spec::{Code, Diagnostic, Severity, did_you_mean, shown};
use roxmltree::{Attribute, Document, Node};

/// Places in the text.
pub(crate) type Span = Range<usize>;

/// Deepest nesting of elements.
pub(crate) const MOST_NESTED: usize = 200;
/// Help for a file that has to be expanded.
pub(crate) const XACRO: &str = "this is a xacro file, expand it first: `xacro FILE > OUT.urdf`";
/// Most elements and texts of a file.
const MOST_NODES: u32 = 1 << 20;

/// An element whose attributes are read.
pub(crate) type Element<'x> = Node<'x, 'x>;

/// Findings about a file.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    all: RefCell<Vec<Diagnostic>>,
    errors: Cell<usize>,
}

/// Largest number of errors, and of warnings; further ones are dropped.
const MOST_FINDINGS: usize = 100;

impl Findings {
    /// Adds a finding unless it is a duplicate or there are too many.
    pub(crate) fn add(&self, finding: Diagnostic) {
        let mut all = self.all.borrow_mut();
        let is_error = finding.severity == Severity::Error;
        let count = if is_error {
            self.errors.get()
        } else {
            all.len() - self.errors.get()
        };
        if count < MOST_FINDINGS && !all.contains(&finding) {
            self.errors.set(self.errors.get() + usize::from(is_error));
            all.push(finding);
        }
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.errors.get() > 0
    }

    /// An error at a place, with a remedy.
    pub(crate) fn error(
        &self,
        code: Code,
        at: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.add(Diagnostic::error(code, message).at(at, "").help(help));
    }

    /// A warning at a place, with a remedy.
    pub(crate) fn warning(
        &self,
        code: Code,
        at: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.add(Diagnostic::warning(code, message).at(at, "").help(help));
    }

    pub(crate) fn into_inner(self) -> Vec<Diagnostic> {
        self.all.into_inner()
    }
}

/// Parses an XML document; the error is a diagnostic.
pub(crate) fn parse(text: &str) -> Result<Document<'_>, Diagnostic> {
    let options = roxmltree::ParsingOptions {
        nodes_limit: MOST_NODES,
        ..Default::default()
    };
    if let Some(at) = too_deep(text) {
        let message = format!("elements are nested more than {MOST_NESTED} deep");
        return Err(Diagnostic::error(Code::LimitExceeded, message).at(at..at + 1, ""));
    }
    Document::parse_with_options(text, options).map_err(|error| {
        let at = offset(text, error.pos());
        let found = error.to_string();
        let found = found
            .rsplit_once(" at ")
            .map_or(found.as_str(), |(found, _)| found);
        let help = match &error {
            roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro" => XACRO.to_owned(),
            roxmltree::Error::UnexpectedCloseTag(expected, ..) => {
                format!("close `{expected}` first, with `</{expected}>`")
            }
            roxmltree::Error::DtdDetected => "remove the `<!DOCTYPE …>`".to_owned(),
            _ => "URDF and MJCF are XML: every element is closed, every value is in quotes"
                .to_owned(),
        };
        Diagnostic::error(Code::WrongType, format!("not XML: {found}"))
            .at(at..(at + 1).min(text.len()), "")
            .help(help)
    })
}

/// The text with a byte order mark, and an XML declaration that is not at the beginning, replaced by blanks, so that
/// all positions are unchanged.
pub(crate) fn begun(text: &str) -> String {
    let blank = |part: &str| -> String {
        let bytes = part.bytes();
        bytes
            .map(|byte| if byte == b'\n' { '\n' } else { ' ' })
            .collect()
    };
    let body = text.trim_start_matches(|c: char| c == '\u{feff}' || c.is_whitespace());
    let (head, mut body) = text.split_at(text.len() - body.len());
    let mut begun = blank(head);
    if !head.is_empty()
        && body.starts_with("<?xml")
        && let Some(end) = body.find("?>").map(|at| at + 2)
    {
        begun.push_str(&blank(&body[..end]));
        body = &body[end..];
    }
    begun + body
}

/// Where elements are nested too deeply, by counting tags. Comments and texts with `<` can only raise the count
/// where the file is not XML.
fn too_deep(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(open) = text[at..].find('<').map(|found| at + found) {
        let rest = &text[open..];
        let skipped = [
            ("<!--", "-->"),
            ("<![CDATA[", "]]>"),
            ("<?", "?>"),
            ("<!", ">"),
        ];
        if let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at = open + rest.find(end).map_or(rest.len(), |found| found + end.len());
            continue;
        }
        let close = open + rest.find('>').unwrap_or(rest.len());
        if rest.starts_with("</") {
            depth = depth.saturating_sub(1);
        } else if !text[open..close].ends_with('/') {
            depth += 1;
            if depth > MOST_NESTED {
                return Some(open);
            }
        }
        at = (close + 1).min(text.len());
    }
    None
}

fn offset(text: &str, at: roxmltree::TextPos) -> usize {
    let (row, column) = (
        at.row.saturating_sub(1) as usize,
        at.col.saturating_sub(1) as usize,
    );
    let start: usize = text.split_inclusive('\n').take(row).map(str::len).sum();
    let line = text[start.min(text.len())..]
        .lines()
        .next()
        .unwrap_or_default();
    let within = line
        .char_indices()
        .nth(column)
        .map_or(line.len(), |(at, _)| at);
    (start + within).min(text.len())
}

/// The start tag of an element.
pub(crate) fn tag(element: Element<'_>) -> Span {
    let all = element.range();
    let text = &element.document().input_text()[all.clone()];
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), _) if open == c => quote = None,
            (None, '>') => return all.start..all.start + at + 1,
            _ => {}
        }
    }
    all
}

/// The children of an element with a name.
pub(crate) fn children<'x>(
    element: Element<'x>,
    name: &'static str,
) -> impl Iterator<Item = Element<'x>> {
    elements(element).filter(move |child| child.tag_name().name() == name)
}

/// The children of an element that are elements.
pub(crate) fn elements(element: Element<'_>) -> impl Iterator<Item = Element<'_>> {
    element.children().filter(Node::is_element)
}

/// The first child with a name.
pub(crate) fn child<'x>(element: Element<'x>, name: &'static str) -> Option<Element<'x>> {
    children(element, name).next()
}

/// Numbers of an attribute.
pub(crate) fn numbers(findings: &Findings, attribute: &Attribute<'_, '_>) -> Option<Vec<f64>> {
    let value = attribute.value();
    let mut numbers = Vec::new();
    for word in value.split_ascii_whitespace() {
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => numbers.push(number),
            _ => {
                let message = format!("`{}` is not a number", shown(word));
                let help = instead(word);
                findings.error(Code::WrongType, attribute.range_value(), message, help);
                return None;
            }
        }
    }
    Some(numbers)
}

/// The correction to suggest for a word that is not a number.
fn instead(word: &str) -> String {
    let pointed = word.replace(',', ".");
    if word.matches(',').count() == 1 && pointed.parse::<f64>().is_ok() {
        return format!("write `{pointed}`, with a decimal point");
    }
    if word.contains("${") || word.contains("$(") {
        return XACRO.to_owned();
    }
    if word.contains(',') {
        return "separate numbers by blanks".to_owned();
    }
    "write a number such as `0.5` or `1e-3`".to_owned()
}

/// A fixed number of numbers of an attribute.
pub(crate) fn exactly<const N: usize>(
    findings: &Findings,
    attribute: &Attribute<'_, '_>,
    what: &str,
) -> Option<[f64; N]> {
    let numbers = numbers(findings, attribute)?;
    let count = numbers.len();
    <[f64; N]>::try_from(numbers).ok().or_else(|| {
        let is = if count == 1 {
            "here is 1"
        } else {
            &format!("here are {count}")
        };
        let plural = if N == 1 { "number" } else { "numbers" };
        let message = format!("`{}` has {count} of {N} {plural}", attribute.name());
        let help = format!("{what} has {N} {plural}; {is}");
        findings.error(Code::WrongType, attribute.range_value(), message, help);
        None
    })
}

/// A number of an attribute of an element.
pub(crate) fn number(findings: &Findings, element: Element<'_>, key: &str) -> Option<f64> {
    let given = element.attribute_node(key)?;
    exactly::<1>(findings, &given, &format!("`{key}`")).map(|[number]| number)
}

/// A name that nothing has: the known one that was probably meant, or else some other help.
pub(crate) fn no_such<'a>(
    what: &str,
    name: &str,
    at: Span,
    known: impl IntoIterator<Item = &'a str>,
    otherwise: &str,
) -> Diagnostic {
    let message = format!("there is no {what} `{}`", shown(name));
    let help = did_you_mean(name, known, || otherwise.to_owned());
    Diagnostic::error(Code::UnknownReference, message)
        .at(at, "")
        .help(help)
}

/// A type that elements of a kind do not have.
pub(crate) fn no_type(elements: &str, word: &str, at: Span, types: &[&str]) -> Diagnostic {
    let message = format!("there are no {elements} of type `{}`", shown(word));
    let known = types.iter().copied();
    let help = did_you_mean(word, known, || format!("types are {}", types.join(", ")));
    Diagnostic::error(Code::UnknownWord, message)
        .at(at, "")
        .help(help)
}

/// The contents of an element.
pub(crate) fn inside(element: Element<'_>) -> Span {
    let (all, tag) = (element.range(), tag(element));
    let text = &element.document().input_text()[all.clone()];
    match text.rfind("</") {
        Some(close) if tag.end < all.end => tag.end..all.start + close,
        _ => tag.end..tag.end,
    }
}
