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

/// Why a message is refused: code and reason, with the number of the request where it is known.
struct Refusal {
    code: ErrorCode,
    reason: String,
    id: Value,
}

impl Refusal {
    fn new(code: ErrorCode, reason: impl Into<String>) -> Self {
        Self {
            code,
            reason: reason.into(),
            id: Value::Null,
        }
    }
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
        loop {
            let refusal = match self.length()? {
                None => return Ok(()),
                Some(Ok(length)) => {
                    lost = false;
                    match self.message(length)? {
                        Ok(message) => match tell.send(message) {
                            Ok(()) => continue,
                            Err(_) => return Ok(()),
                        },
                        Err(refusal) => refusal,
                    }
                }
                Some(Err(_)) if lost => continue,
                Some(Err(reason)) => {
                    lost = true;
                    Refusal::new(ErrorCode::ParseError, reason)
                }
            };
            self.refuse(refusal)?;
        }
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
            let stated = line.split_once(':').filter(|(name, _)| {
                let name = name.trim();
                name.eq_ignore_ascii_case("Content-Length")
            });
            if let Some((_, stated)) = stated {
                length = stated.trim().parse().ok();
            }
        }
    }

    /// The message of this length. One beyond the limit is skipped.
    fn message(&mut self, length: u64) -> io::Result<Result<Message, Refusal>> {
        let mut body = (&mut self.from).take(length);
        if length > LONGEST {
            io::copy(&mut body, &mut io::sink())?;
            let reason = format!("a message has at most {} MiB", LONGEST >> 20);
            return Ok(Err(Refusal::new(ErrorCode::InvalidRequest, reason)));
        }
        let mut bytes = Vec::new();
        body.read_to_end(&mut bytes)?;
        Ok(message(&bytes))
    }

    fn refuse(&self, refusal: Refusal) -> io::Result<()> {
        let Refusal { code, reason, id } = refusal;
        let error = json!({ "code": code as i32, "message": reason });
        let text = json!({ "jsonrpc": "2.0", "id": id, "error": error }).to_string();
        let mut to = self.to.lock().unwrap_or_else(PoisonError::into_inner);
        write!(to, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        to.flush()
    }
}

fn message(bytes: &[u8]) -> Result<Message, Refusal> {
    let value: Value = serde_json::from_slice(bytes)
        .map_err(|error| Refusal::new(ErrorCode::ParseError, error.to_string()))?;
    let id = value
        .get("id")
        .filter(|id| id.is_number() || id.is_string());
    let id = id.cloned().unwrap_or_default();
    match serde_json::from_value(value) {
        // A notification with an identifier is a request whose identifier is invalid.
        Ok(message) if id.is_null() || !matches!(message, Message::Notification(_)) => Ok(message),
        _ => Err(Refusal {
            id,
            ..Refusal::new(
                ErrorCode::InvalidRequest,
                "this is no request, notification or response",
            )
        }),
    }
}
