//! Messages over streams: framing, with limits on lengths. Malformed messages are answered and skipped.

use std::io::{self, BufRead, Read as _, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Receiver, Sender, bounded};
use lsp_server::{Connection, ErrorCode, Message};
use serde_json::{Value, json};

/// Limit on a message in bytes: many times that of a spec with every character escaped.
const LONGEST: u64 = 32 << 20;
/// Limit on a header line, in bytes.
const LONGEST_LINE: u64 = 1 << 10;

/// A connection over two streams, and the writer thread, which ends when all senders are dropped.
pub(crate) fn connect(
    from: impl BufRead + Send + 'static,
    to: impl Write + Send + 'static,
) -> io::Result<(Connection, JoinHandle<io::Result<()>>)> {
    let to = Arc::new(Mutex::new(to));
    let (sender, messages) = bounded(0);
    let (tell, receiver) = bounded(0);
    let reader = Reader {
        from,
        to: Arc::clone(&to),
    };
    thread::Builder::new().spawn(move || reader.read(&tell))?;
    let writer = thread::Builder::new().spawn(move || write(&messages, &to))?;
    Ok((Connection { sender, receiver }, writer))
}

fn write(messages: &Receiver<Message>, to: &Mutex<impl Write>) -> io::Result<()> {
    for message in messages {
        message.write(&mut *to.lock().unwrap_or_else(PoisonError::into_inner))?;
    }
    Ok(())
}

/// The answer that refuses a message, with the number of the request where it is known.
fn refusal(code: ErrorCode, reason: &str, id: &Value) -> String {
    let error = json!({ "code": code as i32, "message": reason });
    json!({ "jsonrpc": "2.0", "id": id, "error": error }).to_string()
}

struct Reader<R, W> {
    from: R,
    to: Arc<Mutex<W>>,
}

impl<R: BufRead, W: Write> Reader<R, W> {
    /// Reads until the stream ends or the receiver is dropped.
    fn read(mut self, tell: &Sender<Message>) -> io::Result<()> {
        // One refusal for each run of malformed headers.
        let mut lost = false;
        while let Some(length) = self.length()? {
            let was_lost = std::mem::replace(&mut lost, length.is_err());
            let message = match length {
                Ok(length) => self.message(length)?,
                Err(_) if was_lost => continue,
                Err(reason) => Err(refusal(ErrorCode::ParseError, &reason, &Value::Null)),
            };
            match message {
                Ok(message) => {
                    if tell.send(message).is_err() {
                        break;
                    }
                }
                Err(refusal) => self.refuse(&refusal)?,
            }
        }
        Ok(())
    }

    /// The length stated by the header; nothing at the end of the stream.
    fn length(&mut self) -> io::Result<Option<Result<u64, String>>> {
        let mut length = None;
        loop {
            let mut line = Vec::new();
            (&mut self.from)
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut line)?;
            if line.is_empty() {
                return Ok(None);
            }
            let line = String::from_utf8_lossy(&line);
            let line = line.trim();
            if line.is_empty() {
                return Ok(Some(length.ok_or_else(|| {
                    "a message begins with the header `Content-Length`".to_owned()
                })));
            }
            if let Some((name, stated)) = line.split_once(':')
                && name.trim().eq_ignore_ascii_case("Content-Length")
            {
                length = stated.trim().parse().ok();
            }
        }
    }

    /// The message of this length. One beyond the limit is skipped.
    fn message(&mut self, length: u64) -> io::Result<Result<Message, String>> {
        let mut body = (&mut self.from).take(length);
        if length > LONGEST {
            io::copy(&mut body, &mut io::sink())?;
            let reason = format!("a message has at most {} MiB", LONGEST >> 20);
            let code = ErrorCode::InvalidRequest;
            return Ok(Err(refusal(code, &reason, &Value::Null)));
        }
        let mut bytes = Vec::new();
        body.read_to_end(&mut bytes)?;
        Ok(message(&bytes))
    }

    fn refuse(&self, text: &str) -> io::Result<()> {
        let mut to = self.to.lock().unwrap_or_else(PoisonError::into_inner);
        write!(to, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        to.flush()
    }
}

/// A message, or the answer that refuses it.
fn message(bytes: &[u8]) -> Result<Message, String> {
    let value: Value = serde_json::from_slice(bytes)
        .map_err(|error| refusal(ErrorCode::ParseError, &error.to_string(), &Value::Null))?;
    let id = value
        .get("id")
        .filter(|id| id.is_number() || id.is_string());
    let id = id.cloned().unwrap_or_default();
    match serde_json::from_value(value) {
        // A notification with an identifier is a request whose identifier is invalid.
        Ok(message) if id.is_null() || !matches!(message, Message::Notification(_)) => Ok(message),
        _ => {
            let reason = "this is no request, notification or response";
            Err(refusal(ErrorCode::InvalidRequest, reason, &id))
        }
    }
}
