//! The example for a microcontroller takes the memory that its document tells.

use std::process::Command;

use crate::documents::shell;
use crate::support::{Folder, repository};

/// What the script prints, in the order of the document.
const LINES: [&str; 5] = ["program", "data", "rates", "step", "stack"];
/// Another version of the compiler may differ so far.
const TOLERANCE: f64 = 0.1;

#[test]
fn the_loop_takes_the_memory_that_the_document_tells() {
    let compiler = Command::new("arm-none-eabi-gcc").arg("--version").output();
    if compiler.is_err() {
        println!("not built: there is no arm-none-eabi-gcc on the path");
        return;
    }
    let folder = Folder::new();
    let script = repository("docs/examples/cortex-m/build.sh");
    shell(&folder, &format!("sh '{script}' > told"));
    let document = std::fs::read_to_string(repository("docs/examples/cortex-m/README.md"));
    let document = document.expect("the document");
    let cells = document.lines().filter_map(|line| line.split('|').nth(2));
    let told: Vec<f64> = cells.filter_map(|cell| cell.trim().parse().ok()).collect();
    let found = folder.read("told");
    let found: Vec<(&str, f64)> = found
        .lines()
        .filter_map(|line| line.split_once(' '))
        .map(|(name, bytes)| (name, bytes.parse().expect("a number")))
        .collect();
    assert_eq!(told.len(), LINES.len(), "{document}");
    for (name, told) in LINES.iter().zip(told) {
        let (_, bytes) = (found.iter().find(|(found, _)| found == name))
            .unwrap_or_else(|| panic!("{name} is missing in {found:?}"));
        let off = (bytes - told).abs();
        assert!(off <= TOLERANCE * told, "{name}: {bytes} bytes, not {told}");
    }
}
