//! Runs the missing chunks of a study on several threads.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};

use crate::chunk::{Chunk, Chunks};
use crate::rows::{Column, Rows};
use crate::store::{Store, StoreError};
use crate::table_file;

/// Runs cases. All that cases share is set up before; a row depends on its case alone.
pub trait Engine: Sync {
    /// The columns of a row.
    fn columns(&self) -> &[Column];

    /// Appends the rows of consecutive cases, in their order. Stops if the watch requires it: the rows are then
    /// discarded.
    fn run(&self, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows);
}

/// Callbacks for cancellation and progress.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Whether to continue; called in every case.
    pub go_on: &'a (dyn Fn() -> bool + Sync),
    /// Receives the number of cases completed since the last call.
    pub done: &'a (dyn Fn(u64) + Sync),
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Watch")
    }
}

/// How a run of chunks ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// All were run.
    Done,
    /// Cancelled; completed chunks are in the store.
    Stopped,
}

/// Why a run of chunks fails.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The store.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No threads.
    #[error("the threads cannot be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Runs chunks on `jobs` threads, by default one for each processor, and writes each to the store when it is done.
pub fn run(
    engine: &dyn Engine,
    chunks: &Chunks,
    missing: &[Chunk],
    store: &dyn Store,
    jobs: Option<usize>,
    watch: Watch<'_>,
) -> Result<Ended, RunError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.unwrap_or(0))
        .build()?;
    let failed = AtomicBool::new(false);
    let go_on = || (watch.go_on)() && !failed.load(Ordering::Relaxed);
    let inner = Watch {
        go_on: &go_on,
        done: watch.done,
    };
    let one = |chunk: &Chunk| -> Result<Ended, RunError> {
        if !go_on() {
            return Ok(Ended::Stopped);
        }
        let room = usize::try_from(chunk.cases.end - chunk.cases.start).unwrap_or(0);
        let mut rows = Rows::new(chunk.cases.start, engine.columns().len(), room);
        engine.run(chunk.cases.clone(), &inner, &mut rows);
        if rows.len() < room {
            return Ok(Ended::Stopped);
        }
        let written = table_file::written(&rows, engine.columns(), &chunks.study)
            .map_err(|cause| StoreError::new(&chunk.name, cause))
            .and_then(|bytes| store.write(&chunk.name, bytes));
        if written.is_err() {
            failed.store(true, Ordering::Relaxed);
        }
        written?;
        Ok(Ended::Done)
    };
    // Chunks are started in order, on any thread.
    let next = std::sync::atomic::AtomicUsize::new(0);
    let workers: Vec<usize> = (0..pool.current_num_threads()).collect();
    let ends: Vec<Result<Ended, RunError>> = pool.install(|| {
        let work = |_: &usize| {
            let mut all = Ended::Done;
            while let Some(chunk) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                if one(chunk)? == Ended::Stopped {
                    all = Ended::Stopped;
                }
            }
            Ok(all)
        };
        workers.par_iter().map(work).collect()
    });
    let mut all = Ended::Done;
    for end in ends {
        if end? == Ended::Stopped {
            all = Ended::Stopped;
        }
    }
    Ok(all)
}

/// Shows the rows of all cases once, in the order of the cases; `there` are chunks of any size, by their first case. A
/// damaged chunk is an error where no others have its cases.
pub fn scan(
    store: &dyn Store,
    chunks: &Chunks,
    there: &[Chunk],
    columns: &[Column],
    wanted: &dyn Fn(usize) -> bool,
    see: &mut dyn FnMut(&Rows),
) -> Result<(), StoreError> {
    let mut next = 0;
    // Cases before this one are in a damaged chunk.
    let mut lost: Option<(u64, StoreError)> = None;
    for chunk in there {
        if chunk.cases.end.min(chunks.cases) <= next {
            continue;
        }
        if let Some((until, error)) = lost.take_if(|_| chunk.cases.start > next)
            && next < until
        {
            return Err(error);
        }
        let bytes = store.read(&chunk.name)?;
        match table_file::read(bytes, columns, chunks, chunk, wanted) {
            Ok(mut rows) => {
                // The same cases in another chunk have the same rows.
                rows.keep(next..chunks.cases);
                next = chunk.cases.end.min(chunks.cases);
                see(&rows);
            }
            Err(cause) => {
                let until = lost.as_ref().map_or(0, |(until, _)| *until);
                let cause =
                    format!("the chunk is damaged: {cause}; the same command computes it again");
                let error = StoreError::new(&chunk.name, cause);
                lost = Some((until.max(chunk.cases.end.min(chunks.cases)), error));
            }
        }
    }
    match lost {
        Some((until, error)) if next < until => Err(error),
        _ => Ok(()),
    }
}
