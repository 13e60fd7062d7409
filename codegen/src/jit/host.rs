//! The compiler's settings for this processor.

use std::sync::OnceLock;

use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};

use super::JitError;

/// Expected lifetime of a function, which decides the effort of register allocation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// For the whole run of the program.
    Lasting,
    /// For some ten thousand evaluations, which take no longer than optimal register allocation.
    Brief,
}

impl Use {
    /// Number of operations, as [`Checked`](super::check::Checked) counts them, beyond which a function is long.
    const fn long(self) -> usize {
        match self {
            Self::Lasting => 6000,
            Self::Brief => 1200,
        }
    }
}

/// The instruction set of this processor, for a function of a given number of operations; determined once.
pub(super) fn target(operations: usize, of: Use) -> Result<OwnedTargetIsa, JitError> {
    static TARGETS: [OnceLock<OwnedTargetIsa>; 2] = [OnceLock::new(), OnceLock::new()];
    let is_long = operations > of.long();
    let known = &TARGETS[usize::from(is_long)];
    if let Some(target) = known.get() {
        return Ok(target.clone());
    }
    let target = detect(is_long)?;
    Ok(known.get_or_init(|| target).clone())
}

fn detect(is_long: bool) -> Result<OwnedTargetIsa, JitError> {
    let mut flags = settings::builder();
    // Good register allocation takes longer than some ten thousand evaluations save, in the end minutes; most values of a
    // long function are spilled anyway. Tapes have no common subexpressions.
    if is_long {
        flags.set("opt_level", "none")?;
        flags.set("regalloc_algorithm", "single_pass")?;
    } else {
        flags.set("opt_level", "speed")?;
    }
    // The code calls functions at any distance, by absolute address.
    flags.set("is_pic", "false")?;
    flags.set("use_colocated_libcalls", "false")?;
    // Long functions spill to frames of many pages: probe each page inline.
    flags.set("probestack_strategy", "inline")?;
    // Panics never unwind through the code.
    flags.set("unwind_info", &cfg!(windows).to_string())?;
    flags.set("enable_verifier", &cfg!(debug_assertions).to_string())?;
    let builder = cranelift_native::builder().map_err(|reason| JitError::Host { reason })?;
    Ok(builder.finish(settings::Flags::new(flags))?)
}
