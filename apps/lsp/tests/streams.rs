//! Messages as bytes: what cannot be read is answered, and the next message is read.

use std::io::{self, BufReader, Cursor, Read, Write};
use std::sync::{Arc, Mutex};

use serde_json::{Value, json};

/// Above the longest message.
const TOO_LONG: u64 = (32 << 20) + 1;

#[derive(Clone, Default)]
struct Written(Arc<Mutex<Vec<u8>>>);

impl Write for Written {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("the bytes").write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What the server answers until the stream ends: numbers of requests, and codes of errors.
fn answers(from: impl Read + Send + 'static) -> Vec<(Value, Value)> {
    let written = Written::default();
    appell_lsp::serve_streams(BufReader::new(from), written.clone()).expect("an end");
    let bytes = written.0.lock().expect("the bytes").clone();
    let text = String::from_utf8(bytes).expect("UTF-8");
    let bodies = text.split("Content-Length: ").skip(1);
    let answers = bodies.map(|one| {
        let (length, body) = one.split_once("\r\n\r\n").expect("a header");
        assert_eq!(length.parse(), Ok(body.len()));
        let answer: Value = serde_json::from_str(body).expect("JSON");
        assert_eq!(answer["jsonrpc"], "2.0");
        (answer["id"].clone(), answer["error"]["code"].clone())
    });
    answers.collect()
}

fn framed(body: &str) -> String {
    format!("Content-Length: {}\r\n\r\n{body}", body.len())
}

fn request(id: impl Into<Value>, method: &str) -> String {
    framed(&json!({ "jsonrpc": "2.0", "id": id.into(), "method": method }).to_string())
}

#[test]
fn every_mistake_of_the_protocol_is_answered() {
    let lines = [
        request(1, "textDocument/hover"),
        framed("{"),
        framed("[]"),
        framed(r#"{"jsonrpc": "2.0", "id": 1.5, "method": "initialize"}"#),
        framed("\u{ff}\u{1b}[2J"),
        "Content-Length: -3\r\n\r\n".to_owned(),
        "no header\r\n\r\n".to_owned(),
        "Content-Length: 1e99\r\n\r\n".to_owned(),
        request("two", "initialize"),
        request(3, "initialize"),
        request(4, "unheard/of"),
        request(5, "shutdown"),
        request(6, "textDocument/hover"),
        framed(r#"{"jsonrpc": "2.0", "method": "exit"}"#),
        request(8, "initialize"),
    ];
    let mut told = answers(Cursor::new(lines.concat()));
    let is = |id: Value, code: i64| (id, json!(code));
    let mut wanted = vec![
        is(json!(1), -32002),
        is(Value::Null, -32700),
        is(Value::Null, -32600),
        is(json!(1.5), -32600),
        is(Value::Null, -32700),
        // Three headers in a row that cannot be read.
        is(Value::Null, -32700),
        (json!("two"), Value::Null),
        is(json!(3), -32600),
        is(json!(4), -32601),
        (json!(5), Value::Null),
        is(json!(6), -32600),
    ];
    // What cannot be read is answered at once, before what is still being answered.
    let text = |answer: &(Value, Value)| format!("{answer:?}");
    told.sort_by_key(text);
    wanted.sort_by_key(text);
    assert_eq!(told, wanted);
}

#[test]
fn a_message_that_is_too_long_is_passed_over() {
    let header = format!("Content-Length: {TOO_LONG}\r\n\r\n");
    let long = Cursor::new(header).chain(io::repeat(b'{').take(TOO_LONG));
    let told = answers(long.chain(Cursor::new(request(1, "initialize"))));
    assert_eq!(
        told,
        [(Value::Null, json!(-32600)), (json!(1), Value::Null)]
    );
}

#[test]
fn a_length_is_not_believed() {
    for length in [TOO_LONG - 1, u64::MAX] {
        let cut = format!("Content-Length: {length}\r\n\r\n{{");
        assert_eq!(answers(Cursor::new(cut)).len(), 1);
    }
}
