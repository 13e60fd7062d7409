//! Every rule has a spec that breaks it, a message that is worth reading, and a place in the
//! manual.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use appell_spec::diagnostic::{CODES, MAX_SHOWN, Stage};
use appell_spec::{Report, load};

/// The bad specs: `<code>.toml` or `<code>.<variant>.toml`.
fn bad_specs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_specs");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

/// Errors, or else warnings, of a spec.
fn findings(path: &Path) -> Report {
    let text = std::fs::read_to_string(path).unwrap();
    let name = path.file_name().unwrap().to_str().unwrap();
    match load(name, &text) {
        Ok(checked) => Report::new(name, text, checked.warnings),
        Err(report) => report,
    }
}

#[test]
fn each_bad_spec_gives_its_own_code_and_nothing_else() {
    for path in bad_specs() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let code = name.split('.').next().unwrap();
        let report = findings(&path);
        assert!(!report.diagnostics().is_empty(), "{name} passes");
        for diagnostic in report.diagnostics() {
            assert_eq!(diagnostic.code.text(), code, "{name}:\n{report}");
        }
        let several = name.ends_with(".several");
        assert!(
            several || report.diagnostics().len() == 1,
            "{name}:\n{report}"
        );
    }
}

#[test]
fn messages_read_as_reviewed() {
    for path in bad_specs() {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name, findings(&path).plain()));
    }
}

#[test]
fn every_code_of_this_crate_has_a_bad_spec() {
    let files = bad_specs();
    let stems: Vec<&str> = files
        .iter()
        .map(|path| path.file_stem().unwrap().to_str().unwrap())
        .collect();
    for info in CODES.iter().filter(|c| c.stage == Stage::Spec) {
        assert!(stems.contains(&info.text), "no bad spec for {}", info.text);
    }
}

#[test]
fn every_code_is_in_the_table_once_and_in_order() {
    for (i, info) in CODES.iter().enumerate() {
        assert_eq!(info.code as usize, i);
        assert_eq!(CODES.iter().filter(|c| c.text == info.text).count(), 1);
        assert!(info.explanation.ends_with('.'), "{}", info.text);
    }
}

#[test]
fn ten_mistakes_give_ten_messages_in_one_pass() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ten_mistakes.toml");
    let report = findings(&path);
    let codes: Vec<&str> = report.diagnostics().iter().map(|d| d.code.text()).collect();
    assert_eq!(
        codes,
        [
            "value-outside-limits",
            "unknown-unit",
            "not-finite",
            "empty-range",
            "unknown-name",
            "unit-mismatch",
            "unknown-key",
            "unknown-word",
            "unknown-reference",
            "expression-syntax",
        ],
        "\n{report}"
    );
    insta::assert_snapshot!("ten_mistakes", report.plain());
}

#[test]
fn a_coloured_report_says_the_same() {
    let report = findings(&bad_specs()[0]);
    let mut plain = String::new();
    let mut inside = false;
    for c in report.coloured().chars() {
        match c {
            '\u{1b}' => inside = true,
            'm' if inside => inside = false,
            _ if !inside => plain.push(c),
            _ => {}
        }
    }
    assert_eq!(plain, report.plain());
}

#[test]
fn a_long_report_is_cut_short() {
    let lines: Vec<String> = (0..150)
        .map(|i| format!("o{i} = {{ value = \"1 +\" }}\n"))
        .collect();
    let text = format!("[outputs]\n{}", lines.concat());
    let report = load("long.toml", &text).unwrap_err();
    let hidden = report.diagnostics().len() - MAX_SHOWN;
    let shown = report.plain();
    assert_eq!(shown.matches("error[").count(), MAX_SHOWN);
    assert!(shown.ends_with(&format!("… and {hidden} more")), "{shown}");
}

#[test]
fn a_file_that_is_too_large_is_named() {
    let report = load("large.toml", &"#".repeat(2_000_000)).unwrap_err();
    assert_eq!(report.diagnostics().len(), 1);
    let shown = report.plain();
    assert!(
        shown.contains("error[limit-exceeded]") && shown.contains("large.toml"),
        "{shown}"
    );
}
