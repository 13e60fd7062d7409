//! Models that are interpreted, for tests and in place of compiled code.

use std::sync::Arc;

use appell_runtime::model::At;

use crate::model::{Engine, ProgramModel};
use crate::program::FunctionKind;
use crate::tape::{Tape, interpret_into};
use crate::tapes::Tapes;

/// A model whose tapes are interpreted.
pub type InterpretedModel = ProgramModel<Interpreter>;

/// Interprets tapes.
#[derive(Debug)]
pub struct Interpreter;

impl ProgramModel<Interpreter> {
    /// A model of a program or a derivation.
    pub fn new(functions: impl Into<Tapes>) -> Self {
        Self::over(Arc::new(functions.into()))
    }

    /// A model of functions that others use as well.
    pub fn over(tapes: Arc<Tapes>) -> Self {
        Self::of(tapes, Interpreter)
    }
}

impl Engine for Interpreter {
    fn call<const N: usize>(
        &self,
        _: FunctionKind,
        tape: &Tape,
        at: At<'_>,
        own: &[f64],
        mut out: [&mut [f64]; N],
    ) {
        interpret_into(tape, at, own, &mut out);
    }
}
