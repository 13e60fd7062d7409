//! `appell`: from a mechanism spec to equations of motion, numbers and motions.

mod commands;
mod completion;
mod design_report;
mod destinations;
mod diagnosed;
mod engine;
mod failure;
mod interrupt;
mod motions;
mod output;
mod picture;
mod progress;
mod summary;

use std::process::ExitCode;

use appell::cache::Cache;
use clap::{ArgMatches, CommandFactory as _, FromArgMatches as _};
use clap_complete::CompleteEnv;
use mimalloc::MiMalloc;

use commands::Arguments;

/// A derivation allocates many small objects; this allocator saves a quarter of its time.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    CompleteEnv::with_factory(completion::command).complete();
    interrupt::install();
    quiet_parquet();
    let given = Arguments::command().try_get_matches();
    match run(&given.unwrap_or_else(|error| failure::usage(&error))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure::print(&failure);
            ExitCode::from(failure::status(&failure))
        }
    }
}

/// Suppresses panic messages of the Parquet library, which are reported as errors of the file.
fn quiet_parquet() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |slip| {
        let file = slip.location().map_or("", std::panic::Location::file);
        if !file.contains("parquet") {
            usual(slip);
        }
    }));
}

fn run(given: &ArgMatches) -> Result<(), failure::Error> {
    if let Some((_, command)) = given.subcommand() {
        destinations::check(command)?;
    }
    // The arguments have been parsed already.
    let arguments = Arguments::from_arg_matches(given).unwrap_or_else(|error| error.exit());
    if let Some(cache) = Cache::of_user().filter(|_| !arguments.no_cache) {
        cache.use_from_now_on();
    }
    commands::run(arguments.command)
}
