//! Simulations with the values of the sliders. Only the newest request of each window is answered, within
//! limits on time and steps.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use appell::setup::Assignment;
use appell::{IntegrationOptions, Motion, Simulated};
use appell_report::figure::Figure;
use appell_report::film;
use appell_runtime::trajectory::Extras;
use appell_spec::visible;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::oneshot;

use crate::board::Board;

/// Longest simulated time, in s.
const LONGEST: f64 = 600.0;
/// Frames of an animation.
const ROWS: f64 = 400.0;
/// Limit on integrator steps, rejected ones included.
const MOST_STEPS: usize = 50_000;
/// Limit on computing time.
const PATIENCE: Duration = Duration::from_secs(2);
/// Limit on windows with a pending request.
const MOST_WINDOWS: usize = 16;
/// Limit on values in a request.
const MOST_VALUES: usize = 1000;
/// Stack size, that of the command line's main thread.
const STACK: usize = 8 << 20;

/// A request of a window; values are texts, as on the command line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    /// Identifier chosen by the window.
    window: u64,
    /// End time of the simulation in s.
    end: f64,
    #[serde(default)]
    parameters: BTreeMap<String, String>,
    #[serde(default)]
    initial: BTreeMap<String, String>,
    #[serde(default)]
    inputs: BTreeMap<String, String>,
}

/// Why there is no simulation.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// Too many windows have a pending request.
    Busy,
    /// The request is invalid, or the simulation failed.
    Wrong(String),
}

type Answer = Result<Value, Refusal>;

struct Job {
    request: Request,
    /// Dropped when a newer request arrives.
    answer: oneshot::Sender<Answer>,
}

/// Pending requests, by window.
pub(crate) struct Motions {
    waiting: Mutex<BTreeMap<u64, Job>>,
    come: Condvar,
}

impl Motions {
    /// Starts the worker thread.
    pub(crate) fn start(board: &Arc<Board>) -> std::io::Result<Arc<Self>> {
        let motions = Arc::new(Self {
            waiting: Mutex::default(),
            come: Condvar::new(),
        });
        let (own, board) = (Arc::clone(&motions), Arc::clone(board));
        thread::Builder::new()
            .name("motions".to_owned())
            .stack_size(STACK)
            .spawn(move || own.work(&board))?;
        Ok(motions)
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<u64, Job>> {
        // Each change is complete, even if the writer has panicked since.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Queues a request in exchange for an older one of the same window, which gets no answer.
    pub(crate) fn ask(&self, request: Request) -> Result<oneshot::Receiver<Answer>, Refusal> {
        let (answer, answered) = oneshot::channel();
        let mut waiting = self.lock();
        if waiting.len() >= MOST_WINDOWS && !waiting.contains_key(&request.window) {
            return Err(Refusal::Busy);
        }
        waiting.insert(request.window, Job { request, answer });
        drop(waiting);
        self.come.notify_one();
        Ok(answered)
    }

    fn work(&self, board: &Board) {
        loop {
            let mut waiting = self.lock();
            let (window, Job { request, answer }) = loop {
                if let Some(job) = waiting.pop_first() {
                    break job;
                }
                let woken = self.come.wait(waiting);
                waiting = woken.unwrap_or_else(PoisonError::into_inner);
            };
            drop(waiting);
            let start = Instant::now();
            let is_wanted = || !answer.is_closed() && !self.lock().contains_key(&window);
            let go_on = || start.elapsed() < PATIENCE && is_wanted();
            let moved = catch_unwind(AssertUnwindSafe(|| motion(board, &request, go_on)));
            let moved = moved.unwrap_or_else(|_| {
                let reason = "a mistake in appell: this motion cannot be computed";
                Err(Refusal::Wrong(reason.to_owned()))
            });
            if is_wanted() {
                // Sending fails if the window was closed.
                let _ = answer.send(moved);
            }
        }
    }
}

fn motion(board: &Board, request: &Request, go_on: impl Fn() -> bool) -> Answer {
    let good = board.good();
    let good = good.ok_or_else(|| Refusal::Wrong("there is no model yet".to_owned()))?;
    let wrong = |error: appell::Error| Refusal::Wrong(line(&error));
    let motion = request.motion()?;
    let start = Instant::now();
    let Simulated {
        trajectory,
        failure,
        undefined,
        ..
    } = good.model.simulate_while(&motion, go_on).map_err(wrong)?;
    let seconds = start.elapsed().as_secs_f64();
    let film = film::data(
        &good.films,
        good.model.equations(),
        &trajectory,
        failure.as_deref(),
    );
    let figure = Figure::of_states_and_inputs(&trajectory).to_svg();
    Ok(json!({
        "version": good.version,
        "seconds": seconds,
        "ending": failure.or(undefined),
        "figure": figure,
        "film": film,
    }))
}

/// An error on one line, without the source excerpt: the page has a field of that name.
fn line(error: &appell::Error) -> String {
    match error {
        appell::Error::Expression(error) => {
            let diagnostics = error.diagnostics.iter().map(|diagnostic| {
                let help = diagnostic.help.iter().map(|help| format!(" ({help})"));
                visible(&diagnostic.message).into_owned() + &help.collect::<String>()
            });
            let told: Vec<String> = diagnostics.collect();
            format!("{} = {}: {}", error.name, error.text, told.join("; "))
        }
        appell::Error::Several(all) => {
            let lines = all.iter().map(line);
            lines.collect::<Vec<String>>().join("; ")
        }
        other => {
            let text = other.to_string();
            let words: Vec<&str> = text.split_whitespace().collect();
            words.join(" ")
        }
    }
}

impl Request {
    fn motion(&self) -> Result<Motion, Refusal> {
        if !(self.end > 0.0 && self.end <= LONGEST) {
            let message = format!("a motion ends after 0 s and not after {LONGEST} s");
            return Err(Refusal::Wrong(message));
        }
        let count = self.parameters.len() + self.initial.len() + self.inputs.len();
        if count > MOST_VALUES {
            return Err(Refusal::Wrong(format!("more than {MOST_VALUES} values")));
        }
        let whole = Motion::new(self.end);
        Ok(Motion {
            interval: Some(self.end / ROWS),
            extras: Extras {
                reactions: true,
                ..whole.extras
            },
            options: IntegrationOptions {
                max_steps: MOST_STEPS,
                ..whole.options
            },
            parameters: assignments(&self.parameters),
            initial: assignments(&self.initial),
            inputs: assignments(&self.inputs),
            ..whole
        })
    }
}

fn assignments(values: &BTreeMap<String, String>) -> Vec<Assignment> {
    let values = values.iter();
    values
        .map(|(name, value)| Assignment::new(name, value))
        .collect()
}
