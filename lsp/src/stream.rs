//! Messages over streams: their frames, within bounds. What cannot be read is answered and skipped.

use std::io::{self, BufRead, Read as _, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Receiver, Sender, bounded};
use lsp_server::{Connection, ErrorCode, Message};
use serde_json::{Value, json};

/// Longest message, in bytes: many times that of a text of a spec with every character escaped.
const LONGEST: u64 = 32 << 20;
/// Longest line of a header, in bytes.
const LONGEST_LINE: u64 = 1 << 10;

/// A connection over two streams, and the thread that writes; it ends when nobody can send any more.
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

/// Why there is no message: the code and the reason, with the number of the request where it is known.
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
    /// Reads until the stream ends or nobody listens.
    fn read(mut self, tell: &Sender<Message>) -> io::Result<()> {
        // Between two headers that can be read, one refusal is enough.
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

    /// The length that a header states; nothing at the end of the stream.
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

    /// The message of so many bytes. One that is too long is passed over.
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
        // With a number, it is a request whose number is none of the protocol.
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
