//! Handling of Ctrl-C and other terminating signals.

use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a computation checks [`STOPPED`].
static IS_AWAITED: AtomicBool = AtomicBool::new(false);
static STOPPED: AtomicBool = AtomicBool::new(false);
/// Exit status after Ctrl-C, as shells report it.
const STATUS: i32 = 130;

/// Removes temporary files.
pub(crate) fn install() {
    // On systems without signals, a draft may remain.
    let _ = ctrlc::set_handler(|| {
        let is_first = !STOPPED.swap(true, Ordering::Relaxed);
        if is_first && IS_AWAITED.load(Ordering::Relaxed) {
            return;
        }
        appell::files::remove_drafts();
        std::process::exit(STATUS);
    });
}

/// Whether a signal has arrived. After the first call the caller must end the program; a second signal ends it at once.
pub(crate) fn has_come() -> bool {
    IS_AWAITED.store(true, Ordering::Relaxed);
    STOPPED.load(Ordering::Relaxed)
}
