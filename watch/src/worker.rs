//! From each saved text to what the page shows of it. The newest text wins, and each part is told as
//! soon as it is ready.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use appell::{Diagnostic, Model, Severity, Source};
use appell_codegen::{Derived, derived};
use appell_report::derivation::{self, Page, Stage};
use appell_report::drawing::drawing;
use appell_runtime::model::At;
use appell_spec::diagnostic::MAX_SHOWN;
use serde_json::{Value, json};

use crate::board::{Board, Good, Part};
use crate::file::Text;
use crate::knobs::knobs;
use crate::places::Places;

/// As much as the command line has on its main thread.
const STACK: usize = 8 << 20;

/// Where texts are put.
pub(crate) struct Inbox {
    texts: Sender<Text>,
    newest: Arc<AtomicU64>,
}

impl Inbox {
    /// Puts a text; false when nobody reads any more.
    pub(crate) fn put(&self, text: Text) -> bool {
        self.newest.fetch_add(1, Ordering::Relaxed);
        self.texts.send(text).is_ok()
    }
}

/// Starts the thread; it ends when nobody puts texts any more.
pub(crate) fn start(spec: &Path, board: &Arc<Board>) -> std::io::Result<Inbox> {
    let name = spec.file_name().unwrap_or(spec.as_os_str());
    let file = name.to_string_lossy().into_owned();
    let board = Arc::clone(board);
    let (send, texts) = channel();
    let inbox = Inbox {
        texts: send,
        newest: Arc::default(),
    };
    let newest = Arc::clone(&inbox.newest);
    let work = move || work(&file, &texts, &newest, &board);
    thread::Builder::new()
        .name("derivation".to_owned())
        .stack_size(STACK)
        .spawn(work)?;
    Ok(inbox)
}

fn work(file: &str, texts: &Receiver<Text>, newest: &AtomicU64, board: &Board) {
    let mut version = 0;
    while let Ok(first) = texts.recv() {
        version += 1;
        let mut text = first;
        for newer in texts.try_iter() {
            version += 1;
            text = newer;
        }
        let job = Job {
            file,
            version,
            newest,
            board,
        };
        let done = catch_unwind(AssertUnwindSafe(|| match &text {
            Ok(text) => job.show(text),
            Err(reason) => job.refuse(reason),
        }));
        if done.is_err() {
            job.refuse("a mistake in appell: this text cannot be derived");
        }
    }
}

/// One version of the text.
struct Job<'a> {
    file: &'a str,
    version: u64,
    /// The number of the newest text.
    newest: &'a AtomicU64,
    board: &'a Board,
}

impl Job<'_> {
    fn write(&self, part: Part, mut value: Value) {
        value["version"] = json!(self.version);
        self.board.write(part, &value);
    }

    /// A finding without a place in the text.
    fn refuse(&self, message: &str) {
        let finding = json!({ "severity": "error", "message": message, "places": [] });
        self.write(Part::Findings, json!({ "broken": true, "list": [finding] }));
    }

    fn show(&self, text: &str) {
        let items = Places::new(text).items();
        let shown = json!({ "file": self.file, "text": text, "items": items });
        self.write(Part::Text, shown);
        match derived(self.file, text) {
            Ok(derived) => self.show_derived(text, derived),
            Err(report) => self.findings(text, report.diagnostics(), true),
        }
    }

    /// The model on this thread, what is there to read on another; then what takes longer than the rest is
    /// worth waiting for.
    fn show_derived(&self, text: &str, derived: Derived) {
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
        // Whoever has saved again does not wait.
        if self.newest.load(Ordering::Relaxed) == self.version {
            self.derivation(&mut copy);
        }
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

    fn derivation(&self, derived: &mut Derived) {
        let (mechanism, derivation) = (&derived.mechanism, &mut derived.derivation);
        if let Ok(page) = derivation::page(mechanism, derivation, Stage::Equations) {
            self.sections(Part::Derivation, page, derived);
        }
    }

    fn sections(&self, part: Part, mut page: Page, derived: &mut Derived) {
        derivation::locate(&mut page, &derived.mechanism, &mut derived.derivation);
        let sections: Vec<String> = page.sections.iter().map(derivation::clickable).collect();
        self.write(part, json!({ "sections": sections }));
    }

    fn model(&self, text: &str, derived: Derived) {
        let source = Source {
            file: self.file.to_owned(),
            text: text.to_owned(),
            shipped: None,
        };
        match Model::of_motions(source, derived) {
            Ok(model) => {
                let knobs = knobs(model.info());
                let shown =
                    json!({ "title": model.info().title, "note": model.note(), "knobs": knobs });
                let model = Arc::new(model);
                self.board.keep(Good {
                    version: self.version,
                    model: Arc::clone(&model),
                });
                self.write(Part::Model, shown);
                prepare(&model);
            }
            Err(error) => self.refuse(&error.to_string()),
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

/// Has those functions compiled that a motion uses last, while it computes with those that it uses first.
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
}

fn shown(places: &Places<'_>, finding: &Diagnostic) -> Value {
    let labels = finding.labels.iter();
    let labels = labels.map(|(span, words)| json!({ "at": places.range(span), "words": words }));
    json!({
        "severity": match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        },
        "code": finding.code.text(),
        "message": finding.message,
        "help": finding.help,
        "places": labels.collect::<Vec<_>>(),
    })
}
