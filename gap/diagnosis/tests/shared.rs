//! The recordings that stand beside the workspace are read, all of them, in a full run.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::path::PathBuf;

use appell_recordings::{FindingKind, Part, read};
use appell_test_kit::{is_full, workspace};

use crate::common::library;

/// A statement may be wrong by a factor of two; the data tell the level to a tenth.
const WRONG: std::ops::Range<f64> = 0.45..2.2;

/// The folders below one of the shared folders that hold a description. An ordinary run reads none:
/// they are no part of the repository. A full one fails without them.
fn folders(of: &str) -> Vec<PathBuf> {
    if !is_full() {
        return Vec::new();
    }
    let root = workspace().join("../shared").join(of);
    let entries = std::fs::read_dir(&root);
    let entries = entries.unwrap_or_else(|error| panic!("{}: {error}", root.display()));
    let mut folders: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("recording.toml").exists())
        .collect();
    folders.sort();
    assert!(!folders.is_empty(), "nothing in {}", root.display());
    folders
}

#[test]
fn every_development_case_is_read_and_its_noise_agrees_with_what_is_stated() {
    for folder in folders("gap/dev") {
        let case = folder.display();
        let set = read(&folder, library(), None).unwrap_or_else(|error| panic!("{case}: {error}"));
        assert_eq!(set.runs.len(), 5);
        let tests = set.runs.iter().filter(|run| run.part == Part::Test);
        assert_eq!(tests.count(), 2);
        for channel in set.channels.iter().filter(|c| c.is_measured()) {
            let noise = channel.noise.unwrap();
            let Some(stated) = channel.stated_noise else {
                continue;
            };
            let steps = noise.quantum.map_or(0.0, |step| step / 12f64.sqrt());
            let factor = noise.found.unwrap() / stated.hypot(steps);
            let column = &channel.column;
            assert!(WRONG.contains(&factor), "{case}, {column}: {factor}");
        }
    }
}

#[test]
fn every_real_recording_is_read_whole_and_its_noise_is_known() {
    let lost = [
        FindingKind::BackwardTime,
        FindingKind::MissingTime,
        FindingKind::UnknownColumn,
        FindingKind::Dropouts,
    ];
    for folder in folders("realdata") {
        let rig = folder.display();
        // A robot file is no spec.
        let manifest = std::fs::read_to_string(folder.join("recording.toml")).unwrap_or_default();
        if manifest.contains(".urdf\"") {
            continue;
        }
        let set = read(&folder, library(), None).unwrap_or_else(|error| panic!("{rig}: {error}"));
        for channel in set.channels.iter().filter(|c| c.is_measured()) {
            assert!(channel.noise.is_some(), "{rig}, {}", channel.column);
        }
        let told = set.findings.iter().find(|f| lost.contains(&f.kind));
        assert_eq!(told, None, "{rig}");
    }
}
