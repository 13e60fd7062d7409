//! What dependencies bring along, as `deny.toml` allows: permissive licences, the registry, no
//! wildcards. `cargo deny` reads the same file; this takes no minutes to install.
//!
//! A gate (`CI=true`) looks at all platforms and features, which may have to be fetched.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::iter::Peekable;
use std::process::Command;

use appell_tests::shipped::workspace;
use serde_json::Value;

const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// What a command prints.
fn output(program: &str, arguments: &[&str]) -> String {
    let done = Command::new(program)
        .args(arguments)
        .current_dir(workspace())
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{program} {arguments:?}: {told}");
    String::from_utf8(done.stdout).unwrap()
}

/// All packages that a build takes.
fn packages() -> Vec<Value> {
    let version = output("rustc", &["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let of_a_build = ["--offline", "--filter-platform", host.unwrap()];
    let mut arguments = vec!["metadata", "--format-version=1", "--locked"];
    match std::env::var_os("CI") {
        Some(_) => arguments.push("--all-features"),
        None => arguments.extend(of_a_build),
    }
    let mut metadata: Value = serde_json::from_str(&output(env!("CARGO"), &arguments)).unwrap();
    let Value::Array(packages) = metadata["packages"].take() else {
        panic!("no packages")
    };
    assert!(packages.len() > 100, "{}", packages.len());
    packages
}

/// Whether a licence expression is met by those that are allowed; `AND` binds stronger than `OR`.
fn is_met<'a>(words: &mut Peekable<impl Iterator<Item = &'a str>>, allowed: &[String]) -> bool {
    let mut any = false;
    loop {
        let mut all = true;
        loop {
            all &= match words.next() {
                Some("(") => {
                    let inner = is_met(words, allowed);
                    assert_eq!(words.next(), Some(")"));
                    inner
                }
                licence => allowed.iter().any(|one| Some(one.as_str()) == licence),
            };
            if words.next_if_eq(&"AND").is_none() {
                break;
            }
        }
        any |= all;
        if words.next_if_eq(&"OR").is_none() {
            return any;
        }
    }
}

/// The same for its text; `/` is how it was written once.
fn permits(expression: &str, allowed: &[String]) -> bool {
    let spaced = one_word(expression)
        .replace('(', " ( ")
        .replace(')', " ) ")
        .replace('/', " OR ");
    let mut words = spaced.split_whitespace().peekable();
    let met = is_met(&mut words, allowed);
    met && words.next().is_none()
}

/// A licence with its exception.
fn one_word(licence: &str) -> String {
    licence.replace(" WITH ", "_WITH_")
}

#[test]
fn licence_expressions_are_read() {
    let allowed = ["MIT", "Zlib", "A_WITH_e"].map(str::to_owned);
    for met in [
        "MIT",
        "GPL/MIT",
        "GPL OR MIT",
        "A WITH e",
        "(GPL OR MIT) AND Zlib",
        "GPL AND MIT OR Zlib",
    ] {
        assert!(permits(met, &allowed), "{met}");
    }
    for not in ["GPL", "MIT AND GPL", "A", "(GPL OR MIT) AND GPL", ""] {
        assert!(!permits(not, &allowed), "{not}");
    }
}

#[test]
fn licences_and_sources_are_those_that_may_come_in() {
    let policy = std::fs::read_to_string(workspace().join("deny.toml")).unwrap();
    let policy: toml::Table = policy.parse().unwrap();
    let allowed = policy["licenses"]["allow"].as_array().unwrap().iter();
    let allowed: Vec<String> = allowed.map(|l| one_word(l.as_str().unwrap())).collect();
    for package in packages() {
        let name = &package["name"];
        let licence = package["license"].as_str().unwrap_or_default();
        assert!(permits(licence, &allowed), "{name}: {licence:?}");
        if let Some(source) = package["source"].as_str() {
            assert_eq!(source, REGISTRY, "{name}");
            continue;
        }
        // A package of ours, or one that somebody copied here.
        for dependency in package["dependencies"].as_array().unwrap() {
            let any = dependency["req"] == "*" && dependency["path"].is_null();
            assert!(!any, "{name}: any version of {}", dependency["name"]);
        }
    }
}
