//! Files of the folders beside: those of `robots` become specs, those of `bad` are told what is wrong with them.

use std::path::{Path, PathBuf};

use appell_robots::{Failure, Options, import};

/// Path and text of the files of a folder.
fn files(folder: &str) -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(folder);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    assert!(paths.len() > 3, "{paths:?}");
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        (path, text)
    };
    paths.into_iter().map(read).collect()
}

fn name(path: &Path) -> String {
    path.file_name().unwrap().to_string_lossy().into_owned()
}

/// What a file becomes, with what is said about it.
fn told(path: &Path, text: &str) -> Result<String, String> {
    match import(&name(path), text, &Options::default()) {
        Ok(robot) => {
            appell_spec::load("robot.toml", &robot.spec)
                .unwrap_or_else(|report| panic!("{report}"));
            let warnings = robot.warnings.iter().map(appell_spec::Report::plain);
            let all: Vec<String> = [robot.spec].into_iter().chain(warnings).collect();
            Ok(all.join("\n").trim_end().to_owned())
        }
        Err(Failure::File(report)) => Err(report.plain()),
        Err(Failure::Unknown { name, help }) => Err(format!("{name}: {help}")),
        Err(Failure::Lock(why)) => Err(why),
    }
}

fn snapshot(path: &Path, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name(path), text));
}

#[test]
fn robots_become_specs_as_reviewed() {
    for (path, text) in files("robots") {
        snapshot(&path, &told(&path, &text).unwrap());
    }
}

#[test]
fn messages_read_as_reviewed() {
    for (path, text) in files("bad") {
        snapshot(&path, &told(&path, &text).unwrap_err());
    }
}

#[test]
fn nothing_panics_whatever_is_cut_off_or_changed() {
    for (path, text) in files("robots").into_iter().chain(files("bad")) {
        for at in (0..text.len())
            .filter(|at| text.is_char_boundary(*at))
            .step_by(31)
        {
            let _ = told_anyhow(&path, &text[..at]);
            let end = (at + 5..text.len())
                .find(|end| text.is_char_boundary(*end))
                .unwrap_or(text.len());
            for instead in ["", "\"", "9e999", "-1", "<", "nan"] {
                let _ = told_anyhow(&path, &[&text[..at], instead, &text[end..]].concat());
            }
        }
    }
    let deep = "<body>".repeat(100_000);
    let deep = format!("<mujoco><worldbody>{deep}");
    assert!(
        told_anyhow(Path::new("deep.xml"), &deep)
            .unwrap_err()
            .contains("nested")
    );
}

/// What a file becomes, be it a good spec or not.
fn told_anyhow(path: &Path, text: &str) -> Result<String, String> {
    match import(&name(path), text, &Options::default()) {
        Ok(robot) => Ok(robot.spec),
        Err(Failure::File(report)) => Err(report.plain()),
        Err(Failure::Unknown { name, .. } | Failure::Lock(name)) => Err(name),
    }
}
