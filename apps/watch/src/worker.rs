//! Computes the parts of the page from each saved text. Only the newest text is processed, and each part is
//! published as soon as it is ready.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use appell::{Diagnostic, Model, Severity, Source};
use appell_codegen::{Derived, derived};
use appell_report::derivation::{self, Page, Stage};
use appell_report::drawing::drawing;
use appell_report::film::FilmMaker;
use appell_runtime::model::At;
use appell_spec::diagnostic::MAX_SHOWN;
use appell_spec::visible;
use serde_json::{Value, json};

use crate::board::{Board, Good, Part};
use crate::file::Text;
use crate::knobs::knobs;
use crate::places::Places;

/// Stack size, that of the command line's main thread.
const STACK: usize = 8 << 20;

/// Sender of texts and requests to the worker.
#[derive(Clone)]
pub(crate) struct Inbox(Sender<Message>);

enum Message {
    Text(Text),
    /// Request for the whole derivation of the last valid text.
    Derivation,
}

impl Inbox {
    /// Sends a text; false if the worker has ended.
    pub(crate) fn put(&self, text: Text) -> bool {
        self.0.send(Message::Text(text)).is_ok()
    }

    /// Requests the derivation, which becomes a part of the board.
    pub(crate) fn want_derivation(&self) {
        // Sending fails only if the worker thread has ended.
        let _ = self.0.send(Message::Derivation);
    }
}

/// Starts the thread.
pub(crate) fn start(spec: &Path, board: &Arc<Board>) -> std::io::Result<Inbox> {
    let name = spec.file_name().unwrap_or(spec.as_os_str());
    let file = name.to_string_lossy().into_owned();
    let board = Arc::clone(board);
    let (send, messages) = channel();
    let work = move || work(&file, &messages, &board);
    thread::Builder::new()
        .name("derivation".to_owned())
        .stack_size(STACK)
        .spawn(work)?;
    Ok(Inbox(send))
}

fn work(file: &str, messages: &Receiver<Message>, board: &Board) {
    let mut version = 0;
    // The last valid text, until its derivation has been written.
    let mut unread = None;
    while let Ok(first) = messages.recv() {
        let mut newest = None;
        let mut wanted = false;
        for message in std::iter::once(first).chain(messages.try_iter()) {
            match message {
                Message::Text(text) => {
                    version += 1;
                    newest = Some(text);
                }
                Message::Derivation => wanted = true,
            }
        }
        if let Some(text) = newest {
            let job = Job {
                file,
                version,
                board,
            };
            let derived = job.guarded(|| job.show(&text)).flatten();
            unread = derived.map(|derived| (job, derived)).or(unread);
        }
        if wanted && let Some((job, derived)) = unread.take() {
            job.guarded(|| job.derivation(derived));
        }
    }
}

/// One version of the text.
struct Job<'a> {
    file: &'a str,
    version: u64,
    board: &'a Board,
}

impl Job<'_> {
    fn write(&self, part: Part, mut value: Value) {
        value["version"] = json!(self.version);
        self.board.write(part, &value);
    }

    /// A finding without a position in the text.
    fn refuse(&self, message: &str) {
        let finding = json!({ "severity": "error", "message": message, "places": [] });
        self.write(Part::Findings, json!({ "broken": true, "list": [finding] }));
    }

    /// A panic in the derivation ends neither the thread nor the page.
    fn guarded<R>(&self, work: impl FnOnce() -> R) -> Option<R> {
        let done = catch_unwind(AssertUnwindSafe(work));
        if done.is_err() {
            self.refuse("a mistake in appell: this text cannot be derived");
        }
        done.ok()
    }

    /// Shows a text, or why there is none; returns its derivation if there is one.
    fn show(&self, text: &Text) -> Option<Derived> {
        let text = match text {
            Ok(text) => text,
            Err(reason) => {
                self.refuse(reason);
                return None;
            }
        };
        let items = Places::new(text).items();
        let shown = json!({ "file": self.file, "text": text, "items": items });
        self.write(Part::Text, shown);
        match derived(self.file, text) {
            Ok(derived) => Some(self.show_derived(text, derived)),
            Err(report) => {
                self.findings(text, report.diagnostics(), true);
                None
            }
        }
    }

    /// Compiles the model on this thread and writes the equations on another; the slower audit follows.
    fn show_derived(&self, text: &str, derived: Derived) -> Derived {
        self.findings(text, &derived.warnings, false);
        let mut copy = derived.clone();
        thread::scope(|scope| {
            let reading = thread::Builder::new().stack_size(STACK);
            let read = || self.read(&mut copy);
            let beside = reading.spawn_scoped(scope, read).is_ok();
            self.model(text, derived);
            if !beside {
                self.refuse("no thread can be started for the equations");
            }
        });
        self.audit(text, &mut copy);
        copy
    }

    fn findings(&self, text: &str, findings: &[Diagnostic], broken: bool) {
        let places = Places::new(text);
        let first = findings.iter().take(MAX_SHOWN);
        let list: Vec<Value> = first.map(|finding| shown(&places, finding)).collect();
        self.write(Part::Findings, json!({ "broken": broken, "list": list }));
    }

    fn read(&self, derived: &mut Derived) {
        let (mechanism, derivation) = (&derived.mechanism, &mut derived.derivation);
        let motion = derivation::equations_of_motion(mechanism, derivation);
        self.sections(Part::Equations, motion, derived);
        if let Ok(svg) = drawing(&derived.mechanism, derived.derivation.clone()) {
            self.write(Part::Drawing, json!({ "svg": svg }));
        }
    }

    /// The complete derivation, from the frames to the energies.
    fn derivation(&self, mut derived: Derived) {
        let (mechanism, derivation) = (&derived.mechanism, &mut derived.derivation);
        if let Ok(page) = derivation::page(mechanism, derivation, Stage::Equations) {
            self.sections(Part::Derivation, page, &mut derived);
        }
    }

    fn sections(&self, part: Part, mut page: Page, derived: &mut Derived) {
        derivation::locate(&mut page, &derived.mechanism, &mut derived.derivation);
        let sections: Vec<String> = page.sections.iter().map(derivation::clickable).collect();
        self.write(part, json!({ "sections": sections }));
    }

    fn model(&self, text: &str, derived: Derived) {
        let source = Source::of(self.file, text);
        let films = FilmMaker::new(&derived.mechanism).map_err(|findings| {
            let messages = findings.iter().map(|finding| finding.message.as_str());
            messages.collect::<Vec<_>>().join("; ")
        });
        let model = Model::of_derivation(source, derived).map_err(|error| error.to_string());
        match films.and_then(|films| Ok((films, model?))) {
            Ok((films, model)) => {
                let knobs = knobs(model.info());
                let shown =
                    json!({ "title": model.info().title, "note": model.note(), "knobs": knobs });
                let model = Arc::new(model);
                self.board.keep(Good {
                    version: self.version,
                    model: Arc::clone(&model),
                    films: Arc::new(films),
                });
                self.write(Part::Model, shown);
                prepare(&model);
            }
            Err(reason) => self.refuse(&reason),
        }
    }

    fn audit(&self, text: &str, derived: &mut Derived) {
        let told = derived.warnings.len();
        derived.audit(text);
        if derived.warnings.len() > told {
            self.findings(text, &derived.warnings, false);
        }
    }
}

/// Compiles the functions used last in a simulation while it runs with those used first.
fn prepare(model: &Model) {
    let (equations, info) = (model.equations(), model.info());
    let at = At {
        t: 0.0,
        x: &info.initial_state(),
        u: &vec![0.0; info.input_len()],
        p: &info.default_parameters(),
    };
    equations.energies(at);
    equations.outputs(at, &mut vec![0.0; info.output_len()]);
    equations.constraint_forces(at, &mut vec![0.0; 3 * info.reactions.len()]);
}

fn shown(places: &Places<'_>, finding: &Diagnostic) -> Value {
    let labels = finding.labels.iter();
    let labels =
        labels.map(|(span, words)| json!({ "at": places.range(span), "words": visible(words) }));
    json!({
        "severity": match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        },
        "code": finding.code.text(),
        "message": visible(&finding.message),
        "help": finding.help.as_deref().map(visible),
        "places": labels.collect::<Vec<_>>(),
    })
}
