//! Lazy compilation of one function of a model, with the interpreter as fallback.

use std::fmt;
use std::sync::OnceLock;

use appell_runtime::model::At;

use super::host::Use;
use super::native::check_lengths;
use super::{Elementary, JitError, NativeFunction, Sizes};
use crate::tape::{Tape, interpret_weighted};

/// A function, compiled at its first use.
pub(super) struct OnDemand {
    of: Use,
    /// The tape, if it is not that of the model.
    tape: OnceLock<Tape>,
    ready: OnceLock<Ready>,
}

/// A function that can be evaluated.
pub(super) enum Ready {
    /// Compiled.
    Native(NativeFunction),
    /// Interpreted, because compilation failed.
    Interpreted {
        tape: Tape,
        /// Lengths of the arguments.
        sizes: Sizes,
        /// Lengths of the results.
        results: Vec<usize>,
    },
}

impl OnDemand {
    pub(super) const fn new(of: Use) -> Self {
        Self {
            of,
            tape: OnceLock::new(),
            ready: OnceLock::new(),
        }
    }

    /// The function's tape, made at its first use.
    pub(super) fn tape(&self, make: impl FnOnce() -> Tape) -> &Tape {
        self.tape.get_or_init(make)
    }

    /// Compiles the function now, or returns why this is impossible.
    pub(super) fn compile(&self, tape: &Tape, sizes: Sizes) -> Result<(), JitError> {
        let native = NativeFunction::compile(tape, sizes)?;
        self.ready.get_or_init(|| Ready::Native(native));
        Ok(())
    }

    /// The function, compiled if that is possible.
    #[inline]
    pub(super) fn ready<'t>(&self, tape: impl FnOnce() -> &'t Tape, sizes: Sizes) -> &Ready {
        self.ready.get_or_init(|| Ready::of(tape(), sizes, self.of))
    }
}

impl Ready {
    /// Compiles a tape if that is possible.
    #[cold]
    fn of(tape: &Tape, sizes: Sizes, of: Use) -> Self {
        match NativeFunction::compile_for(tape, sizes, Elementary::Standard, of) {
            Ok(native) => Self::Native(native),
            Err(_) => Self::Interpreted {
                results: tape.lengths(),
                tape: tape.clone(),
                sizes,
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

impl fmt::Debug for OnDemand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OnDemand").finish_non_exhaustive()
    }
}
