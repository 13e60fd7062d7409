//! The derivation on a thread of its own; only the newest text of a document is processed.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

use appell_codegen::audited;
use appell_spec::Diagnostic;
use crossbeam_channel::{Receiver, Sender, unbounded};

use crate::equations::{Contributions, contributions};

/// Stack size, that of the command line's main thread.
const STACK: usize = 8 << 20;

/// A valid text whose equations are requested.
pub(crate) struct Job {
    pub(crate) uri: String,
    pub(crate) revision: u64,
    pub(crate) text: String,
}

/// A result of the derivation of a text.
pub(crate) struct Told {
    pub(crate) uri: String,
    pub(crate) revision: u64,
    pub(crate) what: What,
}

pub(crate) enum What {
    /// All findings of `check`.
    Findings(Vec<Diagnostic>),
    /// The equations of each item.
    Equations(Contributions),
    /// The derivation has panicked.
    Panicked,
}

/// Starts the thread, which ends when all senders of jobs are dropped.
pub(crate) fn start() -> std::io::Result<(Sender<Job>, Receiver<Told>)> {
    let (jobs, wanted) = unbounded();
    let (tell, told) = unbounded();
    let work = move || work(&wanted, &tell, derive);
    thread::Builder::new().stack_size(STACK).spawn(work)?;
    Ok((jobs, told))
}

fn work(wanted: &Receiver<Job>, tell: &Sender<Told>, derive: impl Fn(&Job, &dyn Fn(What))) {
    let mut waiting: BTreeMap<String, Job> = BTreeMap::new();
    loop {
        let next = if waiting.is_empty() {
            wanted.recv().ok()
        } else {
            wanted.try_recv().ok()
        };
        if let Some(job) = next {
            waiting.insert(job.uri.clone(), job);
            continue;
        }
        let Some((uri, job)) = waiting.pop_first() else {
            return;
        };
        let tell = |what| {
            let (uri, revision) = (uri.clone(), job.revision);
            // Sending fails only while the server ends.
            let _ = tell.send(Told {
                uri,
                revision,
                what,
            });
        };
        if catch_unwind(AssertUnwindSafe(|| derive(&job, &tell))).is_err() {
            tell(What::Panicked);
        }
    }
}

fn derive(job: &Job, tell: &dyn Fn(What)) {
    match audited(&job.uri, &job.text) {
        Ok(mut derived) => {
            tell(What::Findings(std::mem::take(&mut derived.warnings)));
            tell(What::Equations(contributions(
                &derived.mechanism,
                derived.derivation,
            )));
        }
        Err(report) => tell(What::Findings(report.diagnostics().to_vec())),
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn job(uri: &str, revision: u64) -> Job {
        Job {
            uri: uri.to_owned(),
            revision,
            text: String::new(),
        }
    }

    /// Reported revisions, for jobs that are all queued at the start.
    fn told(jobs: Vec<Job>, derive: impl Fn(&Job, &dyn Fn(What))) -> Vec<(u64, bool)> {
        let (send, wanted) = unbounded();
        let (tell, told) = unbounded();
        for job in jobs {
            send.send(job).unwrap();
        }
        drop(send);
        work(&wanted, &tell, derive);
        drop(tell);
        let told = told.into_iter();
        told.map(|told| (told.revision, matches!(told.what, What::Panicked)))
            .collect()
    }

    #[test]
    fn the_newest_text_of_each_document_is_derived() {
        let jobs = vec![job("a", 1), job("b", 2), job("a", 3), job("a", 4)];
        let derive = |_: &Job, tell: &dyn Fn(What)| tell(What::Findings(Vec::new()));
        assert_eq!(told(jobs, derive), [(4, false), (2, false)]);
    }

    #[test]
    fn a_panic_is_told_and_the_next_document_is_derived() {
        let derive = |job: &Job, tell: &dyn Fn(What)| {
            assert!(job.uri != "a", "a mistake for this test");
            tell(What::Findings(Vec::new()));
        };
        assert_eq!(
            told(vec![job("a", 1), job("b", 2)], derive),
            [(1, true), (2, false)]
        );
    }
}
