//! From each saved text to what the page shows of it. The newest text wins, and each part is told as
//! soon as it is ready.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use appell::{Diagnostic, Model, Severity, Source};
use appell_codegen::{Derived, derived};
use appell_report::derivation::{self, Stage};
use appell_report::drawing::drawing;
use appell_spec::diagnostic::MAX_SHOWN;
use serde_json::{Value, json};

use crate::board::{Board, Good, Part};
use crate::file::Text;
use crate::knobs::knobs;
use crate::places::Places;

/// As much as the command line has on its main thread.
const STACK: usize = 8 << 20;

/// Starts the thread; it ends when nobody sends texts any more.
pub(crate) fn start(spec: &Path, board: &Arc<Board>) -> std::io::Result<Sender<Text>> {
    let name = spec.file_name().unwrap_or(spec.as_os_str());
    let file = name.to_string_lossy().into_owned();
    let board = Arc::clone(board);
    let (send, texts) = channel();
    let work = move || work(&file, &texts, &board);
    thread::Builder::new()
        .name("derivation".to_owned())
        .stack_size(STACK)
        .spawn(work)?;
    Ok(send)
}

fn work(file: &str, texts: &Receiver<Text>, board: &Board) {
    let mut version = 0;
    while let Ok(first) = texts.recv() {
        let text = texts.try_iter().last().unwrap_or(first);
        version += 1;
        let job = Job {
            file,
            version,
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

    fn show_derived(&self, text: &str, derived: Derived) {
        self.findings(text, &derived.warnings, false);
        let (of_page, of_drawing) = (derived.clone(), derived.clone());
        thread::scope(|scope| {
            let reading = thread::Builder::new().stack_size(STACK);
            let read = || {
                self.equations(of_page);
                self.drawing(of_drawing);
            };
            // Without a second thread the model comes later.
            let beside = reading.spawn_scoped(scope, read).is_ok();
            let audited = derived.clone();
            if self.model(text, derived) {
                self.audit(text, audited);
            }
            if !beside {
                self.refuse("no thread can be started for the equations");
            }
        });
    }

    fn findings(&self, text: &str, findings: &[Diagnostic], broken: bool) {
        let places = Places::new(text);
        let first = findings.iter().take(MAX_SHOWN);
        let list: Vec<Value> = first.map(|finding| shown(&places, finding)).collect();
        self.write(Part::Findings, json!({ "broken": broken, "list": list }));
    }

    fn equations(&self, derived: Derived) {
        let Derived {
            mechanism,
            mut derivation,
            ..
        } = derived;
        let page = derivation::page(&mechanism, &mut derivation, Stage::Equations);
        let Ok(mut page) = page else { return };
        derivation::locate(&mut page, &mechanism, &mut derivation);
        let html = derivation::clickable(&page);
        self.write(Part::Equations, json!({ "html": html }));
    }

    fn drawing(&self, derived: Derived) {
        if let Ok(svg) = drawing(&derived.mechanism, derived.derivation) {
            self.write(Part::Drawing, json!({ "svg": svg }));
        }
    }

    /// Tells whether there is a model.
    fn model(&self, text: &str, derived: Derived) -> bool {
        let source = Source {
            file: self.file.to_owned(),
            text: text.to_owned(),
            shipped: None,
        };
        match Model::from_derived(source, derived) {
            Ok(model) => {
                let knobs = knobs(model.info());
                let shown =
                    json!({ "title": model.info().title, "note": model.note(), "knobs": knobs });
                self.board.keep(Good {
                    version: self.version,
                    model: Arc::new(model),
                });
                self.write(Part::Model, shown);
                true
            }
            Err(error) => {
                self.refuse(&error.to_string());
                false
            }
        }
    }

    /// The audit takes longer than its findings are worth waiting for.
    fn audit(&self, text: &str, mut derived: Derived) {
        let told = derived.warnings.len();
        derived.audit(text);
        if derived.warnings.len() > told {
            self.findings(text, &derived.warnings, false);
        }
    }
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
