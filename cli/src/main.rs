//! `appell`: from a mechanism spec to equations of motion, numbers and motions.

mod breaches;
mod choice;
mod commands;
mod design_report;
mod diagnosed;
mod engine;
mod failure;
mod flags;
mod motions;
mod output;
mod picture;
mod progress;
mod relations;
mod summary;

use std::process::ExitCode;

use clap::Parser as _;
use mimalloc::MiMalloc;

use commands::Arguments;

/// A derivation allocates many small objects; this allocator saves a quarter of its time.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    match commands::run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure::print(&failure);
            ExitCode::from(failure::status(&failure))
        }
    }
}
