//! What a study may not say: every mistake has its place, and no study exhausts memory or leaves its folder.

use std::fmt::Write as _;

use appell::Class;
use appell::ensemble::{Ensemble, Folder, Running};

use crate::ensemble::{STUDY, Scratch, filled};

fn told(scratch: &Scratch, study: &str) -> (Class, String) {
    match Ensemble::parse("study.toml", study, &scratch.0) {
        Ok(_) => panic!("a study without mistakes:\n{study}"),
        Err(error) => (error.class(), error.to_string()),
    }
}

/// Changes of the study with the places and words of what is told; all are told that are not as they should be.
fn hold(changes: &[(&str, &str, &str, &str)]) {
    let scratch = Scratch::new("studies");
    let mut others = Vec::new();
    for (from, to, place, says) in changes {
        let wrong = STUDY.replacen(from, to, 1);
        assert_ne!(wrong, STUDY, "{from}");
        let (class, told) = told(&scratch, &wrong);
        let is_right = class == Class::Data
            && told.contains(says)
            && told.contains(&format!("study.toml:{place}"));
        if !is_right {
            others.push(format!("{to}: {place}, {says}\n{told}"));
        }
    }
    assert!(others.is_empty(), "{}", others.join("\n\n"));
}

#[test]
fn mistakes_are_told_at_their_places() {
    hold(&[
        (
            "x = { normal",
            "y = { normal",
            "9:1",
            "there is no parameter or state `y`",
        ),
        ("[0, 0.1]", "[0, \"1kg\"]", "9:20", "unit-mismatch"),
        ("end = \"x\", at", "end = \"z\", at", "13:19", "z"),
        (
            "\"abs(x) > 0.25[m]\"",
            "\"abs(x) > 0.25[s]\"",
            "16:27",
            "unit-mismatch",
        ),
        (
            "\"abs(x) > 0.25[m]\"",
            "\"abs(x)\"",
            "16:16",
            "an event is a comparison",
        ),
        ("at_s = 1.5", "at_s = 7", "13:1", "not a time of the motion"),
        ("cases = 4000", "cases = 0", "4:9", "at least 1"),
        (
            "cases = 4000",
            "casse = 4000",
            "4:1",
            "did you mean `cases`",
        ),
        (
            "normal = [0, 0.1]",
            "normal = [0, -0.1]",
            "9:20",
            "not negative",
        ),
        (
            "normal = [0, 0.1]",
            "uniform = [0.1, 0]",
            "9:18",
            "must increase",
        ),
        (
            "normal = [0, 0.1]",
            "normall = [0, 0.1]",
            "9:7",
            "did you mean `normal`",
        ),
        (
            "oscillator.toml",
            "osc.toml",
            "3:9",
            "there is no shipped mechanism and no file",
        ),
        (
            "x = { normal",
            "F = { normal",
            "9:1",
            "which is a function of time",
        ),
        (
            "reached =",
            "x =",
            "12:1",
            "two columns would have the name `x`",
        ),
    ]);
}

#[test]
fn sizes_are_bounded_where_the_study_says_them() {
    hold(&[
        (
            "4000",
            "1000000000000",
            "4:9",
            "`cases` is 1000000000000, at most 1000000000",
        ),
        (
            "4000",
            "4000\nseed = 99999999999999999999",
            "5:8",
            "more than 64 bits",
        ),
        (
            "4000",
            "1000000000\nchunk = 1",
            "5:9",
            "1000000000 chunks are too many files",
        ),
        (
            "4000",
            "1000000000\nchunk = 1000000000",
            "5:9",
            "is too large",
        ),
        ("4000", "0x3b9aca01", "4:9", "`cases` is 1000000001"),
        (
            "normal = [0, 0.1]",
            "range = [0, 1], count = 10000000000000000000",
            "9:31",
            "`count` is 10000000000000000000",
        ),
        (
            "normal = [0, 0.1]",
            "range = [0, 1], count = 1000000",
            "4:9",
            "4000000000 cases are too many",
        ),
        ("dt_s = 1", "dt_s = 1e-5", "7:8", "more than 20000 times"),
        ("dt_s = 1", "dt_s = 1e-300", "7:8", "more than 20000 times"),
        (
            "t_end_s = 4",
            "t_end_s = 1e300",
            "6:11",
            "must not be larger",
        ),
        ("t_end_s = 4", "t_end_s = 1e-310", "6:11", "lasts at least"),
        (
            "dt_s = 1",
            "max_steps = 10000000000",
            "7:13",
            "at most 1000000000",
        ),
        (
            "[keep]",
            "[noise]\nx = { deviation = 1, every_s = 1e-12 }\n[keep]",
            "12:32",
            "more than 1000000 values of noise",
        ),
        (
            "path = { course = \"x\" }",
            "[rare]\nevent = \"far\"\nparticles = 1000000000000",
            "19:13",
            "`particles` is 1000000000000",
        ),
        (
            "[keep]",
            "[rare]\nevent = \"far\"\n[noise]\nx = { deviation = 1, every_s = 1e-4 }\n[keep]",
            "12:9",
            "random numbers",
        ),
    ]);
}

#[test]
fn courses_together_are_bounded() {
    let scratch = Scratch::new("courses");
    let mut study = STUDY.replace("dt_s = 1", "dt_s = 1e-3");
    for course in 0..20 {
        let _ = writeln!(study, "c{course} = {{ course = \"x\" }}");
    }
    let (_, told) = told(&scratch, &study);
    assert!(told.contains("study.toml:7:8"), "{told}");
    assert!(
        told.contains("21 courses of 4001 times are too many columns"),
        "{told}"
    );
}

#[test]
fn distributions_correlations_and_tolerances_are_possible_ones() {
    hold(&[
        ("normal = [0, 0.1]", "lognormal = [-1, 1]", "9:20", "median"),
        (
            "normal = [0, 0.1]",
            "scatter = \"-5%\"",
            "9:17",
            "not negative",
        ),
        (
            "normal = [0, 0.1]",
            "choice = [1, 2], weights = [1e308, 1e308]",
            "9:34",
            "weights",
        ),
        (
            "normal = [0, 0.1]",
            "normal = [0, 0.1], count = 3",
            "9:34",
            "belongs to `range`",
        ),
        (
            "cases = 4000",
            "cases = 4\ncorrelations = [[\"x\", \"x\", 0.5]]",
            "5:17",
            "always correlated with itself",
        ),
        (
            "cases = 4000",
            "cases = 4\ncorrelations = [[\"x\", \"v\", 0.5], [\"v\", \"x\", 0.4]]",
            "5:34",
            "has a correlation already",
        ),
        (
            "cases = 4000",
            "cases = 4\ncorrelations = [[\"x\", \"v\", 1.5]]",
            "5:17",
            "from -1 to 1",
        ),
        (
            "dt_s = 1",
            "rtol = 0.5",
            "7:8",
            "must not be larger than 0.01",
        ),
        (
            "dt_s = 1",
            "atol = 1e300",
            "7:8",
            "must not be larger than 0.01",
        ),
        (
            "cases = 4000",
            "cases = 4000\nsampling = \"sensitivity\"\ntable = \"points.csv\"",
            "6:9",
            "points.csv",
        ),
    ]);
    let scratch = Scratch::new("contradictory");
    let study = STUDY
        .replace("cases = 4000", "cases = 4\ncorrelations = [[\"x\", \"v\", 0.9], [\"x\", \"k\", 0.9], [\"v\", \"k\", -0.9]]")
        .replace("[keep]", "k = { normal = [4, 0.1] }\n[keep]");
    let (class, told) = told(&scratch, &study);
    assert_eq!(class, Class::Data);
    assert!(
        told.contains("study.toml:5:62") && told.contains("contradict"),
        "{told}"
    );
}

#[test]
fn names_are_those_of_specs() {
    for name in ["./../../EVIL", "a/b", "a\\\\b", "..", "", "a b", "é", "1a"] {
        let study = STUDY.replacen("reached", &format!("\"{name}\""), 1);
        let scratch = Scratch::new("names");
        let (class, told) = told(&scratch, &study);
        assert_eq!(class, Class::Data);
        assert!(told.contains("study.toml:12:1"), "{name}: {told}");
        assert!(told.contains("is not a valid name"), "{name}: {told}");
    }
}

#[test]
fn all_mistakes_of_a_text_come_at_once() {
    let scratch = Scratch::new("at-once");
    let study = STUDY
        .replace("4000", "0")
        .replace("t_end_s = 4", "t_end_s = -4")
        .replace("[0, 0.1]", "[0]")
        .replace("reached", "\"a/b\"");
    let (_, told) = told(&scratch, &study);
    for place in ["4:9", "6:11", "9:16", "12:1"] {
        assert!(
            told.contains(&format!("study.toml:{place}")),
            "{place}: {told}"
        );
    }
}

#[cfg(unix)]
#[test]
fn a_study_reads_regular_files_of_its_folder_alone() {
    let scratch = Scratch::new("files");
    let inner = scratch.0.join("inner");
    std::fs::create_dir_all(&inner).unwrap();
    std::fs::write(scratch.0.join("points.csv"), "x\n1\n2\n").unwrap();
    std::fs::copy(
        scratch.0.join("oscillator.toml"),
        inner.join("oscillator.toml"),
    )
    .unwrap();
    std::os::unix::fs::symlink("/dev/zero", inner.join("zero.csv")).unwrap();
    std::os::unix::fs::symlink("../points.csv", inner.join("link.csv")).unwrap();
    let outside = scratch.0.join("points.csv");
    let absolute = outside.to_str().unwrap();
    for key in ["table", "feedback"] {
        for file in [
            "/dev/zero",
            "zero.csv",
            "../points.csv",
            "link.csv",
            ".",
            "none.csv",
            absolute,
        ] {
            let study = match key {
                "table" => STUDY.replace("cases = 4000", &format!("cases = 2\ntable = \"{file}\"")),
                _ => STUDY.replace("dt_s = 1", &format!("dt_s = 1\nfeedback = \"{file}\"")),
            };
            let error = Ensemble::parse("study.toml", &study, &inner).err().unwrap();
            assert_eq!(error.class(), Class::Data, "{key} {file}");
            let place = if key == "table" { "5:9" } else { "8:12" };
            let told = error.to_string();
            assert!(
                told.contains(&format!("study.toml:{place}")),
                "{key} {file}: {told}"
            );
        }
    }
    for model in ["/dev/zero", "../oscillator.toml", "zero.csv", "."] {
        let study = STUDY.replace("oscillator.toml", model);
        let error = Ensemble::parse("study.toml", &study, &inner).err().unwrap();
        assert!(
            error.to_string().contains("study.toml:3:9"),
            "{model}: {error}"
        );
    }
}

#[test]
fn a_million_cases_and_a_hundred_million_have_chunks() {
    let scratch = Scratch::new("many");
    for (cases, chunks) in [
        (1_000_000_u64, 245),
        (100_000_000, 24_415),
        (1_000_000_000, 100_000),
    ] {
        let study = STUDY.replace("4000", &cases.to_string());
        let ensemble = scratch.ensemble(&study);
        let all = ensemble.chunks(None).unwrap();
        assert_eq!((all.cases, all.count()), (cases, chunks));
        let last = ensemble.rows(cases - 2..cases);
        assert_eq!((last.first, last.len()), (cases - 2, 2));
        assert_eq!(
            ensemble.chunks(Some(0)).err().unwrap().class(),
            Class::Request
        );
    }
}

#[test]
fn threads_that_no_machine_has_are_refused() {
    let scratch = Scratch::new("threads");
    let ensemble = scratch.ensemble(&STUDY.replace("4000", "4"));
    let store = Folder::new(&scratch.0.join("out")).unwrap();
    for jobs in [0, 1_000_000] {
        let running = Running {
            jobs: Some(jobs),
            ..Running::default()
        };
        let watch = appell::ensemble::Watch {
            go_on: &|| true,
            done: &|_| {},
        };
        let error = ensemble.fill(&store, &[], running, watch).err().unwrap();
        assert_eq!(error.class(), Class::Request);
    }
    filled(&ensemble, &store, Running::default());
}
