//! The compiler's settings for this processor.

use std::sync::OnceLock;

use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};

use super::JitError;

/// The instruction set of this processor; found out once.
pub(super) fn target() -> Result<OwnedTargetIsa, JitError> {
    static TARGET: OnceLock<OwnedTargetIsa> = OnceLock::new();
    if let Some(target) = TARGET.get() {
        return Ok(target.clone());
    }
    let target = detect()?;
    Ok(TARGET.get_or_init(|| target).clone())
}

fn detect() -> Result<OwnedTargetIsa, JitError> {
    let mut flags = settings::builder();
    flags.set("opt_level", "speed")?;
    // The code calls functions that may be far away, by address.
    flags.set("is_pic", "false")?;
    flags.set("use_colocated_libcalls", "false")?;
    // Long functions spill to frames of many pages: touch each, without a call.
    flags.set("probestack_strategy", "inline")?;
    // Nothing unwinds through the code.
    flags.set("unwind_info", if cfg!(windows) { "true" } else { "false" })?;
    flags.set(
        "enable_verifier",
        if cfg!(debug_assertions) {
            "true"
        } else {
            "false"
        },
    )?;
    let builder = cranelift_native::builder().map_err(|reason| JitError::Host { reason })?;
    Ok(builder.finish(settings::Flags::new(flags))?)
}
