//! The protocol: messages of the editor in, answers and findings out.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use appell_spec::shown;
use crossbeam_channel::{Sender, never, select};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{
    DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument, Exit, LogMessage,
    Notification as Told, PublishDiagnostics,
};
use lsp_types::request::{
    Completion, GotoDefinition, HoverRequest, Initialize, PrepareRenameRequest, References, Rename,
    Request as Asked, Shutdown,
};
use lsp_types::{
    Diagnostic, LogMessageParams, MessageType, Position, PublishDiagnosticsParams, ReferenceParams,
    RenameParams, TextDocumentPositionParams, TextDocumentSyncKind, Uri,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, from_value, json};

use crate::document::Document;
use crate::text::Text;
use crate::worker::{self, Job, What};
use crate::{completion, diagnostics, hover, names};

/// Code for a valid request that fails (LSP 3.17).
const REQUEST_FAILED: i32 = -32803;

/// The capabilities of the server.
fn capabilities() -> Value {
    json!({
        "textDocumentSync": TextDocumentSyncKind::INCREMENTAL,
        "hoverProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        "completionProvider": { "triggerCharacters": ["\"", "'", "(", "["] },
    })
}

/// The phase of the protocol.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Before `initialize`.
    New,
    Serving,
    /// After `shutdown`.
    Closing,
}

/// Serves an editor until it disconnects. Messages out of order are refused.
pub fn serve(connection: &Connection) -> std::io::Result<()> {
    let (jobs, mut told) = worker::start()?;
    let mut server = Server {
        messages: connection.sender.clone(),
        jobs,
        documents: BTreeMap::new(),
        revision: 0,
        phase: Phase::New,
    };
    loop {
        select! {
            recv(connection.receiver) -> message => match message {
                Ok(Message::Request(request)) => server.request(request),
                Ok(Message::Notification(told)) if told.method == Exit::METHOD => return Ok(()),
                Ok(Message::Notification(told)) if server.phase == Phase::Serving => server.notification(told),
                Ok(Message::Notification(_) | Message::Response(_)) => {}
                Err(_) => return Ok(()),
            },
            recv(told) -> answer => match answer {
                Ok(answer) => server.learn(answer),
                Err(_) => told = never(),
            },
        }
    }
}

/// The protocol's error code, and the reason.
type Refusal = (i32, String);

fn refused(code: ErrorCode, reason: &impl ToString) -> Refusal {
    (code as i32, reason.to_string())
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, Refusal> {
    from_value(params).map_err(|error| refused(ErrorCode::InvalidParams, &error))
}

fn written(result: impl Serialize) -> Result<Value, Refusal> {
    let result = serde_json::to_value(result);
    result.map_err(|error| refused(ErrorCode::InternalError, &error))
}

struct Server {
    messages: Sender<Message>,
    jobs: Sender<Job>,
    /// By their URIs.
    documents: BTreeMap<String, Document>,
    /// Of the newest text; editors restart their version numbers when they reopen a file.
    revision: u64,
    phase: Phase,
}

impl Server {
    fn request(&mut self, request: Request) {
        let Request { id, method, params } = request;
        let answer = catch_unwind(AssertUnwindSafe(|| self.in_turn(&method, params)));
        let answer = answer.unwrap_or_else(|_| {
            let reason = "a mistake in the language server";
            Err(refused(ErrorCode::InternalError, &reason))
        });
        let answer = match answer {
            Ok(result) => Response::new_ok(id, result),
            Err((code, reason)) => Response::new_err(id, code, reason),
        };
        // An editor that has disconnected needs no answer.
        let _ = self.messages.send(answer.into());
    }

    /// The answer to a request in the present phase of the protocol.
    fn in_turn(&mut self, method: &str, params: Value) -> Result<Value, Refusal> {
        match (self.phase, method) {
            (Phase::New, Initialize::METHOD) => {
                self.phase = Phase::Serving;
                Ok(json!({ "capabilities": capabilities() }))
            }
            (Phase::New, _) => {
                let reason = "`initialize` comes first";
                Err(refused(ErrorCode::ServerNotInitialized, &reason))
            }
            (Phase::Serving, Shutdown::METHOD) => {
                self.phase = Phase::Closing;
                Ok(Value::Null)
            }
            (Phase::Closing, _) | (Phase::Serving, Initialize::METHOD) => {
                let reason = format!("`{}` is not possible any more", shown(method));
                Err(refused(ErrorCode::InvalidRequest, &reason))
            }
            (Phase::Serving, _) => self.answer(method, params),
        }
    }

    /// The answer to a request at a position; nothing if no spec is open.
    fn answer(&self, method: &str, params: Value) -> Result<Value, Refusal> {
        let answer: fn(&Document, Position, Value) -> Result<Value, Refusal> = match method {
            HoverRequest::METHOD => |document, at, _| written(hover::hover(document, at)),
            GotoDefinition::METHOD => |document, at, _| written(names::definition(document, at)),
            References::METHOD => |document, at, params| {
                let context = read::<ReferenceParams>(params)?.context;
                written(names::references(document, at, context.include_declaration))
            },
            PrepareRenameRequest::METHOD => |document, at, _| written(names::prepare(document, at)),
            Rename::METHOD => |document, at, params| {
                let new = read::<RenameParams>(params)?.new_name;
                let edit = names::renamed(document, at, &new);
                written(edit.map_err(|reason| (REQUEST_FAILED, reason.to_string()))?)
            },
            Completion::METHOD => |document, at, _| written(completion::completion(document, at)),
            _ => {
                let reason = format!("no method `{}`", shown(method));
                return Err(refused(ErrorCode::MethodNotFound, &reason));
            }
        };
        let at: TextDocumentPositionParams = read(params.clone())?;
        let document = self.documents.get(at.text_document.uri.as_str());
        let document = document.filter(|document| document.is_spec());
        document.map_or(Ok(Value::Null), |document| {
            answer(document, at.position, params)
        })
    }

    fn notification(&mut self, notification: Notification) {
        let seen = catch_unwind(AssertUnwindSafe(|| self.see(notification)));
        if matches!(seen, Err(_) | Ok(Err(_))) {
            self.log("a message of the editor could not be followed");
        }
    }

    fn see(&mut self, notification: Notification) -> Result<(), serde_json::Error> {
        let Notification { method, params } = notification;
        match method.as_str() {
            DidOpenTextDocument::METHOD => {
                let opened: lsp_types::DidOpenTextDocumentParams = from_value(params)?;
                let opened = opened.text_document;
                self.open(opened.uri, opened.version, Text::new(opened.text));
            }
            DidChangeTextDocument::METHOD => {
                let changed: lsp_types::DidChangeTextDocumentParams = from_value(params)?;
                let document = changed.text_document;
                if let Some(known) = self.documents.get(document.uri.as_str()) {
                    let changes = changed.content_changes.into_iter();
                    let text =
                        changes.fold(known.text.clone(), |text, change| text.changed(change));
                    self.open(document.uri, document.version, text);
                }
            }
            DidCloseTextDocument::METHOD => {
                let closed: lsp_types::DidCloseTextDocumentParams = from_value(params)?;
                let uri = closed.text_document.uri;
                self.documents.remove(uri.as_str());
                self.publish(uri, None, Vec::new());
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes a new text: publishes the findings of the parser and requests the derivation.
    fn open(&mut self, uri: Uri, version: i32, text: Text) {
        self.revision += 1;
        let mut document = Document::new(uri.clone(), version, self.revision, text);
        let key = uri.as_str().to_owned();
        let is_valid = document.is_spec() && document.reading.is_valid();
        if !is_valid && let Some(before) = self.documents.remove(&key) {
            // The contributions of the newest valid text.
            document.contributions = before.contributions;
        }
        let findings = if document.is_spec() {
            diagnostics::shown(&document, &document.reading.findings)
        } else {
            Vec::new()
        };
        if is_valid {
            // Without the worker only the findings of the parser appear.
            let _ = self.jobs.send(Job {
                uri: key.clone(),
                revision: self.revision,
                text: document.text.as_str().to_owned(),
            });
        }
        self.documents.insert(key, document);
        self.publish(uri, Some(version), findings);
    }

    /// Takes a result of the derivation, if it belongs to the newest text.
    fn learn(&mut self, told: worker::Told) {
        let Some(document) = self.documents.get_mut(&told.uri) else {
            return;
        };
        if document.revision != told.revision {
            return;
        }
        match told.what {
            What::Findings(findings) => {
                let findings = diagnostics::shown(document, &findings);
                let (uri, version) = (document.uri.clone(), document.version);
                self.publish(uri, Some(version), findings);
            }
            What::Equations(contributions) => document.contributions = Some(contributions),
            What::Panicked => self.log("a mistake in the derivation; its findings are missing"),
        }
    }

    fn publish(&self, uri: Uri, version: Option<i32>, diagnostics: Vec<Diagnostic>) {
        self.tell::<PublishDiagnostics>(PublishDiagnosticsParams {
            uri,
            diagnostics,
            version,
        });
    }

    fn log(&self, message: &str) {
        self.tell::<LogMessage>(LogMessageParams {
            typ: MessageType::ERROR,
            message: message.to_owned(),
        });
    }

    fn tell<N: Told>(&self, params: N::Params) {
        let notification = Notification::new(N::METHOD.to_owned(), params);
        // Sending fails only if the editor has disconnected.
        let _ = self.messages.send(notification.into());
    }
}
