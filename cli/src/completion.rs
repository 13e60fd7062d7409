//! Completion of commands, flags and models in a shell.
//!
//! The shell asks this program, so that the names are those of this version.

use std::ffi::OsStr;

use appell_models::ALL;
use clap::{Command, CommandFactory as _};
use clap_complete::engine::{
    ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter as _,
};

use crate::commands::Arguments;

/// The commands; models complete to names and specs.
pub(crate) fn command() -> Command {
    with_models(Arguments::command())
}

fn with_models(command: Command) -> Command {
    let command = command.mut_subcommands(with_models);
    command.mut_args(|argument| match argument.get_id().as_str() {
        "model" | "models" => argument.add(ArgValueCompleter::new(models)),
        _ => argument,
    })
}

/// Shipped mechanisms, and specs among the files.
fn models(typed: &OsStr) -> Vec<CompletionCandidate> {
    let begins = typed.to_string_lossy();
    let shipped = ALL
        .iter()
        .filter(|shipped| shipped.name.starts_with(begins.as_ref()));
    let shipped = shipped.map(|shipped| {
        let title = shipped.model.info().title.to_string();
        CompletionCandidate::new(shipped.name).help(Some(title.into()))
    });
    let is_spec = |path: &std::path::Path| path.extension().is_some_and(|end| end == "toml");
    let specs = PathCompleter::file().filter(is_spec).complete(typed);
    shipped.chain(specs).collect()
}
