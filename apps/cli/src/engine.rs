//! `--engine`, and models compiled under a spinner.

use crate::failure::Error;
use appell::Model;
use appell::setup::Assignment;
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

impl From<Engine> for appell::engine::Engine {
    fn from(engine: Engine) -> Self {
        match engine {
            Engine::Jit => Self::Jit,
            Engine::Emitted => Self::Emitted,
            Engine::Interpreter => Self::Interpreter,
        }
    }
}

/// The source of a MODEL.
pub(crate) fn source(model: &str) -> Result<Source, Error> {
    source_with(model, &[])
}

/// The same; numbers of a robot file that are set are parameters.
fn source_with(model: &str, set: &[Assignment]) -> Result<Source, Error> {
    let numbers: Vec<&str> = set.iter().map(|one| one.name.as_str()).collect();
    let source = Source::find_with(model, &numbers)?;
    // What the equations of a robot file lack although it changes the motion.
    let lacking = source.robot.iter().flat_map(|robot| robot.remarks());
    lacking.for_each(|remark| note(&remark));
    Ok(source)
}

/// The model of a MODEL; without an engine, emitted code if shipped, else machine code. Of a robot file, numbers that are
/// set are parameters.
pub(crate) fn model(
    model: &str,
    set: &[Assignment],
    engine: Option<Engine>,
) -> Result<Model, Error> {
    let source = source_with(model, set)?;
    made(|| Model::of(source, engine.map(Into::into)))
}

/// The model of a source, derived in this process.
pub(crate) fn model_of(source: Source) -> Result<Model, Error> {
    made(|| Model::of(source, Some(Engine::Jit.into())))
}

fn made(make: impl FnOnce() -> Result<Model, appell::Error>) -> Result<Model, Error> {
    let model = progress::during("deriving the equations of motion", |_| make())?;
    if let Some(text) = model.note() {
        note(text);
    }
    Ok(model)
}
