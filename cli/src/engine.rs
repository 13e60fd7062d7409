//! `--engine`, and equations made under a spinner.

use appell::Error;
use appell::engine::Equations;
use appell::source::Source;

use crate::failure::note;
use crate::progress;

/// What evaluates the equations. All three give the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Engine {
    /// Machine code made in this process.
    Jit,
    /// The emitted Rust, compiled into this program; shipped mechanisms only.
    Emitted,
    /// Operation by operation; slow.
    Interpreter,
}

/// The equations of a spec; without an engine those at hand.
pub(crate) fn equations(source: &Source, engine: Option<Engine>) -> Result<Equations, Error> {
    made(|| match engine {
        None => Equations::at_hand(source),
        Some(Engine::Jit) => Equations::new(source, appell::engine::Engine::Jit),
        Some(Engine::Emitted) => Equations::new(source, appell::engine::Engine::Emitted),
        Some(Engine::Interpreter) => Equations::new(source, appell::engine::Engine::Interpreter),
    })
}

/// The same with what estimation asks for.
pub(crate) fn equations_for_estimation(source: &Source) -> Result<Equations, Error> {
    made(|| Equations::for_estimation(source))
}

fn made(make: impl FnOnce() -> Result<Equations, Error>) -> Result<Equations, Error> {
    let spinner = progress::spinner("deriving the equations of motion");
    let equations = make();
    spinner.finish_and_clear();
    let equations = equations?;
    if let Some(text) = equations.note() {
        note(text);
    }
    Ok(equations)
}
