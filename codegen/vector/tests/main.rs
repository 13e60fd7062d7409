//! Integration tests of vector code.

mod emulator;
mod jit_support;

// The tapes of the tests of scalar code, in lanes.
#[path = "../../tests/jit.rs"]
mod jit;
#[path = "../../tests/jit_random.rs"]
mod jit_random;
mod shipped;
mod vector;
