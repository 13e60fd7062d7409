//! Parallel execution of independent tasks.

use std::cell::Cell;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::{panic, thread};

thread_local! {
    /// Whether this thread is a worker already: nested calls then run on this thread.
    static IS_WORKER: Cell<bool> = const { Cell::new(false) };
}

/// The results of `work` for the items, in their order. Of nested calls only the outermost is run in parallel.
pub fn in_parallel<I, T: Send>(
    items: impl IntoIterator<Item = I, IntoIter: ExactSizeIterator + Send>,
    work: impl Fn(I) -> T + Sync,
) -> Vec<T> {
    let items = items.into_iter();
    let count = items.len();
    let threads = if IS_WORKER.get() {
        1
    } else {
        processors().min(count)
    };
    if threads < 2 {
        return items.map(work).collect();
    }
    let queue = Mutex::new(items.enumerate());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let share = || {
        IS_WORKER.set(true);
        let mut done = Vec::new();
        while let Some((place, item)) = next() {
            done.push((place, work(item)));
        }
        IS_WORKER.set(false);
        done
    };
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(share)).collect();
        let mut done = share();
        for other in others {
            match other.join() {
                Ok(own) => done.extend(own),
                Err(reason) => panic::resume_unwind(reason),
            }
        }
        done
    });
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Number of processors, determined once.
fn processors() -> usize {
    static PROCESSORS: OnceLock<usize> = OnceLock::new();
    *PROCESSORS.get_or_init(|| thread::available_parallelism().map_or(1, usize::from))
}

#[cfg(test)]
mod tests {
    use super::in_parallel;

    #[test]
    fn results_keep_the_order_of_the_items() {
        let squares = in_parallel(0..100_u32, |i| {
            // The first pieces take longest.
            let slow = (0..(100 - i) * 1000).fold(i, u32::wrapping_add);
            let inner = in_parallel(0..3_u32, |j| j * i);
            (i * i, slow, inner)
        });
        for (i, (square, _, inner)) in (0..).zip(squares) {
            assert_eq!((square, inner), (i * i, vec![0, i, 2 * i]));
        }
    }
}
