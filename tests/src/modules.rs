//! Which file of a crate uses which other: the graph behind the rules on modules.
//!
//! An edge `a → b` says that the code of `a` names an item that `b` defines, through however many
//! re-exports. Declaring modules and re-exporting their items is not use; tests are not looked at.
//! Methods are not followed, their types are: a type whose `impl` is spread over files counts where it
//! is defined.

mod cycles;
mod names;
mod paths;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use names::Tree;

/// The files of a crate by their paths below `src`, and what they use.
#[derive(Debug, Default)]
pub struct Modules {
    /// For each file, the files that it uses, each with one of the items.
    uses: BTreeMap<String, BTreeMap<String, String>>,
    /// For each file, the first segments of the paths that lead out of the crate.
    foreign: BTreeMap<String, BTreeSet<String>>,
}

impl Modules {
    /// Reads a crate from its root file, `lib.rs` or `main.rs`.
    pub fn read(root: &Path) -> Self {
        let tree = Tree::read(root);
        let mut modules = Self::default();
        for (module, file, path) in paths::all(&tree) {
            let used = modules.uses.entry(file.clone()).or_default();
            match tree.definition(module, &path) {
                Some((other, item)) if *other != file => {
                    used.entry(other.clone()).or_insert(item);
                }
                Some(_) => {}
                None => {
                    let foreign = modules.foreign.entry(file).or_default();
                    foreign.insert(path[0].clone());
                }
            }
        }
        modules
    }

    /// The files of a module: `folder.rs` and those in the folder.
    fn below<'a>(&'a self, folder: &'a str) -> impl Iterator<Item = &'a String> {
        self.uses.keys().filter(move |file| is_below(file, folder))
    }

    /// Sets of more than two files that all use each other, directly or not, each told as one way
    /// round.
    pub fn cycles(&self) -> Vec<String> {
        cycles::longer_than_two(&self.uses)
    }

    /// Uses of files below `known` by files below `folder`.
    pub fn knows(&self, folder: &str, known: &str) -> Vec<String> {
        let uses = |file: &String| {
            let used = self.uses[file].iter();
            let told = used.filter(|(other, _)| is_below(other, known));
            told.map(|(other, item)| format!("{file} → {item} → {other}"))
                .collect::<Vec<_>>()
        };
        self.below(folder).flat_map(uses).collect()
    }

    /// The folders and files directly below `src` that files below `folder` use, without its own.
    pub fn neighbours(&self, folder: &str) -> BTreeSet<&str> {
        let used = self.below(folder).flat_map(|file| self.uses[file].keys());
        let others = used.filter(|file| !is_below(file, folder));
        others.map(|file| top(file)).collect()
    }

    /// The files whose code names one of these crates.
    pub fn users_of(&self, crates: &[&str]) -> Vec<&str> {
        let uses = |names: &BTreeSet<String>| crates.iter().any(|name| names.contains(*name));
        let files = self.foreign.iter().filter(|(_, names)| uses(names));
        files.map(|(file, _)| file.as_str()).collect()
    }
}

/// Whether a file is `folder.rs` or in the folder.
fn is_below(file: &str, folder: &str) -> bool {
    let rest = file.strip_prefix(folder);
    rest.is_some_and(|rest| rest.starts_with(['/', '.']))
}

/// The first part of a path, without the ending of a file.
fn top(file: &str) -> &str {
    let first = file.split('/').next().unwrap_or(file);
    first.strip_suffix(".rs").unwrap_or(first)
}
