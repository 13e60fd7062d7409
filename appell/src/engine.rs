//! Three implementations of the equations of a mechanism.

use std::sync::Arc;

use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_codegen::tapes::Tapes;
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
    Made(Made),
}

/// A model derived in this process. Each function is derived and compiled when it is first used.
pub struct Made {
    model: Box<dyn Model + Send>,
    tapes: Arc<Tapes>,
    /// Why it is interpreted although machine code was requested.
    note: Option<String>,
}

impl Equations {
    /// The equations of a spec.
    pub fn new(source: &Source, engine: Engine) -> Result<Self, Error> {
        match (engine, source.shipped) {
            (Engine::Emitted, Some(shipped)) => Ok(Self::Shipped(shipped.model)),
            (Engine::Emitted, None) => {
                let message = "emitted code exists only for shipped mechanisms; a spec file runs as machine code";
                Err(Error::request(Field::Engine, message))
            }
            _ => Ok(Self::Made(Made::new(source, engine)?)),
        }
    }

    /// Why the equations are interpreted although machine code was requested.
    pub fn note(&self) -> Option<&str> {
        match self {
            Self::Shipped(_) => None,
            Self::Made(made) => made.note.as_deref(),
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
            Self::Made(made) => made.model(),
        }
    }

    /// Derives functions now, in parallel, or returns why one of them is impossible.
    pub(crate) fn require(&self, source: &Source, kinds: &[FunctionKind]) -> Result<(), Error> {
        match self {
            Self::Shipped(_) => Ok(()),
            Self::Made(made) => Ok(made.tapes.require(kinds, &source.text)?),
        }
    }
}

impl Made {
    /// The equations of a spec, derived in this process.
    pub(crate) fn new(source: &Source, engine: Engine) -> Result<Self, Error> {
        Self::of(source, Tapes::of_spec(&source.file, &source.text)?, engine)
    }

    /// Machine code of the functions of a source if requested and possible, else their interpretation.
    pub(crate) fn of(source: &Source, tapes: Tapes, engine: Engine) -> Result<Self, Error> {
        let tapes = Arc::new(tapes);
        tapes.require(&[FunctionKind::Rates], &source.text)?;
        let mut note = None;
        if engine == Engine::Jit {
            match JitModel::over(tapes.clone()) {
                Ok(model) => {
                    let model = Box::new(model);
                    return Ok(Self { model, tapes, note });
                }
                Err(reason) => note = Some(format!("{reason}; the equations are interpreted")),
            }
        }
        let model = Box::new(InterpretedModel::over(tapes.clone()));
        Ok(Self { model, tapes, note })
    }

    /// The model.
    pub(crate) fn model(&self) -> &dyn Model {
        self.model.as_ref()
    }

    /// Its functions as tapes.
    pub(crate) fn tapes(&self) -> &Tapes {
        &self.tapes
    }
}
