//! One file per command: parse flags, call, print.

mod check;
mod completions;
mod demo;
mod derive;
mod evaluate;
mod list;
mod new;
mod simulate;

use crate::failure::Failure;

/// The commands.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Command {
    /// Shipped mechanisms
    List(list::List),
    /// Write a commented spec to start from
    New(new::New),
    /// Validate specs and tell what they describe
    Check(check::Check),
    /// The equations of motion, as a page or as Rust
    Derive(derive::Derive),
    /// Numbers at given states: rates, mass matrix, Jacobians, energies, reactions
    Evaluate(evaluate::Evaluate),
    /// Integrate the equations of motion
    Simulate(simulate::Simulate),
    /// Derive the unicycle, let it change lanes, draw the motion
    Demo(demo::Demo),
    /// Shell completions
    #[command(hide = true)]
    Completions(completions::Completions),
}

/// Runs a command.
pub(crate) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::List(command) => command.run(),
        Command::New(command) => command.run(),
        Command::Check(command) => command.run(),
        Command::Derive(command) => command.run(),
        Command::Evaluate(command) => command.run(),
        Command::Simulate(command) => command.run(),
        Command::Demo(command) => command.run(),
        Command::Completions(command) => command.run(),
    }
}
