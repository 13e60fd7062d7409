//! The shipped specs as a library.
#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use std::path::{Path, PathBuf};

use appell_gap::data::Spec;

/// All shipped specs by name.
pub fn library() -> Vec<(&'static str, Spec)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../generated/mechanisms");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let entry = |path: PathBuf| {
        let name: &'static str = path
            .file_stem()
            .unwrap()
            .to_string_lossy()
            .to_string()
            .leak();
        let text = std::fs::read_to_string(&path).unwrap();
        let file = format!("{name}.toml");
        (name, Spec { file, text })
    };
    paths.into_iter().map(entry).collect()
}
