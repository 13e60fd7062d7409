//! Names and patterns `ELEMENT.ATTRIBUTE` of numbers of a file.

use std::collections::{BTreeMap, BTreeSet};

/// Attributes that can be parameters.
const ATTRIBUTES: &str = "mass com com.x com.y com.z inertia damping armature frictionloss stiffness springref ref kp kv gear gain bias \
                          forcerange timeconst delay gravity gravity.x gravity.y gravity.z";
/// Those of bodies, and of joints.
pub(crate) const OF_BODIES: &[&str] = &["mass", "com.x", "com.y", "com.z", "inertia"];
pub(crate) const OF_JOINTS: &[&str] = &[
    "damping",
    "armature",
    "frictionloss",
    "stiffness",
    "springref",
    "ref",
];
/// The element of gravity.
pub(crate) const OPTION: &str = "option";

/// Whether a name ends in one of the attributes.
pub(crate) fn has_attribute(name: &str) -> bool {
    name.contains('*') || ends_in_attribute(name)
}

fn ends_in_attribute(name: &str) -> bool {
    let mut all = ATTRIBUTES.split_ascii_whitespace();
    all.any(|attribute| {
        let rest = name.strip_suffix(attribute);
        rest.is_some_and(|rest| rest.ends_with('.'))
    })
}

/// Names and patterns, and the names that exist.
#[derive(Debug)]
pub(crate) struct Patterns<'a> {
    all: &'a [String],
    /// All names that exist.
    pub(crate) known: BTreeSet<String>,
    /// By body: those that are fixed to it.
    fixed_to: BTreeMap<String, Vec<String>>,
}

impl<'a> Patterns<'a> {
    pub(crate) fn new(patterns: &'a [String]) -> Self {
        Self {
            all: patterns,
            known: BTreeSet::new(),
            fixed_to: BTreeMap::new(),
        }
    }

    /// Declares attributes of an element.
    pub(crate) fn declare(&mut self, element: &str, attributes: &[&str]) {
        let names = attributes.iter().flat_map(|one| names(element, one));
        self.known.extend(names);
    }

    /// Declares a body and those that are fixed to it, which are selected together.
    pub(crate) fn declare_body(&mut self, body: &str, fixed_to_it: Vec<String>) {
        for one in fixed_to_it.iter().map(String::as_str).chain([body]) {
            self.declare(one, OF_BODIES);
        }
        self.fixed_to.insert(body.to_owned(), fixed_to_it);
    }

    /// Whether a number is selected: by its name, or, if it is not zero, by a pattern.
    pub(crate) fn choose(&self, element: &str, attribute: &str, value: f64) -> bool {
        let zero_too = value != 0.0 || attribute.starts_with("com.");
        self.any(element, attribute, |pattern, name| {
            pattern == name || (zero_too && fits(pattern, name))
        })
    }

    /// Whether a number is selected by its name.
    pub(crate) fn names(&self, element: &str, attribute: &str) -> bool {
        self.any(element, attribute, |pattern, name| pattern == name)
    }

    fn any(&self, element: &str, attribute: &str, is: impl Fn(&str, &str) -> bool) -> bool {
        if attribute.is_empty() || self.all.is_empty() {
            return false;
        }
        let mut all = names(element, attribute);
        if OF_BODIES.contains(&attribute) {
            let others = self.fixed_to.get(element).into_iter().flatten();
            all.extend(others.flat_map(|other| names(other, attribute)));
        }
        let mut patterns = self.all.iter();
        patterns.any(|pattern| all.iter().any(|name| is(pattern, name)))
    }

    /// The first name without an element, or pattern without an attribute.
    pub(crate) fn unknown(&self) -> Option<&String> {
        let is_known = |pattern: &&String| {
            if pattern.contains('*') {
                ends_in_attribute(pattern) || self.known.iter().any(|name| fits(pattern, name))
            } else {
                self.known.contains(*pattern)
            }
        };
        self.all.iter().find(|pattern| !is_known(pattern))
    }
}

/// The names of a number: `hand.com.x` is also `hand.com`, gravity needs no element.
fn names(element: &str, attribute: &str) -> Vec<String> {
    let whole = attribute.split_once('.').map(|(whole, _)| whole);
    let mut names: Vec<String> = [Some(attribute), whole]
        .into_iter()
        .flatten()
        .map(|attribute| format!("{element}.{attribute}"))
        .collect();
    if element == OPTION {
        names.push("gravity".to_owned());
    }
    names
}

/// Whether a name fits a pattern, in which `*` stands for any characters.
fn fits(pattern: &str, name: &str) -> bool {
    let Some((first, rest)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let (middle, last) = rest.rsplit_once('*').unwrap_or(("", rest));
    let inner = name.strip_prefix(first);
    let Some(mut inner) = inner.and_then(|inner| inner.strip_suffix(last)) else {
        return false;
    };
    middle.split('*').all(|part| {
        let found = inner.find(part);
        inner = found.map_or("", |at| &inner[at + part.len()..]);
        found.is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_stands_for_any_characters() {
        for (pattern, name, expected) in [
            ("*.mass", "hand.mass", true),
            ("*.mass", "hand.mass.mass", true),
            ("*.mass", "hand.massive", false),
            ("left_*.com", "left_arm.com", true),
            ("left_*.com", "right_arm.com", false),
            ("*", "anything", true),
            ("hand.mass", "hand.mass", true),
            ("hand.mass", "hand.masses", false),
            ("a*b*c", "axxbyyc", true),
            ("a*b*c", "axxbyy", false),
        ] {
            assert_eq!(fits(pattern, name), expected, "{pattern} {name}");
        }
    }
}
