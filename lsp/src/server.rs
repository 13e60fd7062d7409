//! The protocol: messages of the editor in, answers and findings out.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crossbeam_channel::{Sender, never, select};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::{
    DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument, LogMessage,
    Notification as _, PublishDiagnostics,
};
use lsp_types::request::{
    Completion, GotoDefinition, HoverRequest, PrepareRenameRequest, References, Rename,
    Request as _,
};
use lsp_types::{
    CompletionOptions, CompletionResponse, Diagnostic, HoverProviderCapability, LogMessageParams,
    MessageType, OneOf, PublishDiagnosticsParams, RenameOptions, ServerCapabilities,
    TextDocumentPositionParams, TextDocumentSyncCapability, TextDocumentSyncKind, Uri,
    WorkDoneProgressOptions,
};

use crate::document::Document;
use crate::text::Text;
use crate::worker::{self, Job, Told, What};
use crate::{Error, completion, diagnostics, hover, names};

/// An answer that is an error by intent, of the protocol's version 3.17.
const REQUEST_FAILED: i32 = -32803;

fn capabilities() -> ServerCapabilities {
    ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Kind(
            TextDocumentSyncKind::INCREMENTAL,
        )),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        })),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(["\"", "'", "(", "["].map(str::to_owned).into()),
            ..CompletionOptions::default()
        }),
        ..ServerCapabilities::default()
    }
}

/// Serves an editor until it leaves.
pub fn serve(connection: &Connection) -> Result<(), Error> {
    connection.initialize(serde_json::to_value(capabilities())?)?;
    let (jobs, mut told) = worker::start()?;
    let mut server = Server {
        messages: connection.sender.clone(),
        jobs,
        documents: BTreeMap::new(),
        revision: 0,
    };
    loop {
        select! {
            recv(connection.receiver) -> message => match message {
                Ok(Message::Request(request)) => {
                    if connection.handle_shutdown(&request)? {
                        return Ok(());
                    }
                    server.request(request);
                }
                Ok(Message::Notification(notification)) => server.notification(notification),
                Ok(Message::Response(_)) => {}
                Err(_) => return Ok(()),
            },
            recv(told) -> answer => match answer {
                Ok(answer) => server.learn(answer),
                Err(_) => told = never(),
            },
        }
    }
}

struct Server {
    messages: Sender<Message>,
    jobs: Sender<Job>,
    /// By their URIs.
    documents: BTreeMap<String, Document>,
    /// Of the newest text; editors begin to count again when they open a file again.
    revision: u64,
}

impl Server {
    fn request(&self, request: Request) {
        let id = request.id.clone();
        let answer = catch_unwind(AssertUnwindSafe(|| self.answer(request)));
        let answer = answer.unwrap_or_else(|_| {
            let message = "a mistake in the language server".to_owned();
            Response::new_err(id, ErrorCode::InternalError as i32, message)
        });
        // An editor that has gone needs no answer.
        let _ = self.messages.send(answer.into());
    }

    fn answer(&self, request: Request) -> Response {
        match request.method.as_str() {
            HoverRequest::METHOD => self.ask::<HoverRequest>(request, |server, params| {
                let at = params.text_document_position_params;
                Ok(server
                    .document(&at)
                    .and_then(|d| hover::hover(d, at.position)))
            }),
            GotoDefinition::METHOD => self.ask::<GotoDefinition>(request, |server, params| {
                let at = params.text_document_position_params;
                Ok(server
                    .document(&at)
                    .and_then(|d| names::definition(d, at.position)))
            }),
            References::METHOD => self.ask::<References>(request, |server, params| {
                let (at, with) = (params.text_document_position, params.context);
                let document = server.document(&at);
                Ok(document
                    .and_then(|d| names::references(d, at.position, with.include_declaration)))
            }),
            PrepareRenameRequest::METHOD => {
                self.ask::<PrepareRenameRequest>(request, |server, at| {
                    Ok(server
                        .document(&at)
                        .and_then(|d| names::prepare(d, at.position)))
                })
            }
            Rename::METHOD => self.ask::<Rename>(request, |server, params| {
                let at = params.text_document_position;
                match server.document(&at) {
                    Some(document) => names::renamed(document, at.position, &params.new_name),
                    None => Ok(None),
                }
            }),
            Completion::METHOD => self.ask::<Completion>(request, |server, params| {
                let at = params.text_document_position;
                let document = server.document(&at);
                let items = document.map(|d| completion::completion(d, at.position));
                Ok(items.map(CompletionResponse::Array))
            }),
            other => {
                let message = format!("no method `{other}`");
                Response::new_err(request.id, ErrorCode::MethodNotFound as i32, message)
            }
        }
    }

    fn ask<R: lsp_types::request::Request>(
        &self,
        request: Request,
        answer: impl FnOnce(&Self, R::Params) -> Result<R::Result, String>,
    ) -> Response {
        match serde_json::from_value(request.params) {
            Ok(params) => match answer(self, params) {
                Ok(result) => Response::new_ok(request.id, result),
                Err(reason) => Response::new_err(request.id, REQUEST_FAILED, reason),
            },
            Err(error) => {
                let code = ErrorCode::InvalidParams as i32;
                Response::new_err(request.id, code, error.to_string())
            }
        }
    }

    /// The document of a place, if it is a spec.
    fn document(&self, at: &TextDocumentPositionParams) -> Option<&Document> {
        let document = self.documents.get(at.text_document.uri.as_str())?;
        document.is_spec().then_some(document)
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
                let opened: lsp_types::DidOpenTextDocumentParams = serde_json::from_value(params)?;
                let opened = opened.text_document;
                self.open(opened.uri, opened.version, Text::new(opened.text));
            }
            DidChangeTextDocument::METHOD => {
                let changed: lsp_types::DidChangeTextDocumentParams =
                    serde_json::from_value(params)?;
                let document = changed.text_document;
                if let Some(known) = self.documents.get(document.uri.as_str()) {
                    let changes = changed.content_changes.into_iter();
                    let text =
                        changes.fold(known.text.clone(), |text, change| text.changed(change));
                    self.open(document.uri, document.version, text);
                }
            }
            DidCloseTextDocument::METHOD => {
                let closed: lsp_types::DidCloseTextDocumentParams = serde_json::from_value(params)?;
                let uri = closed.text_document.uri;
                self.documents.remove(uri.as_str());
                self.publish(uri, None, Vec::new());
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes a new text: tells what reading it tells, and has its equations derived.
    fn open(&mut self, uri: Uri, version: i32, text: Text) {
        self.revision += 1;
        let mut document = Document::new(uri.clone(), version, text);
        document.revision = self.revision;
        let key = uri.as_str().to_owned();
        let is_valid = document.is_spec() && document.reading.is_valid();
        if !is_valid && let Some(before) = self.documents.remove(&key) {
            // Those of the newest valid text.
            document.contributions = before.contributions;
        }
        let findings = if document.is_spec() {
            diagnostics::shown(&document, &document.reading.findings)
        } else {
            Vec::new()
        };
        if is_valid {
            let text = document.text.as_str().to_owned();
            let uri = key.clone();
            // Without the worker there are the findings of reading.
            let revision = self.revision;
            let _ = self.jobs.send(Job {
                uri,
                revision,
                text,
            });
        }
        self.documents.insert(key, document);
        self.publish(uri, Some(version), findings);
    }

    /// Takes what the derivation tells, if it is about the newest text.
    fn learn(&mut self, told: Told) {
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

    fn tell<N: lsp_types::notification::Notification>(&self, params: N::Params) {
        let notification = Notification::new(N::METHOD.to_owned(), params);
        // An editor that has gone hears nothing.
        let _ = self.messages.send(notification.into());
    }
}
