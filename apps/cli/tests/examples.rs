//! The examples that `--help` shows, run as they stand in one folder, by a shell.

use crate::documents::shell;
use crate::support::Folder;

/// Commands that others of the list need, in the order of their needs; then the rest.
const FIRST: &[&str] = &["new", "sample", "import", "motion", "diagnose"];
/// Commands that never end, write to the home folder, or are run by tests of their own.
const ELSEWHERE: &[&str] = &["watch", "lsp", "completions", "reproduce", "help"];

fn help(folder: &Folder, command: &[&str]) -> String {
    folder.done(&[command, &["--help"]].concat()).stdout
}

/// All commands.
fn commands(folder: &Folder) -> Vec<String> {
    let help = help(folder, &[]);
    let (_, list) = help.split_once("Commands:\n").expect("a list of commands");
    let list = list.split("\n\n").next().unwrap_or_default();
    let names = list
        .lines()
        .filter_map(|line| line.split_whitespace().next());
    names.map(str::to_owned).collect()
}

/// The lines of examples of a command.
fn examples(folder: &Folder, command: &str) -> Vec<String> {
    let help = help(folder, &[command]);
    let (_, examples) = (help.split_once("Examples:\n"))
        .unwrap_or_else(|| panic!("`{command} --help` has no example"));
    let lines = examples.lines().map(|line| line.trim().to_owned());
    lines.collect()
}

#[test]
fn the_examples_of_every_command_run_as_they_stand() {
    let folder = Folder::new();
    let mut all = commands(&folder);
    assert!(all.len() > 20, "{all:?}");
    let rank = |name: &String| {
        FIRST
            .iter()
            .position(|first| first == name)
            .unwrap_or(FIRST.len())
    };
    all.sort_by_key(rank);
    for command in all.iter().filter(|name| *name != "help") {
        let lines = examples(&folder, command);
        assert!(
            lines
                .iter()
                .any(|line| line.contains(&format!("appell {command}"))),
            "{lines:?}"
        );
        if ELSEWHERE.contains(&command.as_str()) {
            continue;
        }
        for line in lines
            .iter()
            .filter(|line| !line.contains('~') && !line.contains("man -l"))
        {
            shell(&folder, line);
        }
    }
}
