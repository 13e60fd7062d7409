//! The memory that holds machine code.

use std::fmt;
use std::sync::Mutex;

use cranelift_jit::JITModule;

/// Owner of the memory that holds the code. The lock is never contended: it only makes the compiler's state,
/// unused after compilation, shareable between threads.
pub(super) struct Code(Mutex<Option<Box<JITModule>>>);

impl Code {
    /// Takes a module whose code is not called otherwise. The memory is freed with the owner.
    pub(super) fn new(module: JITModule) -> Self {
        Self(Mutex::new(Some(Box::new(module))))
    }
}

impl Drop for Code {
    fn drop(&mut self) {
        let module = self.0.get_mut().map(Option::take);
        if let Ok(Some(module)) = module {
            // SAFETY: a compiled function owns its code and only runs it during a call, which
            // borrows it, so no code runs now and none will.
            unsafe { module.free_memory() }
        }
    }
}

impl fmt::Debug for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Code")
    }
}
