//! The example runs.

#[test]
fn the_example_runs() {
    let program = env!("CARGO_BIN_EXE_own-mechanism");
    let status = std::process::Command::new(program)
        .status()
        .unwrap_or_else(|e| panic!("{program}: {e}"));
    assert!(status.success(), "{program}: {status}");
}
