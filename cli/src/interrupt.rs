//! What Ctrl-C and the other signals that end a program do.

use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a computation looks at [`STOPPED`].
static IS_AWAITED: AtomicBool = AtomicBool::new(false);
static STOPPED: AtomicBool = AtomicBool::new(false);
/// What shells report of a program that Ctrl-C has ended.
const STATUS: i32 = 130;

/// No half-written file stays behind.
pub(crate) fn install() {
    // Where the system has no signals, a draft may stay.
    let _ = ctrlc::set_handler(|| {
        let is_first = !STOPPED.swap(true, Ordering::Relaxed);
        if is_first && IS_AWAITED.load(Ordering::Relaxed) {
            return;
        }
        appell::files::remove_drafts();
        std::process::exit(STATUS);
    });
}

/// Whether a signal has come. From the first call on it is the caller who ends; a second signal ends the program.
pub(crate) fn has_come() -> bool {
    IS_AWAITED.store(true, Ordering::Relaxed);
    STOPPED.load(Ordering::Relaxed)
}
