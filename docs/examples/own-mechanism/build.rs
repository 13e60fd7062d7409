//! Turns the spec into a Rust module; a mistake in it fails the build, with its line and column.

fn main() {
    appell_codegen::build("mechanisms/furuta.toml");
}
