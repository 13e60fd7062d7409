//! Long computations: the interpreter continues meanwhile, receives their progress, and may abandon them.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use appell::Error;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::{Raise as _, mistake};

/// Interval of checks for an interruption.
const LOOK: Duration = Duration::from_millis(50);
/// Stack size, that of the command line's main thread.
const STACK: usize = 8 << 20;

/// Progress of a computation, and its cancellation.
pub(crate) struct Watch {
    stages: Sender<&'static str>,
    left: Arc<AtomicBool>,
}

/// Payload of the panic that ends an abandoned computation.
struct Left;

impl Watch {
    /// Whether the computation should continue.
    pub(crate) fn goes_on(&self) -> bool {
        !self.left.load(Ordering::Relaxed)
    }

    /// Reports a stage. An abandoned computation ends here.
    pub(crate) fn stage(&self, stage: &'static str) {
        if !self.goes_on() {
            resume_unwind(Box::new(Left));
        }
        // Sending fails only if the interpreter has abandoned the computation.
        let _ = self.stages.send(stage);
    }
}

/// Computes on another thread without the interpreter lock, and raises the exception of an error. `progress` is called with
/// each stage; an exception in it, and a keyboard interruption, are raised at once, and the computation ends at its next
/// stage.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    compute: impl FnOnce(&Watch) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    run(py, progress, false, compute)?.raise(py)
}

/// The same for a computation that calls Python: an interruption is raised once it has ended, since no thread may
/// call an interpreter that has shut down.
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
    // The channel closes when the computation ends.
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
