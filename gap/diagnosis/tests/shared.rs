//! The recordings that stand beside the workspace are read, all of them, in a full run.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::path::PathBuf;

use appell_estimate::smoothing::Samples;
use appell_estimate::smoothing::kinematic::Kinematic;
use appell_estimate::smoothing::spline::SmoothingSpline;
use appell_recordings::{FindingKind, Part, read};
use appell_test_kit::{is_full, workspace};

use crate::common::library;

/// A statement may be wrong by a factor of two; the data tell the level to a tenth.
const WRONG: std::ops::Range<f64> = 0.45..2.2;

/// Rates smoothed in two ways agree to some percent: the recorded ones are late by most of a millisecond.
const AGREE: f64 = 0.02;

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

/// A rig whose angle and angular velocity were both recorded: the velocity, denoised by its authors, was
/// found in another way than ours.
#[test]
fn rates_smoothed_from_angles_are_those_that_were_recorded() {
    for folder in folders("realdata") {
        if !folder.ends_with("multiarm_single") {
            continue;
        }
        let set = read(&folder, library(), None).unwrap();
        let [theta, omega] = ["theta", "omega"].map(|column| {
            let mut channels = set.channels.iter();
            channels
                .position(|channel| channel.column == column)
                .unwrap()
        });
        let noise = set.channels[theta].noise.unwrap().std;
        for run in &set.runs {
            let samples = Samples::new(&run.times, &run.values[theta]).unwrap();
            let model = Kinematic::most_likely(3, Some(noise), samples).unwrap();
            let spline = SmoothingSpline::cross_validated(3, samples).unwrap();
            let theirs = &run.values[omega];
            let size: f64 = theirs.iter().map(|rate| rate * rate).sum();
            for ours in [model.smooth(samples).unwrap().estimate, spline.estimate] {
                let pairs = ours.derivative(1).into_iter().zip(theirs);
                let off: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
                let part = (off / size).sqrt();
                assert!(part < AGREE, "{}: {part}", run.name);
            }
        }
    }
}
