//! `--engine`, and derivation with a progress indicator.

use appell::Error;
use appell::engine::Equations;
use appell::source::Source;

use crate::failure::note;
use crate::progress;

/// How the equations are evaluated. All three give the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Engine {
    /// Machine code, compiled in this process.
    Jit,
    /// The emitted Rust, compiled into this program; shipped mechanisms only.
    Emitted,
    /// Interpreted operation by operation; slow.
    Interpreter,
}

/// The equations of a spec; without an engine, emitted ones if there are any, else machine code.
pub(crate) fn equations(source: &Source, engine: Option<Engine>) -> Result<Equations, Error> {
    made(|| match engine {
        None => Equations::at_hand(source),
        Some(Engine::Jit) => Equations::new(source, appell::engine::Engine::Jit),
        Some(Engine::Emitted) => Equations::new(source, appell::engine::Engine::Emitted),
        Some(Engine::Interpreter) => Equations::new(source, appell::engine::Engine::Interpreter),
    })
}

/// The equations with the adjoints that estimation needs.
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
