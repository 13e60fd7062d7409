//! Damaged specs are refused or read, never with a panic, slowly, or with much memory.
//!
//! `cargo test -p appell-spec fuzz -- --nocapture` tells the slowest text and the peak of
//! memory.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::time::Duration;

use appell_spec::edit::set_parameters;
use appell_spec::occurrences::{Namespace, occurrences};
use appell_spec::outline::Outline;
use appell_spec::parse::parse;
use appell_spec::rename::rename;
use appell_spec::{Report, load};
use appell_test_kit::{Random, ThreadTime, budget, peak_memory, shipped};

/// How many bytes are changed in all, in an ordinary run and in a full one.
const MUTATED_BYTES: [usize; 2] = [300_000, 3_000_000];
/// Processor time.
const SLOWEST: Duration = Duration::from_millis(500);
/// Most memory of the whole test, in MB; the texts themselves have at most 2 MB.
const MOST_MEMORY: u64 = 500;

/// Bytes that mean something to TOML or to expressions.
const TELLING: &[u8] = b"[]{}()=,.\"'\\\n#+-*/^<> 0e9_xtdu\xc3\xa9\xe2\x80\xae";

/// Damages a text; returns how many bytes it changed.
fn mutate(bytes: &mut Vec<u8>, others: &[Vec<u8>], dice: &mut Random) -> usize {
    let at = dice.below(bytes.len());
    let length = 1 + dice.below(24);
    let end = (at + length).min(bytes.len());
    match dice.below(6) {
        0 if !bytes.is_empty() => {
            bytes[at] ^= 1 << dice.below(8);
            1
        }
        1 if !bytes.is_empty() => {
            bytes[at] = TELLING[dice.below(TELLING.len())];
            1
        }
        2 => {
            bytes.insert(at, TELLING[dice.below(TELLING.len())]);
            1
        }
        3 => {
            bytes.drain(at..end);
            end - at
        }
        4 => {
            let copy = bytes[at..end].to_vec();
            let to = dice.below(bytes.len() + 1);
            bytes.splice(to..to, copy);
            end - at
        }
        _ => {
            let other = &others[dice.below(others.len())];
            let from = dice.below(other.len());
            let piece = &other[from..(from + length).min(other.len())];
            let changed = piece.len().max(end - at);
            bytes.splice(at..end, piece.iter().copied());
            changed
        }
    }
}

/// Reads a text and shows what was found; tells how long the reading took.
fn exercise(text: &str) -> Duration {
    let start = ThreadTime::now();
    let outcome = load("fuzz.toml", text);
    let names = occurrences(text, &parse(text).0, &Outline::new(text));
    let took = start.elapsed();
    for name in names {
        assert!(text.get(name.span).is_some(), "{}", name.name);
    }
    let report = match outcome {
        Ok(checked) => Report::new("fuzz.toml", text, checked.warnings),
        Err(report) => {
            assert!(report.has_errors());
            report
        }
    };
    let _ = report.plain();
    let _ = set_parameters(text, &[("m", 1.25), ("g", 9.8)]);
    let _ = rename(text, Namespace::Quantity, "m", "mass");
    took
}

/// How long a text takes to read, tried again while that is too long.
/// Tells what the texts took, and that it was not much.
fn is_frugal(texts: usize, slowest: Duration) {
    let peak = peak_memory();
    println!("{texts} texts, slowest {slowest:?}, peak of memory {peak:?} MB");
    assert!(peak.is_none_or(|peak| peak < MOST_MEMORY), "{peak:?} MB");
}

#[test]
fn damaged_bytes_do_no_harm() {
    let specs = shipped().into_iter();
    let specs: Vec<Vec<u8>> = specs.map(|(_, text)| text.into_bytes()).collect();
    let [ordinary, full] = MUTATED_BYTES;
    let wanted = budget(ordinary, full);
    let mut dice = Random::new(20);
    let mut changed = 0;
    let mut round = 0;
    let mut slowest = Duration::ZERO;
    while changed < wanted {
        let mut bytes = specs[round % specs.len()].clone();
        // From one slip of the pen to a wreck.
        let hits = [1, 2, 4, 16, 64, 256][round % 6];
        for _ in 0..hits {
            changed += mutate(&mut bytes, &specs, &mut dice);
        }
        let text = String::from_utf8_lossy(&bytes);
        let took = exercise(&text);
        assert!(took < SLOWEST, "{took:?}:\n{text}");
        slowest = slowest.max(took);
        round += 1;
    }
    is_frugal(round, slowest);
}

#[test]
fn hostile_texts_are_refused_quickly() {
    let mut texts = vec![
        "[".repeat(100_000),
        "a.".repeat(100_000),
        format!("x = {}", "[".repeat(100_000)),
        format!("x = {}", "{a=".repeat(50_000)),
        format!(
            "[coordinates]\nx = {{ unit = \"{}\" }}",
            "(".repeat(100_000)
        ),
        format!("[signals.s]\nt = [{}]", "1,".repeat(200_000)),
        format!("[outputs]\n{} = {{ value = \"x\" }}", "n".repeat(500_000)),
        format!("[outputs]\na = {{ value = {} }}", "9".repeat(500_000)),
        format!("[outputs]\na = {{ value = \"{}\" }}", "x+".repeat(200_000)),
        format!("[outputs]\na = {{ value = \"{}\" }}", "-".repeat(4000)),
        format!("[outputs]\na = {{ value = \"{}x\" }}", "2^".repeat(2000)),
        format!("[outputs]\na = {{ value = \"{}x\" }}", "sin(".repeat(1000)),
        "\u{202e}".repeat(100_000),
        "\"\"\"".repeat(50_000),
        "a = 1\n".repeat(100_000),
        "x".repeat(2_000_000),
        format!("[outputs.{}]\n", "n".repeat(500_000)) + &"a.b = ''\n".repeat(100_000),
    ];
    let mut many = "[outputs]\n".to_owned();
    for i in 0..20_000 {
        writeln!(many, "a{i} = {{ value = \"unknown_{i} + 1 [m]\" }}").unwrap();
    }
    texts.push(many);
    let mut chain = "[frames]\n".to_owned();
    for i in 0..256 {
        let parent = (i + 1) % 256;
        writeln!(
            chain,
            "f{i} = {{ parent = \"f{parent}\", about_axis = \"x\", by = 1 }}"
        )
        .unwrap();
    }
    texts.push(chain);
    let mut slowest = Duration::ZERO;
    for text in &texts {
        let start: String = text.chars().take(40).collect();
        let took = exercise(text);
        assert!(took < SLOWEST, "{took:?}: {start}");
        assert!(load("hostile.toml", text).is_err(), "{start}");
        slowest = slowest.max(took);
    }
    is_frugal(texts.len(), slowest);
}
