//! Three implementations of the equations of a mechanism.

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::{FunctionKind, Program};
use appell_runtime::model::Model;

use crate::source::Source;
use crate::{Error, Field};

/// Implementation of the equations. All give the same results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Machine code, compiled in this process.
    Jit,
    /// The emitted Rust, compiled into this program; shipped mechanisms only.
    Emitted,
    /// Interpreted operation by operation; slow.
    Interpreter,
}

/// A shipped model, or one derived in this process.
pub enum Equations {
    /// Compiled into this program.
    Shipped(&'static dyn Model),
    /// Derived in this process.
    Made {
        /// Their implementation.
        model: Box<dyn Model + Send>,
        /// Why it is interpreted although machine code was requested.
        note: Option<String>,
    },
}

impl Equations {
    /// The equations of a spec.
    pub fn new(source: &Source, engine: Engine) -> Result<Self, Error> {
        match (engine, source.shipped) {
            (Engine::Emitted, Some(shipped)) => return Ok(Self::Shipped(shipped.model)),
            (Engine::Emitted, None) => {
                let message = "emitted code exists only for shipped mechanisms; a spec file runs as machine code";
                return Err(Error::request(Field::Engine, message));
            }
            _ => {}
        }
        Self::made(source, engine, &FunctionKind::STANDARD)
    }

    /// Machine code with the adjoints that estimation needs.
    pub fn for_estimation(source: &Source) -> Result<Self, Error> {
        Self::made(source, Engine::Jit, &FunctionKind::ALL)
    }

    fn made(source: &Source, engine: Engine, kinds: &[FunctionKind]) -> Result<Self, Error> {
        let program = appell_codegen::compile(&source.file, &source.text, kinds)?;
        Ok(Self::of(program, engine))
    }

    /// A program as machine code if requested and possible, else interpreted.
    pub(crate) fn of(program: Program, engine: Engine) -> Self {
        let mut note = None;
        if engine == Engine::Jit {
            match JitModel::new(&program) {
                Ok(model) => {
                    let model: Box<dyn Model + Send> = Box::new(model);
                    return Self::Made { model, note };
                }
                Err(reason) => note = Some(format!("{reason}; the equations are interpreted")),
            }
        }
        let model: Box<dyn Model + Send> = Box::new(InterpretedModel::new(program));
        Self::Made { model, note }
    }

    /// Why the equations are interpreted although machine code was requested.
    pub fn note(&self) -> Option<&str> {
        match self {
            Self::Shipped(_) => None,
            Self::Made { note, .. } => note.as_deref(),
        }
    }

    /// The emitted code of a shipped mechanism, which needs no derivation; machine code otherwise.
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
