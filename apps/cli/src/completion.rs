//! Completion of commands, flags and models in a shell.
//!
//! The shell calls this program, so that the names are those of this version.

use std::ffi::OsStr;
use std::path::Path;

use appell::robot::Without;
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
    let is_import = command.get_name() == "import";
    let is_effects = command.get_name() == "effects";
    command.mut_args(|argument| {
        let complete: fn(&OsStr) -> Vec<CompletionCandidate> = match argument.get_id().as_str() {
            "model" | "models" => models,
            "set" => |typed| names(typed, |info| own(&info.parameters)),
            "initial" => |typed| names(typed, |info| own(&info.states)),
            "input" => |typed| names(typed, |info| own(&info.inputs[..info.declared_inputs])),
            // `--without` has different values in different commands.
            "without" if is_import => |typed| listed(typed, Without::ALL.map(Without::word)),
            "name" if is_effects => |typed| {
                let library = appell::effects::library().unwrap_or_default();
                beginning(typed, library.iter().map(|effect| effect.name.as_str()))
            },
            "fix" | "at" | "along" => |typed| names(typed, Term::names),
            _ => return argument,
        };
        argument.add(ArgValueCompleter::new(complete))
    })
}

/// Words that begin with the typed one, each once.
fn beginning<'w>(typed: &OsStr, words: impl Iterator<Item = &'w str>) -> Vec<CompletionCandidate> {
    let begins = typed.to_string_lossy();
    let mut words: Vec<&str> = words.filter(|word| word.starts_with(&*begins)).collect();
    words.dedup();
    words.into_iter().map(CompletionCandidate::new).collect()
}

/// Comma-separated words: candidates for the last one.
fn listed<const N: usize>(typed: &OsStr, words: [&str; N]) -> Vec<CompletionCandidate> {
    let typed = typed.to_string_lossy();
    let (before, last) = typed
        .rfind(',')
        .map_or(("", &*typed), |comma| typed.split_at(comma + 1));
    let given: Vec<&str> = before.split(',').collect();
    let words = words.into_iter();
    let words = words.filter(|word| word.starts_with(last) && !given.contains(word));
    words
        .map(|word| CompletionCandidate::new(format!("{before}{word}")))
        .collect()
}

fn own(quantities: &[Quantity]) -> Vec<String> {
    let names = quantities.iter().map(|quantity| quantity.name.to_string());
    names.collect()
}

/// `NAME=` for the names of the model on the command line.
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
