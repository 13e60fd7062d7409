//! An editor at the other end of the protocol.

#![allow(clippy::unwrap_used, reason = "what fails here fails a test")]

use std::thread::{self, JoinHandle};
use std::time::Duration;

use lsp_server::{Connection, Message, Notification, Request};
use serde_json::{Value, json};

/// Far above what a derivation takes here, also on a busy machine.
const PATIENCE: Duration = Duration::from_mins(1);

pub(crate) const URI: &str = "file:///rig/cart.toml";

/// A cart with a pendulum on a spring, without a finding.
pub(crate) const CART: &str = include_str!("cart.toml");

pub(crate) struct Editor {
    connection: Connection,
    server: Option<JoinHandle<()>>,
    asked: i32,
    version: i32,
    heard: Vec<Notification>,
}

impl Editor {
    pub(crate) fn new() -> Self {
        let (server, connection) = Connection::memory();
        let server = thread::spawn(move || appell_lsp::serve(&server).unwrap());
        let mut editor = Self {
            connection,
            server: Some(server),
            asked: 0,
            version: 0,
            heard: Vec::new(),
        };
        let told = editor
            .ask("initialize", json!({ "capabilities": {} }))
            .unwrap();
        assert_eq!(told["capabilities"]["textDocumentSync"], 2);
        editor.tell("initialized", json!({}));
        editor
    }

    /// An editor with one open spec.
    pub(crate) fn with(text: &str) -> Self {
        let mut editor = Self::new();
        editor.open(text);
        editor
    }

    pub(crate) fn tell(&self, method: &str, params: Value) {
        let told = Notification::new(method.to_owned(), params);
        self.connection.sender.send(told.into()).unwrap();
    }

    /// The answer to a request, or why there is none.
    pub(crate) fn ask(&mut self, method: &str, params: Value) -> Result<Value, String> {
        self.asked += 1;
        let request = Request::new(self.asked.into(), method.to_owned(), params);
        self.connection.sender.send(request.into()).unwrap();
        loop {
            match self.connection.receiver.recv_timeout(PATIENCE).unwrap() {
                Message::Response(answer) => {
                    assert_eq!(answer.id, self.asked.into());
                    return match answer.error {
                        Some(error) => Err(error.message),
                        None => Ok(answer.result.unwrap_or(Value::Null)),
                    };
                }
                Message::Notification(told) => self.heard.push(told),
                Message::Request(request) => panic!("{request:?}"),
            }
        }
    }

    /// Asks about the first place of `needle`, so many letters into it.
    pub(crate) fn ask_at(
        &mut self,
        method: &str,
        (text, needle, letters): (&str, &str, usize),
        more: Value,
    ) -> Result<Value, String> {
        let at = text.find(needle).unwrap() + letters;
        let mut params = more;
        params["textDocument"] = json!({ "uri": URI });
        params["position"] = position(text, at);
        self.ask(method, params)
    }

    pub(crate) fn open(&mut self, text: &str) {
        self.version += 1;
        let document =
            json!({ "uri": URI, "languageId": "toml", "version": self.version, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Changes the whole text, or parts of it.
    pub(crate) fn change(&mut self, changes: &Value) {
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        let params = json!({ "textDocument": document, "contentChanges": changes });
        self.tell("textDocument/didChange", params);
    }

    fn hear(&mut self) -> Notification {
        if !self.heard.is_empty() {
            return self.heard.remove(0);
        }
        match self.connection.receiver.recv_timeout(PATIENCE).unwrap() {
            Message::Notification(told) => told,
            other => panic!("{other:?}"),
        }
    }

    /// Whether a message of a kind has arrived beside the answers.
    pub(crate) fn has_heard(&self, method: &str) -> bool {
        self.heard.iter().any(|told| told.method == method)
    }

    /// The next findings.
    pub(crate) fn findings(&mut self) -> Vec<Value> {
        let told = self.hear();
        assert_eq!(told.method, "textDocument/publishDiagnostics", "{told:?}");
        assert_eq!(told.params["uri"], URI);
        told.params["diagnostics"].as_array().unwrap().clone()
    }

    /// The codes of the next findings.
    pub(crate) fn codes(&mut self) -> Vec<String> {
        let findings = self.findings();
        let code = |finding: &Value| finding["code"].as_str().unwrap().to_owned();
        findings.iter().map(code).collect()
    }

    /// Waits for the equations of the open spec.
    pub(crate) fn wait_for_equations(&mut self) {
        let (start, text) = (std::time::Instant::now(), CART);
        while start.elapsed() < PATIENCE {
            let told = self.ask_at("textDocument/hover", (text, "k ", 0), json!({}));
            if told.unwrap().to_string().contains("equations of motion") {
                return;
            }
            thread::sleep(Duration::from_millis(20));
        }
        panic!("no equations");
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        if thread::panicking() {
            return;
        }
        self.ask("shutdown", Value::Null).unwrap();
        self.tell("exit", Value::Null);
        self.server.take().unwrap().join().unwrap();
    }
}

/// A place as the protocol counts it.
pub(crate) fn position(text: &str, at: usize) -> Value {
    let before = &text[..at];
    let line = before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    json!({ "line": line, "character": before[start..].encode_utf16().count() })
}

pub(crate) fn range(text: &str, needle: &str) -> Value {
    let at = text.find(needle).unwrap();
    json!({ "start": position(text, at), "end": position(text, at + needle.len()) })
}
