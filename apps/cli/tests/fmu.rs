//! FMUs, as an importer sees them: `FMPy` validates them, runs them in both kinds and asks for their derivatives.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{Folder, repository};

/// The importer, of a version whose answers are known.
const IMPORTER: &str = "fmpy==0.3.32";

fn ran(program: &Path, arguments: &[&str]) -> Result<Output, String> {
    let told = Command::new(program).args(arguments).output();
    match told {
        Ok(told) if told.status.success() => Ok(told),
        Ok(told) => Err(format!(
            "{} {arguments:?}:\n{}{}",
            program.display(),
            String::from_utf8_lossy(&told.stdout),
            String::from_utf8_lossy(&told.stderr)
        )),
        Err(cause) => Err(format!("{}: {cause}", program.display())),
    }
}

/// A Python that has the importer, installed once. Without one there is nothing, with the reason printed; a gate
/// (`CI=true`) fails.
fn python() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmpy-0.3.32");
    let python = folder.join("bin/python");
    if ran(&python, &["-c", "import fmpy"]).is_ok() {
        return Some(python);
    }
    // Another process may install at the same time.
    let draft = folder.with_extension(std::process::id().to_string());
    let told = ran(
        Path::new("python3"),
        &["-m", "venv", &draft.to_string_lossy()],
    )
    .and_then(|_| {
        ran(
            &draft.join("bin/python"),
            &["-m", "pip", "install", "-q", IMPORTER],
        )
    });
    if let Err(told) = told {
        let told = format!("there is no {IMPORTER}: {told}");
        assert!(std::env::var_os("CI").is_none(), "{told}");
        println!("not imported: {told}");
        return None;
    }
    if fs::rename(&draft, &folder).is_err() {
        return Some(draft.join("bin/python"));
    }
    Some(python)
}

#[test]
fn an_importer_finds_the_motions_and_derivatives_of_appell() {
    let Some(python) = python() else { return };
    let folder = Folder::new();
    let script = repository("apps/cli/tests/fmu/check.py");
    let here = folder.path(".").to_string_lossy().into_owned();
    let arguments = [script.as_str(), env!("CARGO_BIN_EXE_appell"), here.as_str()];
    let told = ran(&python, &arguments).unwrap_or_else(|told| panic!("{told}"));
    let told = String::from_utf8_lossy(&told.stdout);
    println!("{told}");
    assert!(told.contains("\nmodel exchange: "), "{told}");
}

#[test]
fn without_a_compiler_only_sources_are_written() {
    let folder = Folder::new();
    let run = |compiler: &str, more: &[&str]| {
        let arguments = ["export", "pendulum", "--fmu"];
        let told = Command::new(env!("CARGO_BIN_EXE_appell"))
            .args(arguments.iter().chain(more))
            .current_dir(folder.path("."))
            .env("CC", compiler)
            .output()
            .expect("the program runs");
        (
            told.status.code(),
            String::from_utf8_lossy(&told.stderr).into_owned(),
        )
    };
    let (status, told) = run("no-such-compiler", &[]);
    assert_eq!(status, Some(4), "{told}");
    assert!(
        told.contains("no C compiler was found (tried no-such-compiler)")
            && told.contains("see --sources-only"),
        "{told}"
    );
    let (status, told) = run("false", &[]);
    assert_eq!(status, Some(4), "{told}");
    assert!(
        told.contains("the C compiler `false` failed") && told.contains("see --sources-only"),
        "{told}"
    );
    assert!(folder.files().is_empty(), "{:?}", folder.files());
    let (status, told) = run("no-such-compiler", &["--sources-only"]);
    assert_eq!(status, Some(0), "{told}");
    assert_eq!(folder.files(), ["pendulum.fmu"]);
}

#[test]
fn an_fmu_has_its_extension_and_a_sound_spec() {
    let folder = Folder::new();
    folder.fails(
        2,
        &["export", "pendulum", "--fmu", "-o", "swing.zip"],
        &["write `--out swing.fmu`"],
    );
    folder.fails(2, &["export", "pendulum"], &["--fmu"]);
    folder.write("bad.toml", "[mechanism]\nname = \"bad\"\n");
    folder.fails(3, &["export", "bad.toml", "--fmu"], &["bad.toml"]);
    assert_eq!(folder.files(), ["bad.toml"]);
}
