//! Three ways to evaluate the equations of one mechanism.

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::Model;

use crate::failure::{Failure, note};
use crate::progress;
use crate::source::Source;

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

/// A model that may be borrowed from the program or made now.
pub(crate) enum Equations {
    /// Compiled into this program.
    Shipped(&'static dyn Model),
    /// Made in this process.
    Made(Box<dyn Model>),
}

impl Equations {
    /// The equations of a spec.
    pub(crate) fn new(source: &Source, engine: Engine) -> Result<Self, Failure> {
        match (engine, source.shipped) {
            (Engine::Emitted, Some(shipped)) => return Ok(Self::Shipped(shipped.model)),
            (Engine::Emitted, None) => {
                return Err(Failure::Usage(
                    "`--engine emitted` is for shipped mechanisms; a spec file runs with `--engine jit`".to_owned(),
                ));
            }
            _ => {}
        }
        Self::made(source, engine, &FunctionKind::STANDARD)
    }

    /// Machine code with what estimation asks for: adjoints.
    pub(crate) fn for_estimation(source: &Source) -> Result<Self, Failure> {
        Self::made(source, Engine::Jit, &FunctionKind::ALL)
    }

    fn made(source: &Source, engine: Engine, kinds: &[FunctionKind]) -> Result<Self, Failure> {
        let spinner = progress::spinner("deriving the equations of motion");
        let program = appell_codegen::compile(&source.file, &source.text, kinds)?;
        spinner.finish_and_clear();
        if engine == Engine::Jit {
            match JitModel::new(&program) {
                Ok(model) => return Ok(Self::Made(Box::new(model))),
                Err(reason) => note(&format!("{reason}; the equations are interpreted")),
            }
        }
        Ok(Self::Made(Box::new(InterpretedModel::new(program))))
    }

    /// Shipped equations where they exist, which need no derivation; machine code for others.
    pub(crate) fn at_hand(source: &Source) -> Result<Self, Failure> {
        let engine = if source.shipped.is_some() {
            Engine::Emitted
        } else {
            Engine::Jit
        };
        Self::new(source, engine)
    }

    /// The model.
    pub(crate) fn model(&self) -> &dyn Model {
        match self {
            Self::Shipped(model) => *model,
            Self::Made(model) => model.as_ref(),
        }
    }
}
