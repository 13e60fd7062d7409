//! Lazy compilation of one function of a model, with the interpreter as fallback.

use std::fmt;
use std::sync::OnceLock;

use super::host::Use;
use super::{Elementary, JitError, NativeFunction, Sizes};
use crate::tape::Tape;

/// A function, compiled at its first use.
pub(super) struct OnDemand {
    of: Use,
    /// The tape, if it is not that of the model.
    tape: OnceLock<Tape>,
    ready: OnceLock<NativeFunction>,
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
        self.ready.get_or_init(|| native);
        Ok(())
    }

    /// The function, compiled if that is possible.
    #[inline]
    pub(super) fn ready<'t>(
        &self,
        tape: impl FnOnce() -> &'t Tape,
        sizes: Sizes,
    ) -> &NativeFunction {
        self.ready.get_or_init(|| self.made(tape(), sizes))
    }

    #[cold]
    fn made(&self, tape: &Tape, sizes: Sizes) -> NativeFunction {
        NativeFunction::compile_for(tape, sizes, Elementary::Standard, self.of)
            .unwrap_or_else(|_| NativeFunction::interpreted(tape, sizes))
    }
}

impl fmt::Debug for OnDemand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OnDemand").finish_non_exhaustive()
    }
}
