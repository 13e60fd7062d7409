//! Another name for an item, at its definition and at every use.

use crate::diagnostic::{Diagnostic, Severity};
use crate::expr::Span;
use crate::joints;
use crate::name;
use crate::occurrences::{Namespace, Occurrence, occurrences};
use crate::outline::Outline;
use crate::parse::parse;
use crate::resolve::{is_reserved, resolve};
use crate::suggest::shown;

/// Why an item keeps its name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RenameError {
    /// The name may not be defined.
    #[error("`{}` is not a valid name: a name is {}", shown(.0), name::RULE)]
    Invalid(String),
    /// Expressions use the word otherwise.
    #[error("`{0}` is reserved in expressions; choose another name")]
    Reserved(String),
    /// Something else has the name.
    #[error("`{0}` is taken; choose another name")]
    Taken(String),
    /// The language supplies it.
    #[error("`{0}` is defined by the language and keeps its name")]
    Supplied(String),
    /// Uses may stand in what cannot be read.
    #[error("the spec has a syntax error; correct it first: {0}")]
    Broken(String),
    /// A use is written with escapes.
    #[error("a use of `{0}` is written with escapes; write it out first")]
    Escaped(String),
    /// The spec would be wrong with the new name.
    #[error("with this name the spec is no longer valid: {0}")]
    Refused(String),
}

/// The places of a name that take another one. With all of them replaced the spec is as valid as before.
pub fn rename(
    text: &str,
    namespace: Namespace,
    old: &str,
    new: &str,
) -> Result<Vec<Span>, RenameError> {
    if !name::is_valid(new) {
        return Err(RenameError::Invalid(new.to_owned()));
    }
    if namespace == Namespace::Quantity && is_reserved(new) {
        return Err(RenameError::Reserved(new.to_owned()));
    }
    let (ast, findings) = parse(text);
    if let Some(finding) = findings.iter().find(|f| f.severity == Severity::Error) {
        return Err(RenameError::Broken(finding.message.clone()));
    }
    let all = occurrences(text, &ast, &Outline::new(text));
    let named = |name: &str| -> Vec<&Occurrence> {
        let of = |o: &&Occurrence| o.namespace == namespace && o.name == name;
        all.iter().filter(of).collect()
    };
    let places = named(old);
    if !places.iter().any(|place| place.defines) {
        return Err(RenameError::Supplied(old.to_owned()));
    }
    if new != old && (!named(new).is_empty() || is_supplied(namespace, new)) {
        return Err(RenameError::Taken(new.to_owned()));
    }
    let spans: Vec<Span> = places.iter().map(|place| place.span.clone()).collect();
    if spans.iter().any(|span| text.get(span.clone()) != Some(old)) {
        return Err(RenameError::Escaped(old.to_owned()));
    }
    let renamed = replaced(text, &spans, new);
    let (before, after) = (errors(text), errors(&renamed));
    match after.first() {
        Some(error) if after.len() > before.len() => {
            Err(RenameError::Refused(error.message.clone()))
        }
        _ => Ok(spans),
    }
}

fn is_supplied(namespace: Namespace, name: &str) -> bool {
    matches!(
        (namespace, name),
        (Namespace::Frame, "ground") | (Namespace::Point, "O")
    )
}

/// A text with another word at places that do not overlap.
fn replaced(text: &str, places: &[Span], word: &str) -> String {
    let mut whole = String::with_capacity(text.len());
    let mut at = 0;
    for place in places {
        whole.push_str(text.get(at..place.start).unwrap_or_default());
        whole.push_str(word);
        at = place.end;
    }
    whole + text.get(at..).unwrap_or_default()
}

fn errors(text: &str) -> Vec<Diagnostic> {
    let (ast, mut findings) = parse(text);
    let ast = joints::expand(&ast, text).map_or(ast, |expansion| {
        findings.extend(expansion.findings);
        expansion.ast
    });
    findings.extend(resolve(&ast, "", text).1);
    findings.retain(|finding| finding.severity == Severity::Error);
    findings
}
