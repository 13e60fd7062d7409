//! The commands of the documents, run as they stand by a shell, in a folder that holds the files they name.

use std::fs;
use std::path::Path;

use crate::support::{Folder, repository};

/// A document, what stands before its commands, and the block at which a test of its own begins.
struct Document {
    path: &'static str,
    prepare: fn(&Folder),
    until: Option<&'static str>,
}

const DOCUMENTS: &[Document] = &[
    Document {
        path: "docs/add-a-mechanism.md",
        prepare: |folder| {
            let spec = fs::read_to_string(repository("docs/examples/ball_and_beam.toml"));
            folder.write("ball_and_beam.toml", &spec.expect("the spec"));
        },
        until: None,
    },
    Document {
        path: "docs/command-line.md",
        prepare: |folder| {
            folder.done(&["sample", "rig", "rig"]);
            for run in ["run1.csv", "run2.csv"] {
                let swing = [
                    "simulate",
                    "pendulum",
                    "--initial",
                    "theta=0.5",
                    "--csv",
                    run,
                ];
                folder.done(&swing);
            }
        },
        until: None,
    },
    Document {
        path: "docs/ensembles.md",
        prepare: |_| {},
        until: None,
    },
    Document {
        path: "docs/gap-diagnosis.md",
        prepare: |folder| {
            for rig in ["rig", "rig_today", "rig_in_spring", "rigs/one", "rigs/two"] {
                folder.done(&["sample", "rig", rig]);
            }
            for run in ["run1.csv", "run2.csv", "run3.csv"] {
                folder.write(run, &folder.read(&format!("rig/{run}")));
            }
            folder.write("my_spec.toml", &folder.read("rig/my_rig.toml"));
            let effects = fs::read_to_string(repository("docs/effects.md")).expect("the document");
            folder.write("my_effect.toml", blocks(&effects, "toml")[0]);
        },
        // `walk_through.rs` goes on in an empty folder.
        until: Some("appell sample rig ."),
    },
];

/// The blocks of a language.
pub(crate) fn blocks<'t>(text: &'t str, language: &str) -> Vec<&'t str> {
    let fence = format!("```{language}\n");
    let blocks = text.split(fence.as_str()).skip(1);
    blocks.filter_map(|rest| rest.split("```").next()).collect()
}

/// Runs a line in a folder; `appell` is the program under test.
pub(crate) fn shell(folder: &Folder, line: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_appell"))
        .parent()
        .expect("a folder");
    let paths = std::env::var("PATH").unwrap_or_default();
    let told = std::process::Command::new("sh")
        .args(["-c", line])
        .current_dir(folder.path("."))
        .env("PATH", format!("{}:{paths}", program.display()))
        .output()
        .expect("a shell");
    let errors = String::from_utf8_lossy(&told.stderr);
    assert!(told.status.success(), "{line}\n{errors}");
}

#[test]
fn the_commands_of_the_documents_run_as_they_stand() {
    for document in DOCUMENTS {
        let text = fs::read_to_string(repository(document.path)).expect("the document");
        let folder = Folder::new();
        (document.prepare)(&folder);
        let blocks = blocks(&text, "sh");
        let own = |block: &&&str| document.until.is_none_or(|until| !block.starts_with(until));
        let mut ran = 0;
        for block in blocks.iter().take_while(own) {
            let lines = block.replace("\\\n", " ");
            for line in lines.lines().filter(|line| line.starts_with("appell ")) {
                shell(&folder, line);
                ran += 1;
            }
        }
        assert!(ran > 2, "{}: {ran}", document.path);
    }
}

/// The pictures of the README are those that the commands above them make; `UPDATE_DRAWINGS=1` writes them anew.
#[test]
fn the_pictures_of_the_readme_are_made_by_its_commands() {
    let text = fs::read_to_string(repository("README.md")).expect("the document");
    let folder = Folder::new();
    let lines = blocks(&text, "sh").into_iter().flat_map(str::lines);
    lines
        .filter(|line| line.starts_with("appell "))
        .for_each(|line| shell(&folder, line));
    let shown = text.split("src=\"docs/pictures/").skip(1);
    let names: Vec<&str> = shown.filter_map(|rest| rest.split('"').next()).collect();
    assert!(names.len() > 3, "{names:?}");
    for name in names {
        let path = repository(&format!("docs/pictures/{name}"));
        let made = folder.read(name);
        if std::env::var_os("UPDATE_DRAWINGS").is_some() {
            fs::write(&path, &made).expect("the picture");
        }
        let kept = fs::read_to_string(&path).unwrap_or_default();
        assert!(
            made == kept,
            "{name} is another one: UPDATE_DRAWINGS=1 writes it anew"
        );
    }
}
