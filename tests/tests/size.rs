//! The source of a crate may not grow beyond its baseline.

#![allow(clippy::unwrap_used, reason = "a missing file fails the test")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use appell_tests::shipped;

/// Sizes are rounded up to a multiple of this, so that small corrections need no decision.
const ROUNDED: usize = 100;

/// Lines of Rust below a folder.
fn lines(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).unwrap();
    let lines = entries.map(|entry| {
        let path = entry.unwrap().path();
        match path.extension() {
            _ if path.is_dir() => lines(&path),
            Some(extension) if extension == "rs" => {
                fs::read_to_string(&path).unwrap().lines().count()
            }
            _ => 0,
        }
    });
    lines.sum()
}

/// Lines of the source of each crate.
fn sizes() -> BTreeMap<String, usize> {
    let root = shipped::workspace();
    let workspace = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let workspace: toml::Table = workspace.parse().unwrap();
    let members = workspace["workspace"]["members"].as_array().unwrap().iter();
    let members = members.map(|member| member.as_str().unwrap().to_owned());
    let with_source = members.filter(|member| root.join(member).join("src").is_dir());
    with_source
        .map(|member| (member.clone(), lines(&root.join(&member).join("src"))))
        .collect()
}

#[test]
fn no_crate_is_larger_than_its_baseline() {
    let (sizes, file) = (
        sizes(),
        shipped::workspace().join("tests/size_baseline.toml"),
    );
    if std::env::var_os("UPDATE_SIZES").is_some() {
        let mut text = String::from(
            "# Largest number of lines in `src` of each crate. `UPDATE_SIZES=1 cargo test -p appell-tests size`\n\
             # writes this file; a larger crate needs a reason in the commit.\n\n",
        );
        for (member, lines) in &sizes {
            writeln!(text, "\"{member}\" = {}", lines.next_multiple_of(ROUNDED)).unwrap();
        }
        fs::write(&file, text).unwrap();
    }
    let baseline: toml::Table = fs::read_to_string(&file).unwrap().parse().unwrap();
    for (member, lines) in &sizes {
        let most = baseline.get(member).and_then(toml::Value::as_integer);
        let most = most.unwrap_or_else(|| panic!("tests/size_baseline.toml lacks {member}"));
        let lines = i64::try_from(*lines).unwrap();
        assert!(
            lines <= most,
            "{member} has {lines} lines of at most {most}"
        );
    }
}
