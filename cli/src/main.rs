//! The appell command.
fn main() {}
