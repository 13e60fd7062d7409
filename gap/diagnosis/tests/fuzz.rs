//! Damaged descriptions and recordings are refused or read, never with a panic and never slowly.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use appell_gap::diagnose::{Options, diagnose};
use appell_recordings::motion_capture::Skeleton;
use appell_test_kit::{Random, budget, is_full};

use crate::common::{Folder, SWING, pendulum, swing};

/// Damaged data sets, in an ordinary run and in a full one; each is read once.
const DAMAGED: [usize; 2] = [300, 1_500];
/// Damaged skeletons, captures and files of laboratories.
const CAPTURES: [usize; 2] = [120, 600];
/// Damaged data sets that are diagnosed.
const DIAGNOSED: usize = 24;
/// One in so many faults, and in so many effects that are compared with it: some of all families.
const ONE_IN: [[usize; 2]; 2] = [[5, 12], [1, 4]];
/// Far below a second, with room for a busy machine.
const SLOWEST: Duration = Duration::from_millis(500);

/// Pieces that mean something to TOML, to CSV or to numbers.
const TELLING: &[&[u8]] = &[
    b"\"",
    b",",
    b";",
    b"\n",
    b"\r\n",
    b"#",
    b"=",
    b"{",
    b"}",
    b"[",
    b"]",
    b"nan",
    b"inf",
    b"-",
    b"1e308",
    b"1e-320",
    b"1e999",
    b"0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\0",
    b"t",
    b"theta",
    b" ",
];

fn damage(bytes: &mut Vec<u8>, dice: &mut Random) {
    for _ in 0..=dice.below(2) {
        let at = dice.below(bytes.len() + 1);
        let end = (at + dice.below(30)).min(bytes.len());
        match dice.below(4) {
            0 if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            1 => {
                let piece = TELLING[dice.below(TELLING.len())];
                bytes.splice(at..at, piece.iter().copied());
            }
            2 => {
                bytes.drain(at..end);
            }
            _ => {
                let copy = bytes[at..end].to_vec();
                let to = dice.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
        }
    }
}

#[test]
fn damaged_data_sets_are_refused_or_read() {
    let folder = Folder::new();
    let description = pendulum(SWING, &["a.csv"], &["b.csv"]).into_bytes();
    let recording = swing(60, 1, 1e-3).into_bytes();
    folder.write("b.csv", &recording);
    let mut dice = Random::new(1);
    let damaged = budget(DAMAGED[0], DAMAGED[1]);
    let (mut read, mut slowest) = (0, Duration::ZERO);
    for round in 0..damaged {
        let (mut toml, mut csv) = (description.clone(), recording.clone());
        if round % 2 == 0 {
            damage(&mut toml, &mut dice);
        } else {
            damage(&mut csv, &mut dice);
        }
        folder.write("recording.toml", toml).write("a.csv", csv);
        let start = Instant::now();
        match folder.read() {
            Ok(set) => {
                read += 1;
                for run in &set.runs {
                    assert!(run.times.windows(2).all(|pair| pair[0] < pair[1]));
                    for values in &run.values {
                        assert_eq!(values.len(), run.times.len());
                        assert!(values.iter().all(|value| !value.is_infinite()));
                    }
                }
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        slowest = slowest.max(start.elapsed());
    }
    println!("{read} of {damaged} are read; the slowest took {slowest:?}");
    assert!((damaged / 20..damaged / 2).contains(&read), "{read}");
    assert!(slowest < SLOWEST, "{slowest:?}");
}

/// A take of Motive: rows of a header, then an angle that swings.
fn take() -> Vec<u8> {
    let mut text = "Format Version,1.23,Take Name,swing,Length Units,Meters\n\n\
                    ,Type,Rigid Body,Rigid Body\n,Name,arm,arm\n\
                    ,ID,\"9A,1\",\"9A,1\"\n,,Rotation,Position\n\
                    Frame,Time (Seconds),X,X\n"
        .to_owned();
    for row in 0..60 {
        let t = f64::from(row) / 120.0;
        writeln!(text, "{row},{t:.6},{:.4},0.1", 20.0 * (3.0 * t).sin()).unwrap();
    }
    text.into_bytes()
}

/// Bytes without a meaning, behind the beginning of a file of C3D or of Motive.
fn noise(beginning: &[u8], dice: &mut Random) -> Vec<u8> {
    let length = dice.below(2000);
    let byte = |_| u8::try_from(dice.below(256)).unwrap();
    let rest: Vec<u8> = (0..length).map(byte).collect();
    [beginning, &rest].concat()
}

#[test]
fn damaged_takes_and_noise_for_a_capture_are_refused_or_read() {
    let folder = Folder::new();
    let take = take();
    let channels = "\"arm.Rotation.X\" = { measures = \"theta\", unit = \"deg\" }";
    let mut dice = Random::new(2);
    let mut slowest = Duration::ZERO;
    for file in ["run.csv", "run.c3d"] {
        folder.write("recording.toml", pendulum(channels, &[file], &[]));
        let beginnings: [&[u8]; 3] = match file {
            "run.csv" => [b"", b"Format Version,1.23\n", &take[..120]],
            // The key, then headers that promise parameters in the second block.
            _ => [b"", b"\x02\x50", b"\x02\x50\x01\0\x02\0\x01\0\xff\xff"],
        };
        for round in 0..budget(CAPTURES[0], CAPTURES[1]) {
            let bytes = if file == "run.csv" && round % 2 == 0 {
                let mut bytes = take.clone();
                damage(&mut bytes, &mut dice);
                bytes
            } else {
                noise(beginnings[round % 3], &mut dice)
            };
            folder.write(file, bytes);
            let start = Instant::now();
            match folder.read() {
                Ok(set) => assert!(!set.runs.is_empty()),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
            slowest = slowest.max(start.elapsed());
        }
    }
    assert!(slowest < SLOWEST, "{slowest:?}");
}

#[test]
fn damaged_skeletons_are_refused_or_read() {
    let skeleton = include_bytes!("../../../docs/examples/euc/skeleton.toml");
    let mut dice = Random::new(3);
    let captures = budget(CAPTURES[0], CAPTURES[1]);
    let (mut read, mut slowest) = (0, Duration::ZERO);
    for _ in 0..captures {
        let mut bytes = skeleton.to_vec();
        damage(&mut bytes, &mut dice);
        let text = String::from_utf8_lossy(&bytes);
        let start = Instant::now();
        match Skeleton::parse("skeleton.toml", &text) {
            Ok(_) => read += 1,
            Err(report) => assert!(!report.to_string().is_empty()),
        }
        slowest = slowest.max(start.elapsed());
    }
    assert!((captures / 50..captures).contains(&read), "{read}");
    assert!(slowest < SLOWEST, "{slowest:?}");
}

/// What a channel may show of a rig on which something is broken.
fn broken(round: usize, row: usize, value: f64) -> f64 {
    match round % 10 {
        0 => 0.25,
        1 => 1e6 * value,
        2 => 1e-9 * value,
        3 if (20..40).contains(&row) => f64::NAN,
        4 if row.is_multiple_of(2) => f64::NAN,
        5 if row > 30 => 1e3,
        6 => value + 1e6,
        7 => -value,
        8 if row == 25 => 1e12,
        9 => (row * row % 7) as f64 * 1e3,
        _ => value,
    }
}

/// One column of all runs is broken, or the clock goes by another unit.
fn rig_with_a_fault(round: usize, text: &str) -> String {
    let mut lines = text.lines();
    let mut out = format!("{}\n", lines.next().unwrap());
    for (row, line) in lines.enumerate() {
        let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        match round / 10 {
            0 => cells[1] = broken(round, row, cells[1]),
            1 => cells[2] = broken(round, row, cells[2]),
            _ => cells[0] *= [1e-4, 1e3, 1e6, 1e-9][round % 4],
        }
        let cells: Vec<String> = cells.iter().map(f64::to_string).collect();
        writeln!(out, "{}", cells.join(",")).unwrap();
    }
    out
}

#[test]
fn a_rig_with_a_fault_is_diagnosed_or_refused() {
    let folder = Folder::new();
    folder.write(
        "recording.toml",
        pendulum(SWING, &["a.csv", "b.csv"], &["c.csv"]),
    );
    let effects = appell_gap::effects::shipped().unwrap();
    let [faults, of_effects] = ONE_IN[usize::from(is_full())];
    let effects: Vec<_> = effects.into_iter().step_by(of_effects).collect();
    let rounds = (0..DIAGNOSED).step_by(faults);
    let (mut told, count) = (0, rounds.len());
    for round in rounds {
        for (seed, name) in (1..).zip(["a.csv", "b.csv", "c.csv"]) {
            folder.write(name, rig_with_a_fault(round, &swing(60, seed, 1e-3)));
        }
        let Ok(set) = folder.read() else {
            continue;
        };
        match diagnose(&set, &effects, &Options::default(), |_| ()) {
            Ok(report) => {
                told += 1;
                let sum: f64 = report.which.iter().map(|one| one.probability).sum();
                assert!((sum - 1.0).abs() < 1e-6, "round {round}: {sum}");
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    println!("{told} of {count} are diagnosed");
    assert!(told > count / 4, "{told}");
}
