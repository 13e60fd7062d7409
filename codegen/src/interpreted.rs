//! Models that are interpreted, for tests and in place of compiled code.

use std::sync::{Arc, OnceLock};

use appell_runtime::model::At;

use crate::model::{Engine, ProgramModel, tape_of};
use crate::program::{FunctionKind, Program};
use crate::tape::{Tape, interpret_weighted};

/// A model whose tapes are interpreted.
pub type InterpretedModel = ProgramModel<Interpreter>;

/// Interprets tapes.
#[derive(Debug)]
pub struct Interpreter {
    /// By [`FunctionKind`], made at the first use.
    tapes: [OnceLock<Tape>; FunctionKind::COUNT],
}

impl ProgramModel<Interpreter> {
    /// A model of a program.
    pub fn new(program: Program) -> Self {
        let tapes = [const { OnceLock::new() }; FunctionKind::COUNT];
        Self::of(Arc::new(program), Interpreter { tapes })
    }
}

impl Engine for Interpreter {
    fn call<const N: usize>(
        &self,
        program: &Program,
        kind: FunctionKind,
        at: At<'_>,
        own: &[f64],
        out: [&mut [f64]; N],
    ) {
        let results = interpret_weighted(self.tape(program, kind, at.p), at, own);
        for (out, result) in out.into_iter().zip(results) {
            out.copy_from_slice(&result);
        }
    }

    fn tape(&self, program: &Program, kind: FunctionKind, _: &[f64]) -> &Tape {
        self.tapes[kind as usize].get_or_init(|| tape_of(program, kind))
    }
}
