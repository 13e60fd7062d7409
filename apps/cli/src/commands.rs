//! One file per command: parse flags, call, print.

mod apply;
mod base;
mod cache;
mod check;
mod completions;
mod control;
mod demo;
mod derive;
mod diagnose;
mod draw;
mod effects;
mod ensemble;
mod evaluate;
mod export;
mod identify;
mod import;
mod inverse;
mod list;
mod lsp;
mod man;
mod motion;
mod new;
mod recording;
mod reproduce;
mod sample;
mod schema;
mod simulate;
mod stability;
mod steady;
mod watch;

use crate::failure::Error;

/// Equations of motion from a declarative mechanism spec, by the Gibbs-Appell method.
///
/// MODEL is the name of a shipped mechanism (`appell list`) or the path of a spec file, which needs
/// no compilation. Exit status: 0 success, 2 usage error, 3 invalid spec or data, 4 failed
/// computation.
#[derive(Debug, clap::Parser)]
#[command(name = "appell", version, propagate_version = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Neither read nor keep derived equations in the cache
    #[arg(long, global = true)]
    pub(crate) no_cache: bool,
}

macro_rules! commands {
    ($($name:ident($command:ty),)*) => {
        /// The commands.
        #[derive(Debug, clap::Subcommand)]
        pub(crate) enum Command {
            $($name($command),)*
        }

        /// Runs a command.
        pub(crate) fn run(command: Command) -> Result<(), Error> {
            match command {
                $(Command::$name(command) => command.run(),)*
            }
        }
    };
}

commands! {
    List(list::List),
    New(new::New),
    Import(import::Import),
    Check(check::Check),
    Derive(derive::Derive),
    Draw(draw::Draw),
    Export(export::Export),
    Evaluate(evaluate::Evaluate),
    Simulate(Box<simulate::Simulate>),
    Ensemble(ensemble::EnsembleCommand),
    Control(Box<control::Control>),
    Sample(sample::Sample),
    Recording(recording::Recording),
    Identify(identify::Identify),
    Inverse(inverse::Inverse),
    Base(base::Base),
    Motion(motion::Motion),
    Diagnose(diagnose::Diagnose),
    Effects(effects::Effects),
    Apply(apply::Apply),
    Steady(steady::Steady),
    Stability(stability::StabilityCommand),
    Demo(demo::Demo),
    Reproduce(reproduce::Reproduce),
    Schema(schema::Schema),
    Watch(watch::Watch),
    Lsp(lsp::Lsp),
    Cache(cache::Cache),
    Completions(completions::Completions),
    Man(man::Man),
}
