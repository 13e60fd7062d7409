//! `appell`: from a mechanism spec to equations of motion, numbers and motions.

mod applied;
mod breaches;
mod commands;
mod design_report;
mod diagnosed;
mod engine;
mod failure;
mod film;
mod identified;
mod motions;
mod output;
mod picture;
mod progress;
mod recording;
mod relations;
mod summary;
mod thorough;

use std::process::ExitCode;

use clap::Parser;
use mimalloc::MiMalloc;

/// A derivation allocates many small objects; this allocator saves a quarter of its time.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// Equations of motion from a declarative mechanism spec, by the Gibbs-Appell method.
/// MODEL is the name of a shipped mechanism (`appell list`) or the path of a spec file, which needs
///no compilation. Exit status: 0 success, 2 usage error, 3 invalid spec or data, 4 failed
///computation.
#[derive(Debug, Parser)]
#[command(name = "appell", version, propagate_version = true)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    match commands::run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure::print(&failure);
            ExitCode::from(failure::status(&failure))
        }
    }
}
