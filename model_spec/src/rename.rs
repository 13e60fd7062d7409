//! Renaming of an item, at its definition and all its uses.

use crate::ast::ItemAst;
use crate::diagnostic::{Diagnostic, Severity};
use crate::expr::Span;
use crate::joints;
use crate::name;
use crate::occurrences::{Namespace, Occurrence, occurrences};
use crate::outline::Outline;
use crate::parse::parse;
use crate::resolve::{is_reserved, resolve};
use crate::suggest::shown;

/// Why an item cannot be renamed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RenameError {
    /// The new name is invalid.
    #[error("`{}` is not a valid name: a name is {}", shown(.0), name::RULE)]
    Invalid(String),
    /// The word has another meaning in expressions.
    #[error("`{0}` is reserved in expressions; choose another name")]
    Reserved(String),
    /// The name is taken.
    #[error("`{0}` is taken; choose another name")]
    Taken(String),
    /// The item is predefined.
    #[error("`{0}` is defined by the language and keeps its name")]
    Supplied(String),
    /// The name is derived from a joint.
    #[error(
        "`{name}` is named after the joint `{joint}`; rename the joint, or name it with a key of the joint"
    )]
    NamedAfter {
        /// The name.
        name: String,
        /// The joint.
        joint: String,
    },
    /// There may be uses in parts that could not be parsed.
    #[error("the spec has a syntax error; correct it first: {0}")]
    Broken(String),
    /// A use is written with escapes.
    #[error("a use of `{0}` is written with escapes; write it out first")]
    Escaped(String),
    /// The spec would be invalid with the new name.
    #[error("with this name the spec is no longer valid: {0}")]
    Refused(String),
}

/// The positions of a name, each with its replacement. Replacing all of them keeps the spec valid.
///
/// The frame and the point of a joint have one name, and its coordinates and pseudo-velocities may be named
/// after it.
pub fn rename(
    text: &str,
    namespace: Namespace,
    old: &str,
    new: &str,
) -> Result<Vec<(Span, String)>, RenameError> {
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
    let named = |namespace: Namespace, name: &str| -> Vec<&Occurrence> {
        let of = |o: &&Occurrence| o.namespace == namespace && o.name == name;
        all.iter().filter(of).collect()
    };
    let places = named(namespace, old);
    if !places.iter().any(|place| place.defines) {
        return Err(RenameError::Supplied(old.to_owned()));
    }
    if new != old && (!named(namespace, new).is_empty() || is_supplied(namespace, new)) {
        return Err(RenameError::Taken(new.to_owned()));
    }
    let joint = joints::maker(&ast, namespace, old);
    let words = match joint {
        Some(joint) if namespace == Namespace::Quantity => {
            if joints::named_after(joint).iter().any(|name| name == old) {
                return Err(RenameError::NamedAfter {
                    name: old.to_owned(),
                    joint: joint.name.value.clone(),
                });
            }
            vec![(namespace, old.to_owned(), new.to_owned())]
        }
        Some(joint) => of_joint(joint, new),
        None => vec![(namespace, old.to_owned(), new.to_owned())],
    };
    let mut edits: Vec<(Span, String)> = Vec::new();
    for (namespace, old, new) in &words {
        for place in named(*namespace, old) {
            // Items named after a joint have no definition of their own in the text.
            if joint.is_some_and(|joint| {
                place.defines
                    && *old != joint.name.value
                    && place.span.start == joint.name.span.start
            }) {
                continue;
            }
            if text.get(place.span.clone()) != Some(old) {
                return Err(RenameError::Escaped(old.clone()));
            }
            edits.push((place.span.clone(), new.clone()));
        }
    }
    edits.sort_by_key(|(place, _)| place.start);
    edits.dedup();
    let renamed = replaced(text, &edits);
    let (before, after) = (errors(text), errors(&renamed));
    match after.first() {
        Some(error) if after.len() > before.len() => {
            Err(RenameError::Refused(error.message.clone()))
        }
        _ => Ok(edits),
    }
}

fn is_supplied(namespace: Namespace, name: &str) -> bool {
    matches!(
        (namespace, name),
        (Namespace::Frame, "ground") | (Namespace::Point, "O")
    )
}

/// The words that change with the name of a joint: those of its frame and point, and those named after it.
fn of_joint(joint: &ItemAst, new: &str) -> Vec<(Namespace, String, String)> {
    let mut renamed = joint.clone();
    new.clone_into(&mut renamed.name.value);
    let own = |namespace| (namespace, joint.name.value.clone(), new.to_owned());
    let after = joints::named_after(joint).into_iter();
    let after = after.zip(joints::named_after(&renamed));
    let after = after.map(|(old, new)| (Namespace::Quantity, old, new));
    [Namespace::Frame, Namespace::Point]
        .map(own)
        .into_iter()
        .chain(after)
        .collect()
}

/// A text with replacements at disjoint positions.
fn replaced(text: &str, edits: &[(Span, String)]) -> String {
    let mut whole = String::with_capacity(text.len());
    let mut at = 0;
    for (place, word) in edits {
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
