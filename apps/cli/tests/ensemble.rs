//! Ensembles on the command line: what is killed goes on, and ends as if nothing had happened.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::documents::blocks;
use crate::support::{Folder, repository};

const STUDY: &str = r#"
[study]
model = "pendulum"
cases = 3000
chunk = 50
[motion]
t_end_s = 20
[vary]
theta = { uniform = ["-2rad", "2rad"] }
l = { scatter = "5%" }
[keep]
reached = { end = "theta" }
fast = { max = "abs(omega)" }
path = { course = "theta" }
"#;

/// Names and bytes of the chunks in a folder.
fn chunks(folder: &Folder, name: &str) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder.path(name)).into_iter().flatten();
    let mut chunks: Vec<(String, Vec<u8>)> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|end| end == "parquet"))
        .map(|path| {
            let name = path.file_name().expect("a name").to_string_lossy();
            (name.into_owned(), std::fs::read(&path).expect("a chunk"))
        })
        .collect();
    chunks.sort();
    chunks
}

#[test]
fn a_killed_run_goes_on_and_ends_as_if_nothing_had_happened() {
    let folder = Folder::new();
    folder.write("study.toml", STUDY);
    folder.done(&["ensemble", "study.toml", "-o", "whole"]);
    let whole = chunks(&folder, "whole");
    assert_eq!(whole.len(), 60);
    // `kill` of a child is SIGKILL: nothing is tidied up.
    let mut child = Command::new(env!("CARGO_BIN_EXE_appell"))
        .args(["ensemble", "study.toml", "-o", "killed", "--jobs", "2"])
        .current_dir(folder.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    let mut waited = 0;
    while chunks(&folder, "killed").len() < 5 && waited < 6000 {
        std::thread::sleep(Duration::from_millis(10));
        waited += 1;
    }
    child.kill().expect("it still runs");
    child.wait().expect("it ends");
    let survived = chunks(&folder, "killed");
    assert!((5..60).contains(&survived.len()), "{}", survived.len());
    assert!(
        survived.iter().all(|chunk| whole.contains(chunk)),
        "half a chunk"
    );
    let again = folder.done(&["ensemble", "study.toml", "-o", "killed"]);
    assert!(
        again.stderr.contains("cases are there already"),
        "{}",
        again.stderr
    );
    assert_eq!(chunks(&folder, "killed"), whole);
    let file = |name: &str| folder.read(&format!("{name}/statistics.json"));
    assert_eq!(file("killed"), file("whole"));
    let left = std::fs::read_dir(folder.path("killed")).expect("the folder");
    let left = left.filter(|entry| {
        let name = entry.as_ref().expect("an entry").file_name();
        name.to_string_lossy().ends_with(".draft")
    });
    assert_eq!(left.count(), 0);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_what_is_finished_and_says_so() {
    let folder = Folder::new();
    folder.write("study.toml", STUDY);
    let child = Command::new(env!("CARGO_BIN_EXE_appell"))
        .args(["ensemble", "study.toml", "-o", "out", "--jobs", "1"])
        .current_dir(folder.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    let mut waited = 0;
    while chunks(&folder, "out").len() < 2 && waited < 6000 {
        std::thread::sleep(Duration::from_millis(10));
        waited += 1;
    }
    let interrupt = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupt.expect("kill").success());
    let ended = child.wait_with_output().expect("it ends");
    let told = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(4), "{told}");
    assert!(
        told.contains("chunks are there, and the same command goes on"),
        "{told}"
    );
    assert!((2..60).contains(&chunks(&folder, "out").len()));
}

#[test]
fn shards_make_what_one_run_makes() {
    let folder = Folder::new();
    folder.write("study.toml", &STUDY.replace("3000", "200"));
    folder.done(&["ensemble", "study.toml", "-o", "whole"]);
    for shard in ["1/3", "2/3"] {
        let told = folder.done(&["ensemble", "study.toml", "-o", "parts", "--shard", shard]);
        assert!(told.stdout.contains("other shards"), "{}", told.stdout);
    }
    let last = folder.done(&["ensemble", "study.toml", "-o", "parts", "--shard", "3/3"]);
    assert!(last.stdout.contains("200 cases"), "{}", last.stdout);
    assert_eq!(chunks(&folder, "parts"), chunks(&folder, "whole"));
    let file = |name: &str| folder.read(&format!("{name}/statistics.json"));
    assert_eq!(file("parts"), file("whole"));
    folder.fails(
        2,
        &["ensemble", "study.toml", "-o", "parts", "--shard", "4/3"],
        &["K/N"],
    );
}

#[test]
fn the_study_of_the_documents_runs_and_has_its_figures() {
    let folder = Folder::new();
    folder.done(&["sample", "study", "."]);
    let text = std::fs::read_to_string(repository("docs/ensembles.md")).expect("the document");
    let shown = blocks(&text, "toml")[0];
    assert!(
        folder.read("rider.toml").ends_with(shown),
        "the document shows another study"
    );
    let told = folder.done(&["ensemble", "rider.toml", "-o", "out", "--json", "-"]);
    assert!(
        told.stderr.contains("Riders who slow down"),
        "{}",
        told.stderr
    );
    let summary: serde_json::Value = serde_json::from_str(&told.stdout).expect("JSON");
    assert_eq!(summary["done"], 400);
    assert_eq!(summary["schema"], "ensemble/1");
    for name in [
        "lean-bands",
        "torque-histogram",
        "torque-levers",
        "strained-cases",
    ] {
        let svg = folder.read(&format!("out/{name}.svg"));
        assert!(svg.starts_with("<svg"), "{name}");
    }
    let page = folder.read("out/report.html");
    assert!(page.contains("stiffness of the ankles"));
}

#[test]
fn mistakes_have_their_place_and_status() {
    let folder = Folder::new();
    folder.write("study.toml", &STUDY.replace("theta = {", "thet = {"));
    folder.fails(
        3,
        &["ensemble", "study.toml", "-o", "out"],
        &["study.toml:9:1", "did you mean `theta`?"],
    );
    folder.fails(
        3,
        &["ensemble", "nothing.toml", "-o", "out"],
        &["nothing.toml"],
    );
}

#[test]
fn rows_go_to_an_object_store_as_to_a_folder() {
    let folder = Folder::new();
    folder.write("study.toml", &STUDY.replace("3000", "120"));
    let place = folder.path("objects");
    std::fs::create_dir(&place).expect("a folder");
    let address = format!("file://{}", place.display());
    if cfg!(feature = "object-store") {
        folder.done(&["ensemble", "study.toml", "-o", &address]);
        folder.done(&["ensemble", "study.toml", "-o", "beside"]);
        assert_eq!(chunks(&folder, "objects"), chunks(&folder, "beside"));
        for name in ["statistics.json", "reached-histogram.svg"] {
            let [there, here] = ["objects", "beside"].map(|f| folder.read(&format!("{f}/{name}")));
            assert_eq!(there, here, "{name}");
        }
    } else {
        let refused = folder.run(&["ensemble", "study.toml", "-o", &address]);
        assert!(
            refused.stderr.contains("--features object-store"),
            "{}",
            refused.stderr
        );
    }
}

#[test]
fn a_quantity_that_no_case_has_is_told_as_missing() {
    let folder = Folder::new();
    let study = STUDY
        .replace("cases = 3000", "cases = 20")
        .replace("chunk = 50\n", "");
    folder.write(
        "study.toml",
        &format!("{study}never = {{ max = \"sqrt(-1 - theta*theta)\" }}\n"),
    );
    let told = folder
        .done(&["ensemble", "study.toml", "-o", "rows"])
        .stdout;
    let row = told.lines().find(|line| line.contains("never"));
    assert!(row.is_some_and(|row| row.ends_with("20")), "{told}");
}

#[cfg(feature = "cuda")]
#[test]
fn without_a_graphics_card_the_device_is_refused() {
    let folder = Folder::new();
    folder.write("study.toml", STUDY);
    // Where the loader finds no driver.
    let output = Command::new(env!("CARGO_BIN_EXE_appell"))
        .args(["ensemble", "study.toml", "-o", "rows", "--device", "cuda"])
        .env("LD_LIBRARY_PATH", "")
        .current_dir(folder.path("."))
        .output()
        .expect("the program runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    assert!(said.contains("--device") && said.contains("card"), "{said}");
    assert!(chunks(&folder, "rows").is_empty());
}
