//! What is emitted is what the golden files say.
//!
//! `UPDATE_GOLDEN=1 cargo test -p appell-codegen emit_golden` writes them anew. They are
//! modules of `emit.rs`, so what is compared is what is compiled and run.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::path::Path;

use appell_codegen::emit::{Emitted, emit};

use crate::emit_support::{block, golden_options, mixture, unicycle, with_adjoints};

fn is_golden(name: &str, emitted: &Emitted) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/emit_golden");
    for (ending, text) in [("rs", &emitted.source), ("md", &emitted.docs)] {
        let file = folder.join(format!("{name}.{ending}"));
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&file, text).unwrap();
        }
        let golden = std::fs::read_to_string(&file).unwrap_or_default();
        assert!(
            golden == *text,
            "{} is not what is emitted; see the head of this test",
            file.display()
        );
    }
}

#[test]
fn the_unicycle_is_emitted_as_in_the_golden_file() {
    is_golden(
        "unicycle",
        &emit(&unicycle(), &golden_options(true)).unwrap(),
    );
}

#[test]
fn adjoints_are_emitted_as_in_the_golden_file() {
    let emitted = emit(&with_adjoints(), &golden_options(true)).unwrap();
    is_golden("with_adjoints", &emitted);
}

#[test]
fn forces_and_accelerations_are_emitted_as_in_the_golden_file() {
    let emitted = emit(&block(), &golden_options(true)).unwrap();
    is_golden("block", &emitted);
}

#[test]
fn the_mixture_is_emitted_as_in_the_golden_file() {
    is_golden(
        "mixture",
        &emit(&mixture(), &golden_options(false)).unwrap(),
    );
}
