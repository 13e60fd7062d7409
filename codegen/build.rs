//! A number that changes with the code that derives and schedules, for the cache of its results.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::Path;

fn main() {
    let mut hasher = DefaultHasher::new();
    // Beside this crate in its repository; elsewhere the version tells them apart.
    for folder in ["src", "../model_spec/src", "../runtime/src"] {
        println!("cargo::rerun-if-changed={folder}");
        add(Path::new(folder), &mut hasher);
    }
    println!("cargo::rustc-env=APPELL_SOURCES={:016x}", hasher.finish());
}

/// Adds the files of a folder in the order of their names.
fn add(path: &Path, hasher: &mut DefaultHasher) {
    if let Ok(entries) = path.read_dir() {
        let mut entries: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        entries.sort_unstable();
        for entry in entries {
            add(&entry, hasher);
        }
    } else if let Ok(text) = std::fs::read(path) {
        text.hash(hasher);
    }
}
