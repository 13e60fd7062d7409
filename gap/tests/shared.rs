//! The recordings that stand beside the workspace are read, all of them.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

mod common;

use std::path::{Path, PathBuf};

use appell_gap::data::{FindingKind, NoiseSource, Part, read};
use common::library;

/// The folders below one of the shared folders that hold a description; none where it is absent.
fn folders(of: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let Ok(entries) = std::fs::read_dir(root.join(of)) else {
        println!("skipped: there is no ../shared/{of} beside the workspace");
        return Vec::new();
    };
    let mut folders: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("recording.toml").exists())
        .collect();
    folders.sort();
    folders
}

#[test]
fn every_development_case_is_read_and_its_noise_is_known() {
    let (mut far, mut channels) = (Vec::new(), 0);
    for folder in folders("gap/dev") {
        let set = read(&folder, &library(), None)
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        assert_eq!(set.runs.len(), 5);
        let tests = set.runs.iter().filter(|run| run.part == Part::Test);
        assert_eq!(tests.count(), 2);
        for channel in set.channels.iter().filter(|c| c.is_measured()) {
            let noise = channel.noise.unwrap();
            let Some(stated) = channel.stated_noise else {
                continue;
            };
            channels += 1;
            let factor = noise.found.unwrap() / stated;
            println!(
                "{} {:8} stated {:.3e} factor {factor:.2} {:?} {:?}",
                folder.file_name().unwrap().to_string_lossy(),
                channel.column,
                stated,
                noise.source,
                noise.quantum,
            );
            // Statements are wrong by a factor of two at most.
            if !(0.4..2.5).contains(&factor) && noise.source != NoiseSource::Stated {
                far.push(format!("{} {}: {factor}", folder.display(), channel.column));
            }
        }
    }
    println!("{channels} channels");
    assert!(far.is_empty(), "{far:#?}");
}

#[test]
fn every_real_recording_is_read_and_only_the_time_of_a_log_is_mended() {
    for folder in folders("realdata") {
        let set = read(&folder, &library(), None)
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        println!("{} {}", folder.display(), set.mechanism.name);
        for channel in set.channels.iter().filter(|c| c.is_measured()) {
            println!(
                "  {:8} stated {:?} {:?}",
                channel.column, channel.stated_noise, channel.noise
            );
            assert!(channel.noise.is_some(), "{}", channel.column);
        }
        for finding in &set.findings {
            println!(
                "  {:?}: {:?} {}",
                finding.kind, finding.run, finding.message
            );
        }
        let lost = [
            FindingKind::BackwardTime,
            FindingKind::MissingTime,
            FindingKind::UnknownColumn,
            FindingKind::Dropouts,
        ];
        assert!(set.findings.iter().all(|f| !lost.contains(&f.kind)));
    }
}
