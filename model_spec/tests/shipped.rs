//! The shipped specs are without findings, and speak the names that recordings use.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use appell_spec::{Mechanism, Report, load, starter};

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../generated/mechanisms");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

/// Loads a spec that must be without errors and warnings.
fn clean(name: &str, text: &str) -> Mechanism {
    let checked = load(name, text).unwrap_or_else(|report| panic!("{report}"));
    let warnings = Report::new(name, text, checked.warnings);
    assert!(warnings.diagnostics().is_empty(), "{warnings}");
    checked.mechanism
}

fn mechanisms() -> Vec<Mechanism> {
    shipped()
        .iter()
        .map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            let mechanism = clean(path.to_str().unwrap(), &text);
            assert_eq!(
                path.file_stem().unwrap().to_str(),
                Some(mechanism.name.as_str())
            );
            mechanism
        })
        .collect()
}

/// One line per mechanism: what recordings and scripts refer to.
fn names(mechanism: &Mechanism) -> String {
    let list = |names: Vec<&str>| names.join(" ");
    format!(
        "{} | {} | {} | {} | {}",
        mechanism.name,
        list(
            mechanism
                .coordinates
                .iter()
                .map(|c| c.label.name.as_str())
                .collect()
        ),
        list(
            mechanism
                .pseudo_velocities
                .iter()
                .map(|s| s.label.name.as_str())
                .collect()
        ),
        list(
            mechanism
                .inputs
                .iter()
                .map(|i| i.label.name.as_str())
                .collect()
        ),
        list(
            mechanism
                .parameters
                .iter()
                .map(|p| p.label.name.as_str())
                .collect()
        ),
    )
}

#[test]
fn names_are_those_that_recordings_use() {
    let found: Vec<String> = mechanisms().iter().map(names).collect();
    for expected in include_str!("shipped_names.txt").lines() {
        let mechanism = expected.split(' ').next().unwrap_or_default();
        let of = |found: &&String| found.split(' ').next() == Some(mechanism);
        let found = found.iter().find(of).map(String::as_str);
        assert_eq!(found, Some(expected));
    }
}

#[test]
fn every_quantity_has_a_sentence_and_every_model_a_source() {
    for mechanism in mechanisms() {
        assert!(mechanism.source.is_some(), "{}", mechanism.name);
        let labels = (mechanism.parameters.iter().map(|p| &p.label))
            .chain(mechanism.coordinates.iter().map(|c| &c.label))
            .chain(mechanism.inputs.iter().map(|i| &i.label))
            .chain(mechanism.pseudo_velocities.iter().map(|s| &s.label))
            .chain(mechanism.outputs.iter().map(|o| &o.label));
        for label in labels {
            assert!(
                !label.about.is_empty(),
                "{}: {}",
                mechanism.name,
                label.name
            );
        }
        let items = (mechanism.frames.iter().map(|f| (&f.name, &f.about)))
            .chain(mechanism.points.iter().map(|p| (&p.name, &p.about)))
            .chain(mechanism.bodies.iter().map(|b| (&b.name, &b.about)))
            .chain(mechanism.constraints.iter().map(|c| (&c.name, &c.about)))
            .chain(mechanism.loads.iter().map(|l| (&l.name, &l.about)));
        for (name, about) in items {
            assert!(!about.is_empty(), "{}: {name}", mechanism.name);
        }
    }
}

#[test]
fn si_units_are_used_throughout() {
    for mechanism in mechanisms() {
        let labels = (mechanism.parameters.iter().map(|p| &p.label))
            .chain(mechanism.coordinates.iter().map(|c| &c.label))
            .chain(mechanism.inputs.iter().map(|i| &i.label))
            .chain(mechanism.pseudo_velocities.iter().map(|s| &s.label));
        for label in labels {
            assert!(
                (label.unit.scale - 1.0).abs() < f64::EPSILON,
                "{}",
                label.name
            );
        }
    }
}

#[test]
fn lines_and_places_agree_with_the_text() {
    for path in shipped() {
        let text = std::fs::read_to_string(&path).unwrap();
        let mechanism = clean("spec.toml", &text);
        let lines: Vec<&str> = text.lines().collect();
        for load in &mechanism.loads {
            assert_eq!(&text[load.span.clone()], load.name);
            assert!(lines[load.line - 1].starts_with(&load.name));
        }
        for frame in mechanism.frames.iter().skip(1) {
            assert_eq!(&text[frame.span.clone()], frame.name);
        }
    }
}

#[test]
fn loading_twice_gives_the_same() {
    for path in shipped() {
        let text = std::fs::read_to_string(&path).unwrap();
        let [a, b] = [(); 2].map(|()| format!("{:?}", clean("spec.toml", &text)));
        assert_eq!(a, b);
    }
}

#[test]
fn the_starter_loads_without_findings() {
    let text = starter("my_machine").unwrap();
    assert_eq!(clean("my_machine.toml", &text).name, "my_machine");
    for bad in ["", "2x", "a b", "é", &"a".repeat(65), "x\"\n[evil]"] {
        assert!(starter(bad).is_err(), "{bad}");
    }
}
