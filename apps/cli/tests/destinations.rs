//! Results go to places of their own, in the format that the name of the file promises.

use crate::support::Folder;

const SHORT: [&str; 4] = ["simulate", "pendulum", "--t-end-s", "0.1"];

fn simulate<'a>(flags: &[&'a str]) -> Vec<&'a str> {
    [&SHORT[..], flags].concat()
}

#[test]
fn two_results_never_share_a_stream_or_a_file() {
    let folder = Folder::new();
    let mixed = simulate(&["--json", "-", "--csv", "-"]);
    folder.fails(2, &mixed, &["would mix on standard output"]);
    let same = simulate(&["--csv", "motion", "--json", "motion"]);
    folder.fails(2, &same, &["both name `motion`"]);
    assert!(folder.files().is_empty());
}

#[test]
fn a_file_holds_what_its_name_says() {
    let folder = Folder::new();
    let json = simulate(&["--json", "motion.csv"]);
    folder.fails(2, &json, &["--json motion.json"]);
    let html = simulate(&["--html", "motion.svg"]);
    folder.fails(2, &html, &["--html motion.html"]);
    let derive = ["derive", "pendulum", "-o", "page.pdf"];
    folder.fails(2, &derive, &["as `.pdf`", ".tex (LaTeX)"]);
    let other = ["derive", "pendulum", "--format", "latex", "-o", "page.html"];
    folder.fails(2, &other, &["as `.html`"]);
    assert!(folder.files().is_empty());
    for (file, begins) in [
        ("page.html", "<!DOCTYPE html>"),
        ("page.tex", "\\documentclass"),
        ("page.rs", "//"),
    ] {
        folder.done(&["derive", "pendulum", "-o", file]);
        let text = folder.read(file);
        assert!(text.starts_with(begins), "{file}: {}", &text[..60]);
    }
    folder.done(&["derive", "pendulum", "--format", "latex", "-o", "page.mine"]);
    assert_eq!(folder.read("page.mine"), folder.read("page.tex"));
}

#[test]
fn every_json_names_its_schema() {
    let folder = Folder::new();
    folder.write(
        "cases.json",
        r#"{"cases": [{"state": {"omega": 0, "theta": 0.1}}]}"#,
    );
    let commands: &[(&str, &[&str])] = &[
        ("list/1", &["list"]),
        ("check/1", &["check", "pendulum"]),
        (
            "evaluation/1",
            &["evaluate", "pendulum", "--cases", "cases.json"],
        ),
        ("simulated/1", &SHORT),
        ("steady/1", &["steady", "pendulum", "--fix", "theta=0"]),
        ("steady/1", &["stability", "pendulum", "--fix", "theta=0"]),
        (
            "stability-chart/1",
            &[
                "stability",
                "rolling_wheel",
                "--chart",
                "theta=-1..1,psi_dot=1..3",
                "--grid",
                "4x4",
            ],
        ),
        ("control/1", &["control", "cart_pole", "--poles", "-4"]),
        (
            "control-schedule/1",
            &[
                "control",
                "cart_pole",
                "--poles",
                "-4",
                "--schedule",
                "l=0.4..0.6/1",
            ],
        ),
    ];
    for (schema, command) in commands {
        folder.done(&[command, &["--json", "out.json"][..]].concat());
        assert_eq!(folder.json("out.json")["schema"], *schema, "{command:?}");
    }
}

#[test]
fn a_shell_completes_models_and_specs() {
    let folder = Folder::new();
    folder.write("unfinished.toml", "");
    folder.write("unrelated.csv", "");
    let completed = |words: &[&str]| {
        let index = (words.len() - 1).to_string();
        let told = std::process::Command::new(env!("CARGO_BIN_EXE_appell"))
            .arg("--")
            .args(words)
            .current_dir(folder.path("."))
            .envs([
                ("COMPLETE", "bash"),
                ("_CLAP_COMPLETE_INDEX", index.as_str()),
                ("_CLAP_IFS", "\n"),
            ])
            .output()
            .expect("the program runs");
        let told = String::from_utf8_lossy(&told.stdout).into_owned();
        told.lines().map(str::to_owned).collect::<Vec<String>>()
    };
    let all = completed(&["appell", "check", "un"]);
    let has = |name: &str| all.iter().any(|one| one == name);
    assert!(has("unicycle") && has("unfinished.toml"), "{all:?}");
    assert!(all.iter().all(|name| name.starts_with("un")), "{all:?}");
    assert!(!has("unrelated.csv"), "{all:?}");
    let import = ["appell", "import", "arm.urdf", "--without"];
    let without = |typed: &str| completed(&[&import[..], &[typed]].concat());
    assert_eq!(without("da"), ["damping"]);
    assert_eq!(without("damping,sp"), ["damping,springs"]);
    assert_eq!(
        completed(&["appell", "effects", "coul"]),
        ["coulomb_friction"]
    );
    let script = folder.done(&["completions", "bash"]).stdout;
    assert!(script.contains("COMPLETE=\"bash\""), "{script}");
}

#[test]
fn every_command_has_a_manual_page_with_its_examples() {
    let folder = Folder::new();
    folder.done(&["man", "pages"]);
    let page = folder.read("pages/appell-simulate.1");
    assert!(
        page.contains("Examples:") && page.contains(".SH OPTIONS"),
        "{page}"
    );
}
