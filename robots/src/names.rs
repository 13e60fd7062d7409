//! Names of a file as names of a spec.

use std::collections::{BTreeMap, BTreeSet};

use appell_spec::limits::MAX_NAME;

/// Largest length of prefixes and suffixes of names that are built from another name.
const ROOM: usize = 16;

/// The names of one namespace.
#[derive(Debug, Default)]
pub(crate) struct Names {
    taken: BTreeSet<String>,
    /// The last number appended to a name.
    counts: BTreeMap<String, usize>,
}

impl Names {
    /// A namespace in which some names are taken.
    pub(crate) fn without(taken: &[&str]) -> Self {
        Self {
            taken: taken.iter().map(|name| (*name).to_owned()).collect(),
            counts: BTreeMap::new(),
        }
    }

    /// A unique valid name, as close to `name` as possible.
    pub(crate) fn new_one(&mut self, name: &str) -> String {
        let valid = legal(name);
        let mut candidate = valid.clone();
        let count = self.counts.entry(valid.clone()).or_insert(1);
        while appell_spec::is_reserved(&candidate) || !self.taken.insert(candidate.clone()) {
            *count += 1;
            let number = format!("_{count}");
            let kept = valid.len().min(MAX_NAME - number.len());
            candidate = format!("{}{number}", &valid[..kept]);
        }
        candidate
    }

    /// The same, or one close to `otherwise` if the name is taken.
    pub(crate) fn free_one(&mut self, name: &str, otherwise: &str) -> String {
        let valid = legal(name);
        let is_free = !appell_spec::is_reserved(&valid) && !self.taken.contains(&valid);
        self.new_one(if is_free { name } else { otherwise })
    }
}

/// The valid characters of a name.
fn legal(name: &str) -> String {
    let kept = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
    let mut kept: String = kept.collect();
    if !kept.starts_with(|c: char| c.is_ascii_alphabetic()) {
        kept.insert(0, 'n');
    }
    kept.truncate(MAX_NAME);
    kept
}

/// A name that is short enough for prefixes.
pub(crate) fn short(name: &str) -> String {
    name.chars().take(MAX_NAME - ROOM).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_kept_as_far_as_a_spec_allows() {
        let mut names = Names::without(&["ground"]);
        for (name, expected) in [
            ("elbow", "elbow"),
            ("elbow", "elbow_2"),
            ("left-arm/1", "left_arm_1"),
            ("2nd", "n2nd"),
            ("ground", "ground_2"),
            ("sin", "sin_2"),
            ("", "n"),
            ("é", "n_"),
        ] {
            assert_eq!(names.new_one(name), expected);
        }
        assert!(names.new_one(&"x".repeat(500)).len() <= MAX_NAME);
    }
}
