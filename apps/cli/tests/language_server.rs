//! The language server as an editor starts it.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};

use serde_json::{Value, json};

fn framed(message: &Value) -> String {
    let body = message.to_string();
    format!("Content-Length: {}\r\n\r\n{body}", body.len())
}

/// The next message, by the length that its header gives.
fn message(from: &mut impl BufRead) -> Value {
    let mut length = 0;
    loop {
        let mut line = String::new();
        from.read_line(&mut line).expect("a header");
        match line.trim_end().strip_prefix("Content-Length: ") {
            Some(number) => length = number.parse().expect("a length"),
            None if line == "\r\n" => break,
            None => panic!("{line}"),
        }
    }
    let mut body = vec![0; length];
    from.read_exact(&mut body).expect("a body");
    serde_json::from_slice(&body).expect("JSON")
}

#[test]
fn an_editor_is_served_over_standard_streams() {
    let mut server = Command::new(env!("CARGO_BIN_EXE_appell"))
        .arg("lsp")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the server");
    let mut to = server.stdin.take().expect("its input");
    let mut from = BufReader::new(server.stdout.take().expect("its output"));
    let mut tell = |message: Value| to.write_all(framed(&message).as_bytes()).expect("a reader");
    let initialize = json!({ "capabilities": {} });
    tell(json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": initialize }));
    let answer = message(&mut from);
    assert_eq!(answer["result"]["capabilities"]["hoverProvider"], true);
    tell(json!({ "jsonrpc": "2.0", "method": "initialized", "params": {} }));
    let document = json!({
        "uri": "file:///a%20rig.toml", "languageId": "toml", "version": 7,
        "text": "[mechanism]\nname = '\u{1d6c2}'\n",
    });
    let opened = json!({ "textDocument": document });
    tell(json!({ "jsonrpc": "2.0", "method": "textDocument/didOpen", "params": opened }));
    let told = message(&mut from);
    assert_eq!(told["method"], "textDocument/publishDiagnostics");
    assert_eq!(told["params"]["version"], 7);
    let findings = told["params"]["diagnostics"].as_array().expect("findings");
    let invalid = findings
        .iter()
        .find(|finding| finding["code"] == "invalid-name");
    let end = &invalid.expect("the name is told")["range"]["end"];
    // Seven letters, two quotes and two units of UTF-16.
    assert_eq!(*end, json!({ "line": 1, "character": 11 }));
    tell(json!({ "jsonrpc": "2.0", "id": 2, "method": "shutdown" }));
    assert_eq!(message(&mut from)["id"], 2);
    tell(json!({ "jsonrpc": "2.0", "method": "exit" }));
    assert!(server.wait().expect("an end").success());
}
