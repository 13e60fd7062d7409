//! The manual is true: its tables are those of the program, and its examples load.
//!
//! `APPELL_UPDATE_MANUAL=1 cargo test -p appell-spec manual` writes the tables anew.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use appell_spec::diagnostic::{CODES, Stage};
use appell_spec::expr::Function;
use appell_spec::language::{AXES, Form, Key, Need, SECTIONS, Shape};
use appell_spec::units::{PREFIXES, UNITS};
use appell_spec::{Code, Report, limits, load, parse};

fn manual_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/spec-reference.md")
}

fn manual() -> String {
    std::fs::read_to_string(manual_path()).unwrap()
}

fn form_words(form: &Form) -> String {
    match form {
        Form::Text => "sentence".to_owned(),
        Form::Name | Form::NewName => "name".to_owned(),
        Form::NewNames(count) => format!("{count} names"),
        Form::Values(count) => format!("{count} numbers"),
        Form::Direction => {
            let words = AXES.iter().map(|w| format!("`{}`, ", w.text));
            words.collect::<String>() + "or three expressions"
        }
        Form::Reference(target) => format!("name of a {}", target.word()),
        Form::Unit => "unit".to_owned(),
        Form::Number => "number".to_owned(),
        Form::Numbers => "list of numbers".to_owned(),
        Form::Range => "two numbers".to_owned(),
        Form::Expression => "expression".to_owned(),
        Form::Components => "three expressions".to_owned(),
        Form::Matrix => "three rows of three expressions".to_owned(),
        Form::Quaternion => "names of four coordinates".to_owned(),
        Form::Two(target) => format!("names of two {}s", target.word()),
        Form::Word(words) => words
            .iter()
            .map(|w| format!("`{}`", w.text))
            .collect::<Vec<_>>()
            .join(", "),
        Form::Flag => "`true` or `false`".to_owned(),
        Form::Inertia(_) => "table, or expression".to_owned(),
        Form::Table(_) => "table".to_owned(),
        Form::Tables(_) => "list of tables".to_owned(),
    }
}

fn need_words(need: Need) -> String {
    match need {
        Need::Always => "yes".to_owned(),
        Need::Optional => "no".to_owned(),
        Need::Way(n) => format!("way {}", n + 1),
    }
}

fn key_table(keys: &[Key]) -> String {
    let mut text = "| key | value | required | meaning |\n|---|---|---|---|\n".to_owned();
    for key in keys {
        let (form, need) = (form_words(&key.form), need_words(key.need));
        writeln!(text, "| `{}` | {form} | {need} | {} |", key.name, key.about).unwrap();
    }
    for key in keys {
        if let Form::Table(inner) | Form::Tables(inner) | Form::Inertia(inner) = &key.form {
            write!(text, "\nKeys of `{}`:\n\n{}", key.name, key_table(inner)).unwrap();
        }
    }
    text
}

/// Tables of keys inside of keys, each only where it stands first.
fn once(text: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in text.split("\n\n") {
        let is_table = part.starts_with("| key");
        let is_inner = is_table && parts.last().is_some_and(|last| last.starts_with("Keys of"));
        let is_repeated = is_inner && parts[..parts.len() - 1].contains(&part.trim_end());
        if is_repeated {
            parts.pop();
        } else {
            parts.push(part.trim_end());
        }
    }
    parts.join("\n\n") + "\n"
}

fn section_tables(name: &str) -> String {
    let section = SECTIONS.iter().find(|s| s.name == name).unwrap();
    match &section.shape {
        Shape::Table(keys) | Shape::Items(keys, _) => key_table(keys),
        Shape::Kinds(kinds) => {
            let kinds = kinds.iter().map(|k| {
                let keys = key_table(k.keys);
                format!("`kind = \"{}\"`: {}\n\n{keys}", k.word, k.about)
            });
            once(&kinds.collect::<Vec<_>>().join("\n"))
        }
        Shape::States => String::new(),
    }
}

fn unit_table() -> String {
    let mut text = "| unit | name | in SI | prefixes |\n|---|---|---|---|\n".to_owned();
    for unit in UNITS {
        let size = match (unit.size, unit.times_pi) {
            ((1, 1), false) => "1".to_owned(),
            ((n, 1), pi) => format!("{n}{}", if pi { "π" } else { "" }),
            ((1, d), true) => format!("π/{d}"),
            ((n, d), pi) => format!("{n}{}/{d}", if pi { "π" } else { "" }),
        };
        let prefixes = if unit.prefixed { "yes" } else { "no" };
        writeln!(
            text,
            "| `{}` | {} | {size} | {prefixes} |",
            unit.symbol, unit.name
        )
        .unwrap();
    }
    let prefixes: Vec<String> = PREFIXES
        .iter()
        .map(|(prefix, ten)| format!("`{prefix}` 10^{ten}"))
        .collect();
    write!(text, "\nPrefixes: {}.\n", prefixes.join(", ")).unwrap();
    text
}

fn limit_table() -> String {
    let mut text = "| what | at most |\n|---|---|\n".to_owned();
    for (what, most) in [
        ("bytes of a file", limits::MAX_FILE),
        ("items of a section", limits::MAX_ITEMS),
        ("parameters", limits::MAX_PARAMETERS),
        ("samples of a signal", limits::MAX_SAMPLES),
        ("characters of a name", limits::MAX_NAME),
        ("bytes of a sentence", limits::MAX_SENTENCE),
        ("turns of a frame", limits::MAX_TURNS),
        ("bytes of an expression", limits::MAX_EXPRESSION),
        ("nested operations of an expression", limits::MAX_DEPTH),
        ("digits of a number", limits::MAX_DIGITS),
        (
            "power of ten of a number",
            limits::MAX_TEN.unsigned_abs() as usize,
        ),
        (
            "exponent in an expression",
            limits::MAX_EXPONENT.unsigned_abs() as usize,
        ),
    ] {
        writeln!(text, "| {what} | {most} |").unwrap();
    }
    text
}

/// The message that the bad spec of a code gives.
fn example(code: &str) -> String {
    let name = format!("{code}.toml");
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/bad_specs")
        .join(&name);
    let text = std::fs::read_to_string(path).unwrap();
    match load(&name, &text) {
        Ok(checked) => Report::new(name, text, checked.warnings).plain(),
        Err(report) => report.plain(),
    }
}

fn code_sections() -> String {
    let mut sections = Vec::new();
    for info in CODES {
        let mut text = format!(
            "### `{}`\n\n{}.\n\n{}\n",
            info.text, info.title, info.explanation
        );
        match info.stage {
            Stage::Spec => write!(text, "\n```text\n{}\n```\n", example(info.text)).unwrap(),
            Stage::Derivation => text.push_str("\nFound while the equations are derived.\n"),
        }
        sections.push(text);
    }
    sections.join("\n")
}

fn generated(what: &str) -> String {
    match what.split_once(' ') {
        Some(("keys", section)) => section_tables(section),
        _ => match what {
            "units" => unit_table(),
            "limits" => limit_table(),
            "codes" => code_sections(),
            _ => panic!("nothing generates `{what}`"),
        },
    }
}

/// The manual with all generated parts written anew.
fn renewed(text: &str) -> String {
    let mut result = String::new();
    let mut rest = text;
    while let Some(start) = rest.find("<!-- generated: ") {
        let (before, from) = rest.split_at(start);
        let (mark, after) = from.split_once('\n').unwrap();
        let what = mark.strip_prefix("<!-- generated: ").unwrap();
        let what = what.strip_suffix(" -->").unwrap();
        let end = after.find("<!-- end -->").unwrap();
        write!(result, "{before}{mark}\n\n{}\n", generated(what)).unwrap();
        rest = &after[end..];
    }
    result + rest
}

#[test]
fn tables_are_those_of_the_program() {
    let text = manual();
    let renewed = renewed(&text);
    if std::env::var_os("APPELL_UPDATE_MANUAL").is_some() {
        std::fs::write(manual_path(), renewed).unwrap();
        return;
    }
    let difference = text.lines().zip(renewed.lines()).find(|(a, b)| a != b);
    assert_eq!(difference, None, "run with APPELL_UPDATE_MANUAL=1");
    assert_eq!(text, renewed, "run with APPELL_UPDATE_MANUAL=1");
}

#[test]
fn every_section_code_and_function_has_its_place() {
    let text = manual();
    for section in SECTIONS {
        assert!(
            text.contains(&format!("\n## `[{}]`\n", section.name)),
            "{}",
            section.name
        );
    }
    for info in CODES {
        assert!(
            text.contains(&format!("\n### `{}`\n", info.text)),
            "{}",
            info.text
        );
    }
    for (_, name, arity) in Function::ALL {
        let documented = ["`", "("]
            .iter()
            .any(|after| text.contains(&format!("`{name}{after}")));
        assert!(documented, "{name} with {arity} arguments");
    }
}

/// The blocks of TOML in the manual.
fn examples() -> Vec<String> {
    let text = manual();
    text.split("\n```toml\n")
        .skip(1)
        .map(|block| block.split("```").next().unwrap().to_owned())
        .collect()
}

#[test]
fn whole_examples_load_without_findings() {
    let whole: Vec<String> = examples()
        .into_iter()
        .filter(|e| e.contains("[mechanism]"))
        .collect();
    assert!(!whole.is_empty());
    for text in whole {
        let checked = load("manual.toml", &text).unwrap_or_else(|report| panic!("{report}"));
        let warnings = Report::new("manual.toml", text, checked.warnings);
        assert!(warnings.diagnostics().is_empty(), "{warnings}");
    }
}

#[test]
fn fragments_are_written_in_the_language() {
    for text in examples() {
        let (_, mut findings) = parse::parse(&text);
        findings.retain(|f| f.code != Code::MissingSection);
        let report = Report::new("manual.toml", text.as_str(), findings);
        assert!(report.diagnostics().is_empty(), "{report}");
    }
}
