//! Plausible mistakes: each is reported at its line with a readable message; correct specs are not reported.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use appell_codegen::audit::audit;
use appell_codegen::{audited, derived};
use appell_spec::Report;

/// Marks the line of a mistake in a spec.
const MARK: &str = "# the mistake";

fn specs(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

fn shipped() -> Vec<PathBuf> {
    specs("../generated/mechanisms")
}

fn name_of(path: &Path) -> &str {
    path.file_stem().unwrap().to_str().unwrap()
}

/// All diagnostics of a spec.
fn told(path: &Path) -> Report {
    let text = std::fs::read_to_string(path).unwrap();
    let file = path.file_name().unwrap().to_str().unwrap();
    match audited(file, &text) {
        Ok(audited) => Report::new(file, text, audited.warnings),
        Err(report) => report,
    }
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_snapshot_path("audit/snapshots");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// The files are named `<code>.<variant>.toml`.
#[test]
fn each_mistake_is_caught_at_its_line() {
    let specs = specs("tests/audit");
    assert!(specs.len() >= 25, "only {} mistakes", specs.len());
    for path in specs {
        let name = name_of(&path);
        let code = name.split('.').next().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let line = text.lines().position(|line| line.ends_with(MARK));
        let line = line.unwrap_or_else(|| panic!("{name} marks no line")) + 1;
        let report = told(&path);
        let caught = report.diagnostics().iter().any(|diagnostic| {
            let place = diagnostic.labels.first().map_or(0, |(span, _)| span.start);
            diagnostic.code.text() == code && report.line_column(place).0 == line
        });
        assert!(caught, "{name}, line {line}:\n{report}");
    }
}

#[test]
fn messages_read_as_reviewed() {
    for path in specs("tests/audit") {
        snapshot(name_of(&path), &told(&path).plain());
    }
}

#[test]
fn shipped_mechanisms_are_told_nothing_but_what_is_true() {
    for path in shipped() {
        snapshot(&format!("shipped_{}", name_of(&path)), &told(&path).plain());
    }
}

#[test]
fn what_is_right_but_unusual_is_not_warned_of() {
    for path in specs("tests/audit/right") {
        let report = told(&path);
        let text = std::fs::read_to_string(&path).unwrap();
        let derived = derived(name_of(&path), &text).unwrap();
        let warnings = audit(&derived.mechanism, &derived.derivation).warnings;
        assert!(warnings.is_empty(), "{report}");
        snapshot(&format!("right_{}", name_of(&path)), &report.plain());
    }
}

#[test]
fn the_example_in_the_manual_audits_clean() {
    for path in specs("../docs/examples/own-mechanism/mechanisms") {
        assert!(told(&path).diagnostics().is_empty(), "{}", told(&path));
    }
}
