//! Damaged mechanisms are rejected or derived, without panic, long run time or excessive memory.
//!
//! The shipped specs are changed where a spec has meaning: expressions are exchanged and combined,
//! numbers, axes, frames, points and kinds replaced, items removed. Many still load, and are derived,
//! scheduled and emitted. `APPELL_FUZZ_CASES` sets how many; a fixed seed makes every run the same.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use appell_codegen::audit::{audit, reasons};
use appell_codegen::emit::emit_functions;
use appell_codegen::mechanics::{assemble, derive};
use appell_codegen::program::FunctionKind;
use appell_codegen::schedule::schedule;
use appell_test_kit::{Random, ThreadTime, budget, peak_memory, shipped};

/// Cases in an ordinary run and in a full one.
const CASES: [usize; 2] = [150, 1500];
/// Processor time. A case takes milliseconds; the rest is room for a debug build.
const SLOWEST: Duration = Duration::from_secs(4);
/// Bound on the memory of the process, in MB.
const MOST_MEMORY: u64 = 1000;
/// Functions of the program, one per case.
const KINDS: [FunctionKind; 5] = [
    FunctionKind::Rates,
    FunctionKind::MassMatrix,
    FunctionKind::MassMatrixAndBias,
    FunctionKind::ConstraintForces,
    FunctionKind::Outputs,
];

/// A piece of a spec: text in quotes with the key before it, a bare number, or anything else.
#[derive(Clone, PartialEq)]
enum Token {
    Quoted { key: String, text: String },
    Number(String),
    Other(String),
}

fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let (mut key, mut word) = (String::new(), String::new());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            '#' => rest.find('\n').unwrap_or(rest.len()),
            '0'..='9' | '-' => rest
                .find(|c: char| !c.is_ascii_digit() && !"-.e".contains(c))
                .unwrap_or(rest.len()),
            _ if c.is_alphabetic() => rest
                .find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(rest.len()),
            _ => c.len_utf8(),
        };
        let (piece, after) = rest.split_at(length);
        rest = after;
        if c == '=' {
            key.clone_from(&word);
        } else if c.is_alphabetic() {
            piece.clone_into(&mut word);
        }
        tokens.push(match c {
            '"' => Token::Quoted {
                key: key.clone(),
                text: piece.trim_matches('"').to_owned(),
            },
            '0'..='9' | '-' => Token::Number(piece.to_owned()),
            _ => Token::Other(piece.to_owned()),
        });
    }
    tokens
}

fn written(tokens: &[Token]) -> String {
    let mut text = String::new();
    for token in tokens {
        match token {
            Token::Quoted { text: quoted, .. } => {
                text.push('"');
                text.push_str(quoted);
                text.push('"');
            }
            Token::Number(piece) | Token::Other(piece) => text.push_str(piece),
        }
    }
    text
}

const NUMBERS: [&str; 12] = [
    "0", "1", "-1", "2", "0.5", "-3", "1e-9", "1e9", "1e-300", "1e300", "3.7", "-0.0",
];
const WRAPPINGS: [&str; 18] = [
    "-({})",
    "2*({})",
    "({})/3",
    "({}) + ({})",
    "({}) - ({})",
    "({})*sin(1)^2",
    "({})/cos(t/1 [s])",
    "({})*tan(pi/7)",
    "if(1 < 2, {}, -({}))",
    "({})*abs(sin(t/1 [s]))",
    "({})*hypot(1, 2)",
    "({})/(1 - 1)",
    "({})/(sin(t/1 [s])^2 + cos(t/1 [s])^2 - 1)",
    "0*({})",
    "({})*(1 + 1)^20",
    "({})*exp(-3)",
    "min({}, {})",
    "smooth_abs({}, {})",
];
const FACTORS: [&str; 6] = [
    "({a})*({b})",
    "({a})/({b})",
    "{a} + {b}",
    "{a} - {b}",
    "({a})^2",
    "sin({b})*({a})",
];

/// One change with a meaning.
fn mutate(spec: &mut Vec<Token>, dice: &mut Random) {
    let quoted: Vec<usize> = (0..spec.len())
        .filter(|&i| {
            matches!(&spec[i], Token::Quoted { key, .. }
                if !["about", "title", "source", "name", "unit"].contains(&key.as_str()))
        })
        .collect();
    let numbers: Vec<usize> = (0..spec.len())
        .filter(|&i| matches!(spec[i], Token::Number(_)))
        .collect();
    if quoted.is_empty() || numbers.is_empty() {
        return;
    }
    let (a, b) = (
        quoted[dice.below(quoted.len())],
        quoted[dice.below(quoted.len())],
    );
    let key_of = |token: &Token| match token {
        Token::Quoted { key, .. } => key.clone(),
        _ => String::new(),
    };
    let text_of = |token: &Token| match token {
        Token::Quoted { text, .. } => text.clone(),
        _ => String::new(),
    };
    let alike: Vec<usize> = quoted
        .iter()
        .copied()
        .filter(|&i| key_of(&spec[i]) == key_of(&spec[a]))
        .collect();
    let other = alike[dice.below(alike.len())];
    let replace = |spec: &mut Vec<Token>, at: usize, new: String| {
        if let Token::Quoted { text, .. } = &mut spec[at] {
            *text = new;
        }
    };
    match dice.below(10) {
        0 | 1 => {
            let (first, second) = (text_of(&spec[a]), text_of(&spec[other]));
            replace(spec, a, second);
            replace(spec, other, first);
        }
        2 => {
            let new = text_of(&spec[other]);
            replace(spec, a, new);
        }
        3 | 4 => {
            let old = text_of(&spec[a]);
            replace(spec, a, dice.pick(&WRAPPINGS).replace("{}", &old));
        }
        5 => {
            let (first, second) = (text_of(&spec[a]), text_of(&spec[b]));
            let new = dice.pick(&FACTORS);
            replace(spec, a, new.replace("{a}", &first).replace("{b}", &second));
        }
        6 => {
            let at = numbers[dice.below(numbers.len())];
            spec[at] = Token::Number(dice.pick(&NUMBERS).to_owned());
        }
        7 => {
            let word = match key_of(&spec[a]).as_str() {
                "about_axis" => dice.pick(&["x", "y", "z", "-x", "-z"]),
                "down" => dice.pick(&["x", "-y", "z", "-z"]),
                "in" | "parent" | "frame" => "ground",
                "from" | "centre" | "on" | "contact" => "O",
                "kind" => {
                    dice.pick(&["rolling", "velocity", "force", "torque", "spring", "damper"])
                }
                _ => dice.pick(&["0", "1", "t", "x", "m", "R", "-R"]),
            };
            replace(spec, a, word.to_owned());
        }
        8 => {
            // A line of the text, which is an item or a part of one.
            let ends: Vec<usize> = (0..spec.len())
                .filter(|&i| spec[i] == Token::Other("\n".to_owned()))
                .collect();
            let at = dice.below(ends.len().saturating_sub(1));
            if let (Some(&start), Some(&end)) = (ends.get(at), ends.get(at + 1)) {
                spec.drain(start..end);
            }
        }
        _ => {
            let text = written(spec);
            let ranges: Vec<usize> = text.match_indices(", range = [").map(|(i, _)| i).collect();
            if let Some(&start) = ranges.get(dice.below(ranges.len()))
                && let Some(end) = text[start..].find(']')
            {
                *spec = tokens(&(text[..start].to_owned() + &text[start + end + 1..]));
            }
        }
    }
}

/// How far a case came.
#[derive(Default)]
struct Counts {
    loaded: usize,
    derived: usize,
    slowest: Duration,
}

fn exercise(text: &str, kind: FunctionKind, counts: &mut Counts) -> Duration {
    let Ok(checked) = appell_spec::load("fuzz.toml", text) else {
        return Duration::ZERO;
    };
    counts.loaded += 1;
    let start = ThreadTime::now();
    match derive(&checked.mechanism) {
        Ok(derivation) => {
            counts.derived += 1;
            audit(&checked.mechanism, &derivation);
            if let Ok(program) = assemble::program(derivation, &checked.mechanism, &[kind]) {
                schedule(&program, &program.functions[0]);
                emit_functions(&program, &[kind]).unwrap();
            }
        }
        Err(findings) => {
            reasons(&checked.mechanism, &findings);
        }
    }
    start.elapsed()
}

#[test]
fn damaged_mechanisms_do_no_harm() {
    let specs: Vec<Vec<Token>> = shipped().iter().map(|(_, text)| tokens(text)).collect();
    let number =
        |name: &str| -> Option<usize> { std::env::var(name).ok().and_then(|n| n.parse().ok()) };
    let cases = number("APPELL_FUZZ_CASES").unwrap_or_else(|| budget(CASES[0], CASES[1]));
    let mut dice = Random::new(number("APPELL_FUZZ_SEED").unwrap_or(6) as u64);
    let mut counts = Counts::default();
    for case in 0..cases {
        let mut spec = specs[dice.below(specs.len())].clone();
        for _ in 0..[1, 1, 2, 3, 5][case % 5] {
            mutate(&mut spec, &mut dice);
        }
        let text = written(&spec);
        let kind = KINDS[dice.below(KINDS.len())];
        let run = catch_unwind(AssertUnwindSafe(|| exercise(&text, kind, &mut counts)));
        let took = run.unwrap_or_else(|_| panic!("case {case}, {kind:?}:\n{text}"));
        counts.slowest = counts.slowest.max(took);
        assert!(
            took < SLOWEST,
            "case {case}, {kind:?}, took {took:?}:\n{text}"
        );
    }
    let peak = peak_memory();
    eprintln!(
        "{cases} cases: {} loaded, {} derived, slowest {:?}, peak {peak:?} MB",
        counts.loaded, counts.derived, counts.slowest
    );
    assert!(
        counts.derived * 10 > cases,
        "most cases end before the derivation"
    );
    assert!(peak.is_none_or(|peak| peak < MOST_MEMORY), "{peak:?} MB");
}
