//! Completion of commands, flags and models in a shell.
//!
//! The shell asks this program, so that the names are those of this version.

use std::ffi::OsStr;
use std::path::Path;

use appell::{Model, ModelInfo, Quantity};
use appell_analysis::Term;
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
        "set" => argument.add(ArgValueCompleter::new(|typed: &OsStr| {
            names(typed, |info| own(&info.parameters))
        })),
        "initial" => argument.add(ArgValueCompleter::new(|typed: &OsStr| {
            names(typed, |info| own(&info.states))
        })),
        "input" => argument.add(ArgValueCompleter::new(|typed: &OsStr| {
            names(typed, |info| own(&info.inputs[..info.declared_inputs]))
        })),
        "fix" | "at" | "along" => argument.add(ArgValueCompleter::new(|typed: &OsStr| {
            names(typed, Term::names)
        })),
        _ => argument,
    })
}

fn own(quantities: &[Quantity]) -> Vec<String> {
    let names = quantities.iter().map(|quantity| quantity.name.to_string());
    names.collect()
}

/// `NAME=` for the names that the model of the command line has.
fn names(typed: &OsStr, of: impl Fn(&ModelInfo) -> Vec<String>) -> Vec<CompletionCandidate> {
    let begins = typed.to_string_lossy();
    let is_spec = |word: &str| Path::new(word).extension().is_some_and(|end| end == "toml");
    let is_model = |word: &String| is_spec(word) || ALL.iter().any(|shipped| shipped.name == word);
    let model = std::env::args().skip(1).find(is_model);
    let model = model.and_then(|word| Model::find(&word).ok());
    let names = model.map(|model| of(model.info())).unwrap_or_default();
    let names = names
        .into_iter()
        .filter(|name| name.starts_with(begins.as_ref()));
    names
        .map(|name| CompletionCandidate::new(format!("{name}=")))
        .collect()
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
