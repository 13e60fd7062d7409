//! Long computations: the interpreter goes on beside them, hears how far they are, and may leave them.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::mistake;

/// How often the interpreter is asked for an interruption.
const LOOK: Duration = Duration::from_millis(50);
/// As much as the command line has on its main thread.
const STACK: usize = 8 << 20;

/// What a computation tells, and whether it should go on.
pub(crate) struct Watch {
    stages: Sender<&'static str>,
    left: Arc<AtomicBool>,
}

/// What unwinds a computation that nobody waits for.
struct Left;

impl Watch {
    /// Whether somebody waits for it.
    pub(crate) fn goes_on(&self) -> bool {
        !self.left.load(Ordering::Relaxed)
    }

    /// Tells of a stage. A computation that nobody waits for ends here.
    pub(crate) fn stage(&self, stage: &'static str) {
        if !self.goes_on() {
            resume_unwind(Box::new(Left));
        }
        // Nobody hears it once the interpreter has given up.
        let _ = self.stages.send(stage);
    }
}

/// Computes on another thread without the lock of the interpreter. `progress` is called with each stage; an exception
/// in it, and an interruption from the keyboard, are raised at once, and the computation ends at its next stage.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    compute: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    run(py, progress, false, compute)
}

/// The same of a computation that calls Python: an interruption is raised once it has ended, since no thread may call
/// an interpreter that is shut down.
pub(crate) fn awaited<T: Send + 'static>(
    py: Python<'_>,
    compute: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    run(py, None, true, compute)
}

fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    is_awaited: bool,
    compute: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let (send, mut stages) = channel();
    let left = Arc::new(AtomicBool::new(false));
    let watch = Watch {
        stages: send,
        left: Arc::clone(&left),
    };
    let thread = thread::Builder::new().stack_size(STACK);
    // The end of the computation closes the channel.
    let worker = thread.spawn(move || compute(&watch));
    let worker = worker.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    loop {
        let heard_of = &mut stages;
        let told = py.detach(move || heard_of.recv_timeout(LOOK));
        let heard = match (told, progress) {
            (Ok(stage), Some(progress)) => progress.call1((stage,)).map(|_| ()),
            (Err(RecvTimeoutError::Disconnected), _) => break,
            _ => Ok(()),
        };
        if let Err(error) = heard.and_then(|()| py.check_signals()) {
            left.store(true, Ordering::Relaxed);
            if is_awaited {
                let _ = py.detach(|| worker.join());
            }
            return Err(error);
        }
    }
    py.detach(|| worker.join()).map_err(|_| mistake(py))
}
