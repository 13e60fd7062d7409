//! Rules of the house that a compiler does not know.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::path::{Path, PathBuf};

use appell_tests::{modules::Modules, shipped};

/// Longer files hold more than one idea.
const MOST_LINES: usize = 700;

/// Which crates a crate may depend on; [`ARCHITECTURE.md`] tells why.
const MAY_KNOW: &[(&str, &[&str])] = &[
    ("model_spec", &[]),
    ("model_spec/files", &[]),
    ("runtime", &[]),
    ("codegen", &["appell-spec", "appell-runtime"]),
    ("codegen/vector", &["appell-codegen", "appell-runtime"]),
    ("codegen/card", &[]),
    ("generated", &["appell-runtime", "appell-codegen"]),
    ("analysis/spectra", &[]),
    ("analysis/stability", &["appell-runtime", "appell-spectra"]),
    ("gap/estimate", &["appell-runtime", "appell-spectra"]),
    (
        "gap/recordings",
        &[
            "appell-files",
            "appell-spec",
            "appell-runtime",
            "appell-estimate",
            "appell-robots",
        ],
    ),
    (
        "gap/diagnosis",
        &[
            "appell-spec",
            "appell-codegen",
            "appell-runtime",
            "appell-spectra",
            "appell-estimate",
            "appell-recordings",
        ],
    ),
    ("robots", &["appell-spec"]),
    (
        "analysis/ensemble",
        &["appell-files", "appell-spec", "appell-recordings"],
    ),
    (
        "report",
        &[
            "appell-ensemble",
            "appell-spec",
            "appell-codegen",
            "appell-runtime",
            "appell-analysis",
            "appell-estimate",
            "appell-recordings",
            "appell-gap",
        ],
    ),
    (
        "appell",
        &[
            "appell-files",
            "appell-ensemble",
            "appell-spec",
            "appell-card",
            "appell-codegen",
            "appell-models",
            "appell-runtime",
            "appell-analysis",
            "appell-estimate",
            "appell-recordings",
            "appell-gap",
            "appell-report",
            "appell-robots",
            "appell-vector",
        ],
    ),
    ("apps/lsp", &["appell-spec", "appell-codegen"]),
    (
        "apps/watch",
        &[
            "appell",
            "appell-spec",
            "appell-codegen",
            "appell-report",
            "appell-runtime",
        ],
    ),
    (
        "apps/python",
        &["appell", "appell-report", "appell-runtime"],
    ),
    (
        "papers",
        &[
            "appell",
            "appell-spec",
            "appell-codegen",
            "appell-models",
            "appell-runtime",
            "appell-spectra",
            "appell-analysis",
            "appell-estimate",
            "appell-recordings",
            "appell-gap",
            "appell-report",
        ],
    ),
    (
        "apps/cli",
        &[
            "appell",
            "appell-lsp",
            "appell-watch",
            "appell-papers",
            "appell-spec",
            "appell-codegen",
            "appell-models",
            "appell-runtime",
            "appell-spectra",
            "appell-analysis",
            "appell-estimate",
            "appell-recordings",
            "appell-gap",
            "appell-report",
        ],
    ),
];

/// Crates below the command line: they name no mechanism and no flag.
const NAME_NO_MECHANISM: [&str; 18] = [
    "model_spec/files",
    "model_spec",
    "codegen",
    "codegen/vector",
    "codegen/card",
    "runtime",
    "analysis/spectra",
    "analysis/stability",
    "gap/estimate",
    "gap/recordings",
    "gap/diagnosis",
    "robots",
    "analysis/ensemble",
    "report",
    "appell",
    "apps/lsp",
    "apps/watch",
    "apps/python",
];

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The folders of the crates.
fn members() -> Vec<String> {
    let workspace: toml::Table = read(&shipped::workspace().join("Cargo.toml"))
        .parse()
        .unwrap();
    let members = workspace["workspace"]["members"].as_array().unwrap().iter();
    members
        .map(|member| member.as_str().unwrap().to_owned())
        .collect()
}

/// All files below folders, without hidden ones and build products.
fn files(folders: &[impl AsRef<str>], extension: &str) -> Vec<PathBuf> {
    let mut open: Vec<PathBuf> = folders
        .iter()
        .map(|folder| shipped::workspace().join(folder.as_ref()))
        .collect();
    let mut found = Vec::new();
    while let Some(path) = open.pop() {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if name.starts_with('.') || name == "target" {
            continue;
        }
        if path.is_dir() {
            open.extend(
                std::fs::read_dir(&path)
                    .unwrap()
                    .map(|entry| entry.unwrap().path()),
            );
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    assert!(!found.is_empty(), "no {extension} file");
    found.sort();
    found
}

#[test]
fn crates_know_only_whom_they_may_know() {
    for (folder, allowed) in MAY_KNOW {
        let manifest: toml::Table = read(&shipped::workspace().join(folder).join("Cargo.toml"))
            .parse()
            .unwrap();
        for section in ["dependencies", "build-dependencies"] {
            let Some(dependencies) = manifest.get(section).and_then(toml::Value::as_table) else {
                continue;
            };
            for name in dependencies
                .keys()
                .filter(|name| name.starts_with("appell"))
            {
                assert!(
                    allowed.contains(&name.as_str()),
                    "{folder} must not know {name}"
                );
            }
        }
    }
    let generated: toml::Table = read(&shipped::workspace().join("generated/Cargo.toml"))
        .parse()
        .unwrap();
    let dependencies = generated["dependencies"].as_table().unwrap();
    assert!(
        !dependencies.contains_key("appell-codegen"),
        "codegen is there to build, not to run"
    );
}

/// The source without its tests: test modules stand at the end of a file.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]").next().unwrap()
}

#[test]
fn no_source_of_the_tool_names_a_shipped_mechanism() {
    let sources: Vec<String> = NAME_NO_MECHANISM
        .map(|folder| format!("{folder}/src"))
        .into();
    for file in files(&sources, "rs") {
        let text = read(&file);
        for line in without_tests(&text)
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
        {
            for name in shipped::names() {
                let words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
                assert!(
                    words.clone().all(|word| word != name),
                    "{}: `{name}` in `{line}`",
                    file.display()
                );
            }
        }
    }
}

/// Files that write commands to be repeated.
const MAY_WRITE_COMMANDS: [&str; 1] = ["appell/src/control/law_file.rs"];

/// Whether a line contains a flag, which is not the arrow of a diagram such as `--table-->`.
fn has_flag(line: &str) -> bool {
    line.match_indices("--").any(|(at, _)| {
        let (before, flag) = (&line[..at], &line[at + 2..]);
        let begins = !before.ends_with(|c: char| c.is_alphanumeric() || c == '-');
        begins && flag.starts_with(|c: char| c.is_ascii_lowercase()) && !flag.contains("->")
    })
}

#[test]
fn no_text_of_the_library_names_a_flag() {
    let sources = NAME_NO_MECHANISM.map(|folder| format!("{folder}/src"));
    for file in files(&sources, "rs") {
        if MAY_WRITE_COMMANDS.iter().any(|own| file.ends_with(own)) {
            continue;
        }
        let text = read(&file);
        let lines = without_tests(&text).lines().map(str::trim_start);
        // A command that runs the tests of a crate is not one of the tool.
        let named = lines.filter(|line| has_flag(line) && !line.starts_with("//! cargo "));
        let named: Vec<&str> = named.collect();
        assert!(named.is_empty(), "{}: {named:?}", file.display());
    }
}

#[test]
fn no_file_is_longer_than_700_lines() {
    for file in files(&members(), "rs") {
        // Golden files are written by the tool.
        if file
            .components()
            .any(|part| part.as_os_str().to_string_lossy().contains("golden"))
        {
            continue;
        }
        let lines = read(&file).lines().count();
        assert!(lines <= MOST_LINES, "{} has {lines} lines", file.display());
    }
}

/// A file that `main.rs` does not name is never compiled, and nobody misses it.
#[test]
fn every_file_of_tests_is_run() {
    let folders = [
        "model_spec",
        "codegen",
        "codegen/vector",
        "gap/recordings",
        "gap/diagnosis",
        "appell",
        "apps/lsp",
        "apps/watch",
        "apps/cli",
        "tests",
    ];
    for main in files(&folders, "rs") {
        if !main.ends_with("tests/main.rs") {
            continue;
        }
        let named = read(&main);
        let folder = main.parent().unwrap();
        let entries = std::fs::read_dir(folder).unwrap();
        for path in entries.map(|entry| entry.unwrap().path()) {
            let module = path.file_stem().unwrap().to_string_lossy();
            let is_module = path.extension().is_some_and(|end| end == "rs") && module != "main";
            assert!(
                !is_module || named.contains(&format!("mod {module};\n")),
                "{} does not name `{module}`",
                main.display()
            );
        }
        let snapshots = std::fs::read_dir(folder.join("snapshots"));
        for path in snapshots.into_iter().flatten() {
            let name = path.unwrap().file_name().to_string_lossy().into_owned();
            let Some(rest) = name.strip_prefix("integration__") else {
                continue;
            };
            let module = rest.split("__").next().unwrap();
            let of_a_module = named.contains(&format!("mod {module};\n"));
            assert!(of_a_module, "{}: no test writes {name}", main.display());
        }
    }
}

#[test]
fn every_public_item_is_documented() {
    let workspace: toml::Table = read(&shipped::workspace().join("Cargo.toml"))
        .parse()
        .unwrap();
    assert_eq!(
        workspace["workspace"]["lints"]["rust"]["missing_docs"].as_str(),
        Some("warn")
    );
    for member in members() {
        let folder = shipped::workspace().join(member);
        let manifest: toml::Table = read(&folder.join("Cargo.toml")).parse().unwrap();
        let inherits = manifest
            .get("lints")
            .and_then(|l| l.get("workspace"))
            .and_then(toml::Value::as_bool);
        assert_eq!(
            inherits,
            Some(true),
            "{} does not inherit the lints",
            folder.display()
        );
    }
}

#[test]
fn nothing_is_left_to_do_and_no_test_is_ignored() {
    let forbidden = [
        ["TO", "DO"].concat(),
        ["FIX", "ME"].concat(),
        ["#[ig", "nore"].concat(),
        ["to", "do!("].concat(),
    ];
    for file in files(&members(), "rs") {
        let text = read(&file);
        for word in &forbidden {
            assert!(
                !text.contains(word.as_str()),
                "{}: `{word}`",
                file.display()
            );
        }
    }
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let root = shipped::workspace();
    let mut documents = files(&["docs"], "md");
    documents.extend(
        [
            "README.md",
            "ARCHITECTURE.md",
            "CONTRIBUTING.md",
            "CHANGELOG.md",
        ]
        .map(|name| root.join(name))
        .into_iter()
        .filter(|path| path.exists()),
    );
    for document in documents {
        let text = read(&document);
        // Code is not prose: what looks like a link there is an index.
        let prose: String = text.split("```").step_by(2).collect();
        let prose: String = prose.split('`').step_by(2).collect();
        for target in prose
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let target = target.split_whitespace().next().unwrap_or_default();
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if path.is_empty() {
                document.clone()
            } else {
                document.parent().unwrap().join(path)
            };
            assert!(
                file.exists(),
                "{}: `{target}` leads nowhere",
                document.display()
            );
            if !anchor.is_empty() && file.extension().is_some_and(|e| e == "md") {
                let headings: Vec<String> = read(&file)
                    .lines()
                    .filter(|line| line.starts_with('#'))
                    .map(anchor_of)
                    .collect();
                assert!(
                    headings.contains(&anchor.to_owned()),
                    "{}: no heading `{target}`",
                    document.display()
                );
            }
        }
    }
}

/// The anchor that hosts of repositories give a heading.
fn anchor_of(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    words
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-' || *c == '_')
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

#[test]
fn every_shipped_mechanism_stands_in_the_gallery() {
    let gallery = read(&shipped::workspace().join("docs/gallery.md"));
    let shown = |name: &String| gallery.contains(&format!("\n| `{name}` |"));
    let missing: Vec<String> = shipped::names().into_iter().filter(|n| !shown(n)).collect();
    assert!(missing.is_empty(), "docs/gallery.md lacks {missing:?}");
}

/// Folders and files of the source of `codegen` with those that they may use. What is derived knows
/// nothing of what is done with it: `symbolic` no mechanics, `mechanics` no schedule, `schedule` no
/// derivation.
const LAYERS_OF_CODEGEN: &[(&str, &[&str])] = &[
    ("symbolic", &[]),
    ("program", &["symbolic"]),
    ("mechanics", &["program", "symbolic"]),
    ("linearisation", &["mechanics", "symbolic"]),
    ("audit", &["mechanics", "symbolic"]),
    ("formulations", &["mechanics", "symbolic"]),
    ("tape", &["symbolic"]),
    ("schedule", &["program", "symbolic", "tape"]),
    ("text", &["program", "schedule", "symbolic", "tape"]),
    ("emit", &["program", "schedule", "symbolic", "tape", "text"]),
    (
        "tapes",
        &["compile", "mechanics", "program", "schedule", "tape"],
    ),
    ("model", &["program", "tape", "tapes"]),
    ("jit", &["model", "program", "symbolic", "tape", "tapes"]),
    ("interpreted", &["model", "program", "tape", "tapes"]),
];

/// What the three formulations share with the derivation: the graph, the reading of expressions,
/// derivatives along a motion and the question of rank. What they write, they write themselves.
const SHARED_BY_FORMULATIONS: &[&str] = &[
    "algebra",
    "expressions",
    "finding",
    "rank",
    "symbols",
    "time",
];

/// Crates that only the emission of Rust needs.
const RUST_WRITERS: &[&str] = &["prettyplease", "proc_macro2", "quote", "syn"];

/// The sources of all crates, each with its root file.
fn sources() -> Vec<(String, PathBuf)> {
    let members = members();
    let roots = members.iter().flat_map(|folder| {
        let source = shipped::workspace().join(folder).join("src");
        let roots = ["lib.rs", "main.rs"].map(|name| (folder.clone(), source.join(name)));
        roots.into_iter().filter(|(_, root)| root.exists())
    });
    roots.collect()
}

fn codegen() -> Modules {
    Modules::read(&shipped::workspace().join("codegen/src/lib.rs"))
}

#[test]
fn no_more_than_two_files_use_each_other() {
    let mut told = Vec::new();
    for (folder, root) in sources() {
        let cycles = Modules::read(&root).cycles().into_iter();
        told.extend(cycles.map(|cycle| format!("{folder}: {cycle}")));
    }
    assert!(told.is_empty(), "{}", told.join("\n\n"));
}

#[test]
fn modules_of_codegen_know_only_whom_they_may_know() {
    let codegen = codegen();
    for (folder, allowed) in LAYERS_OF_CODEGEN {
        for known in codegen.neighbours(folder) {
            let how = codegen.knows(folder, known).join("\n  ");
            assert!(
                allowed.contains(&known),
                "codegen/src/{folder} must not know {known}:\n  {how}"
            );
        }
    }
}

#[test]
fn formulations_share_nothing_that_could_hide_a_mistake() {
    let codegen = codegen();
    for formulation in ["inertial", "kane", "lagrange", "loads"] {
        for edge in codegen.knows(&format!("formulations/{formulation}"), "mechanics") {
            let shared = SHARED_BY_FORMULATIONS.iter();
            let mut shared = shared.map(|file| format!("mechanics/{file}.rs"));
            assert!(shared.any(|file| edge.ends_with(&file)), "{edge}");
        }
    }
}

#[test]
fn only_emit_writes_rust_and_only_jit_writes_machine_code() {
    let codegen = codegen();
    let cranelift = ["codegen", "frontend", "jit", "module", "native"];
    let cranelift = cranelift.map(|part| format!("cranelift_{part}"));
    let cranelift: Vec<&str> = cranelift.iter().map(String::as_str).collect();
    for (folder, crates) in [("emit", RUST_WRITERS), ("jit", &cranelift)] {
        for user in codegen.users_of(crates) {
            assert!(
                user.starts_with(folder),
                "codegen/src/{user} must not use {crates:?}"
            );
        }
    }
}

/// Where machine code is written to memory and called, or calls routines.
const CALL_MACHINE_CODE: [&str; 6] = [
    "codegen/src/jit",
    "codegen/card/src",
    "codegen/vector/src/function.rs",
    "codegen/vector/src/machine.rs",
    "codegen/vector/src/routines.rs",
    "codegen/vector/tests/emulator.rs",
];

#[test]
fn unsafe_code_is_where_machine_code_is_called() {
    let allowed = ["allow(", "expect("].map(|level| format!("{level}unsafe_code"));
    for file in files(&members(), "rs") {
        let text = read(&file);
        let found = allowed.iter().any(|word| text.contains(word.as_str()));
        let path = file.to_string_lossy();
        let calls_code = CALL_MACHINE_CODE.iter().any(|part| path.contains(part));
        assert!(
            !found || calls_code,
            "{} allows unsafe code",
            file.display()
        );
    }
}
