//! The output of a build script.

use std::path::Path;

use appell_codegen::build::Build;
use appell_codegen::c;

#[test]
fn a_build_script_writes_rust_and_c() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("build_script");
    let options = c::Options::default();
    let build = Build::new()
        .spec(crates.join("../generated/mechanisms/pendulum.toml"))
        .out_dir(&folder)
        .c(options.clone());
    let generated = build.generate().expect("a valid spec");
    let [one] = generated.as_slice() else {
        panic!("one spec")
    };
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("a file");
    assert_eq!(read("pendulum.rs"), one.emitted.source);
    let c = c::emit(&one.program, &options);
    assert_eq!(
        [read("pendulum.h"), read("pendulum.c")],
        [c.header, c.source]
    );
}
