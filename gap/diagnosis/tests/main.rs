//! Diagnoses, from the outside.

#[expect(dead_code, reason = "the tests of recordings use all of it")]
#[path = "../../recordings/tests/common/mod.rs"]
mod common;

mod again;
mod base;
mod by_forces;
mod decay;
mod differences;
mod engine;
mod events;
mod fuzz;
mod materiality;
mod shared;
mod signs;
