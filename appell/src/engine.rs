//! Three ways to evaluate the equations of one mechanism.

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::Model;

use crate::Error;
use crate::source::Source;

/// What evaluates the equations. All three give the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Machine code made in this process.
    Jit,
    /// The emitted Rust, compiled into this program; shipped mechanisms only.
    Emitted,
    /// Operation by operation; slow.
    Interpreter,
}

/// A model that may be borrowed from the program or made now.
pub enum Equations {
    /// Compiled into this program.
    Shipped(&'static dyn Model),
    /// Made in this process.
    Made {
        /// What evaluates them.
        model: Box<dyn Model>,
        /// Why it is slower than what was asked for.
        note: Option<String>,
    },
}

impl Equations {
    /// The equations of a spec.
    pub fn new(source: &Source, engine: Engine) -> Result<Self, Error> {
        match (engine, source.shipped) {
            (Engine::Emitted, Some(shipped)) => return Ok(Self::Shipped(shipped.model)),
            (Engine::Emitted, None) => {
                return Err(Error::Usage(
                    "`--engine emitted` is for shipped mechanisms; a spec file runs with `--engine jit`".to_owned(),
                ));
            }
            _ => {}
        }
        Self::made(source, engine, &FunctionKind::STANDARD)
    }

    /// Machine code with what estimation asks for: adjoints.
    pub fn for_estimation(source: &Source) -> Result<Self, Error> {
        Self::made(source, Engine::Jit, &FunctionKind::ALL)
    }

    fn made(source: &Source, engine: Engine, kinds: &[FunctionKind]) -> Result<Self, Error> {
        let program = appell_codegen::compile(&source.file, &source.text, kinds)?;
        let mut note = None;
        if engine == Engine::Jit {
            match JitModel::new(&program) {
                Ok(model) => {
                    let model: Box<dyn Model> = Box::new(model);
                    return Ok(Self::Made { model, note });
                }
                Err(reason) => note = Some(format!("{reason}; the equations are interpreted")),
            }
        }
        let model: Box<dyn Model> = Box::new(InterpretedModel::new(program));
        Ok(Self::Made { model, note })
    }

    /// Why the equations are interpreted although machine code was asked for.
    pub fn note(&self) -> Option<&str> {
        match self {
            Self::Shipped(_) => None,
            Self::Made { note, .. } => note.as_deref(),
        }
    }

    /// Shipped equations where they exist, which need no derivation; machine code for others.
    pub fn at_hand(source: &Source) -> Result<Self, Error> {
        let engine = if source.shipped.is_some() {
            Engine::Emitted
        } else {
            Engine::Jit
        };
        Self::new(source, engine)
    }

    /// The model.
    pub fn model(&self) -> &dyn Model {
        match self {
            Self::Shipped(model) => *model,
            Self::Made { model, .. } => model.as_ref(),
        }
    }
}
