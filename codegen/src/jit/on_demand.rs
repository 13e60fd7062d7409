//! Lazy compilation of one function of a model, with the interpreter as fallback.

use std::sync::OnceLock;

use appell_runtime::model::At;

use super::host::Use;
use super::native::check_lengths;
use super::{Elementary, JitError, NativeFunction, Sizes};
use crate::program::{Function, FunctionKind, Program};
use crate::schedule::schedule;
use crate::tape::{ResultArray, Tape, interpret_weighted};

/// A requested result of a function: its name and its length.
pub(super) type Wanted = (&'static str, usize);

/// Some results of a function of a program, compiled on first use.
pub(super) struct OnDemand {
    kind: FunctionKind,
    wanted: Vec<Wanted>,
    of: Use,
    tape: OnceLock<Tape>,
    ready: OnceLock<Ready>,
}

/// A function that can be evaluated.
pub(super) enum Ready {
    /// Compiled.
    Native(NativeFunction),
    /// Interpreted, because compilation failed.
    Interpreted {
        /// The function, restricted to the requested results.
        tape: Tape,
        /// Lengths of the arguments.
        sizes: Sizes,
        /// Lengths of the results.
        results: Vec<usize>,
        /// Why compilation failed.
        reason: JitError,
    },
}

impl OnDemand {
    /// The requested results of a function. A program may omit results without entries.
    pub(super) fn new(
        program: &Program,
        kind: FunctionKind,
        wanted: Vec<Wanted>,
        of: Use,
    ) -> Result<Self, JitError> {
        let function = find(program, kind);
        for &(result, expected) in wanted.iter().filter(|(_, len)| *len > 0) {
            let function = function.ok_or(JitError::MissingFunction { kind })?;
            let array = function
                .results
                .iter()
                .find(|array| array.name == result)
                .ok_or(JitError::MissingResult { kind, result })?;
            let found = array.entries.len();
            if found != expected {
                return Err(JitError::ResultLength {
                    kind,
                    result,
                    expected,
                    found,
                });
            }
        }
        Ok(Self {
            kind,
            wanted,
            of,
            tape: OnceLock::new(),
            ready: OnceLock::new(),
        })
    }

    /// Compiles the function now, or returns why this is impossible.
    pub(super) fn compile(&self, program: &Program, sizes: Sizes) -> Result<(), JitError> {
        let native = NativeFunction::compile(self.tape(program), sizes)?;
        self.ready.get_or_init(|| Ready::Native(native));
        Ok(())
    }

    /// Compiles the function now, or prepares its interpretation.
    pub(super) fn prepare(&self, program: &Program, sizes: Sizes) {
        self.ready(program, sizes);
    }

    /// Evaluates the function; see [`NativeFunction::call_weighted`].
    #[inline]
    pub(super) fn call<const N: usize>(
        &self,
        program: &Program,
        sizes: Sizes,
        at: At<'_>,
        weights: &[f64],
        out: [&mut [f64]; N],
    ) {
        self.ready(program, sizes).call(at, weights, out);
    }

    /// The function, prepared on first use.
    #[inline]
    fn ready(&self, program: &Program, sizes: Sizes) -> &Ready {
        self.ready.get_or_init(|| self.make(program, sizes))
    }

    /// Why the function is interpreted, if it is.
    pub(super) fn reason(&self) -> Option<&JitError> {
        match self.ready.get()? {
            Ready::Native(_) => None,
            Ready::Interpreted { reason, .. } => Some(reason),
        }
    }

    #[cold]
    fn make(&self, program: &Program, sizes: Sizes) -> Ready {
        Ready::of(self.tape(program).clone(), sizes, self.of)
    }

    /// Uses another tape, made on first use.
    #[inline]
    pub(super) fn follow(&self, make: impl FnOnce() -> Tape) {
        self.tape.get_or_init(make);
    }

    pub(super) fn tape(&self, program: &Program) -> &Tape {
        self.tape.get_or_init(|| self.find_tape(program))
    }

    /// The operations of the whole function, so that results do not depend on the selection, with only the requested
    /// results. The compiler eliminates dead operations.
    fn find_tape(&self, program: &Program) -> Tape {
        let whole =
            find(program, self.kind).filter(|_| self.wanted.iter().any(|&(_, len)| len > 0));
        let mut tape = match whole {
            Some(function) => schedule(program, function),
            None => Tape::default(),
        };
        let mut all = std::mem::take(&mut tape.results);
        let wanted = self.wanted.iter().map(|&(name, _)| {
            match all.iter().position(|result| result.name == name) {
                Some(index) => all.swap_remove(index),
                None => ResultArray {
                    name: name.to_owned(),
                    entries: Vec::new(),
                },
            }
        });
        tape.results = wanted.collect();
        tape
    }
}

impl Ready {
    /// Compiles a tape if that is possible.
    fn of(tape: Tape, sizes: Sizes, of: Use) -> Self {
        match NativeFunction::compile_for(&tape, sizes, (Elementary::Standard, of)) {
            Ok(native) => Self::Native(native),
            Err(reason) => Self::Interpreted {
                results: tape.lengths(),
                tape,
                sizes,
                reason,
            },
        }
    }

    /// Evaluates the function; see [`NativeFunction::call`].
    #[inline]
    pub(super) fn call<const N: usize>(&self, at: At<'_>, weights: &[f64], out: [&mut [f64]; N]) {
        match self {
            Self::Native(native) => native.call_weighted(at, weights, out),
            Self::Interpreted {
                tape,
                sizes,
                results,
                ..
            } => {
                check_lengths(at, *sizes, &out, results);
                let computed = interpret_weighted(tape, at, weights);
                for (out, computed) in out.into_iter().zip(computed) {
                    out.copy_from_slice(&computed);
                }
            }
        }
    }
}

fn find(program: &Program, kind: FunctionKind) -> Option<&Function> {
    program
        .functions
        .iter()
        .find(|function| function.kind == kind)
}
