//! A spec in a folder of its own, its server, and a client that speaks HTTP over a socket.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use appell_watch::Watch;
use serde_json::Value;

/// Whoever says nothing for so long will not say anything.
const PATIENCE: Duration = Duration::from_mins(1);

static NEXT: AtomicU32 = AtomicU32::new(0);

/// A spec and its server, which runs until the tests end.
pub(crate) struct Served {
    pub(crate) address: SocketAddr,
    pub(crate) token: String,
    folder: PathBuf,
}

/// An answer.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: String,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.status, 200, "{}", self.body);
        serde_json::from_str(&self.body).expect("JSON")
    }
}

/// The text of a shipped spec.
pub(crate) fn shipped(name: &str) -> String {
    let all = appell_test_kit::shipped();
    let (_, text) = all.into_iter().find(|(file, _)| file == name).expect(name);
    text
}

impl Served {
    pub(crate) fn new(text: &str) -> Self {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("appell-watch-{}-{number}", std::process::id());
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&folder).expect("a folder");
        let spec = folder.join("spec.toml");
        std::fs::write(&spec, text).expect("the spec");
        let watch = Watch::start(&spec, 0).expect("a server");
        let address = watch.address();
        let url = watch.url();
        let token = url.rsplit('/').nth(1).expect("a token").to_owned();
        std::thread::spawn(move || watch.serve());
        Self {
            address,
            token,
            folder,
        }
    }

    pub(crate) fn save(&self, text: &str) {
        std::fs::write(self.folder.join("spec.toml"), text).expect("the spec");
    }

    /// Saves as many editors do: a new file takes the place of the old one.
    pub(crate) fn replace(&self, text: &str) {
        let new = self.folder.join("spec.toml~");
        std::fs::write(&new, text).expect("a file");
        std::fs::rename(new, self.folder.join("spec.toml")).expect("the spec");
    }

    /// The names of the files beside the spec.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.folder).expect("the folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        names
            .map(|name| name.into_string().expect("a name"))
            .collect()
    }

    pub(crate) fn path(&self, name: &str) -> String {
        format!("/{}/{name}", self.token)
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        stream
    }

    /// Sends a request as it stands and reads until the server ends the connection.
    pub(crate) fn raw(&self, request: &str) -> Answer {
        let mut stream = self.connect();
        // A server that refuses a body does not read it to its end.
        let _ = stream.write_all(request.as_bytes());
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let text = String::from_utf8(bytes).expect("UTF-8");
        let (head, body) = text.split_once("\r\n\r\n").expect("an answer");
        let status = head.split(' ').nth(1).and_then(|s| s.parse().ok());
        Answer {
            status: status.expect("a status"),
            head: head.to_owned(),
            body: body.to_owned(),
        }
    }

    pub(crate) fn request(&self, method: &str, path: &str, host: &str, body: &str) -> Answer {
        let length = body.len();
        self.raw(&format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n{body}"
        ))
    }

    pub(crate) fn get(&self, name: &str) -> Answer {
        let host = self.address.to_string();
        self.request("GET", &self.path(name), &host, "")
    }

    pub(crate) fn post(&self, name: &str, body: &str) -> Answer {
        let host = self.address.to_string();
        self.request("POST", &self.path(name), &host, body)
    }

    pub(crate) fn motion(&self, request: &Value) -> Answer {
        self.post("motion", &request.to_string())
    }

    /// The state, once it fulfils something.
    pub(crate) fn state(&self, holds: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let state = self.get("state").json();
            if holds(&state) {
                return state;
            }
            assert!(start.elapsed() < PATIENCE, "{state:.2000}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The events of the server.
    pub(crate) fn events(&self) -> Events {
        let mut stream = self.connect();
        let (path, host) = (self.path("events"), self.address);
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("a server");
        Events {
            lines: BufReader::new(stream),
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // The server reads what is left of it as a spec that is gone.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// A stream of events.
pub(crate) struct Events {
    lines: BufReader<TcpStream>,
}

impl Events {
    /// The next value of a part that fulfils something.
    pub(crate) fn next(&mut self, part: &str, holds: impl Fn(&Value) -> bool) -> Value {
        let mut is_part = false;
        let start = Instant::now();
        loop {
            // A stream without news is kept alive by comments.
            assert!(start.elapsed() < PATIENCE, "no {part}");
            let mut line = String::new();
            let read = self.lines.read_line(&mut line).expect("an event");
            assert!(read > 0, "the stream ends");
            if let Some(name) = line.strip_prefix("event: ") {
                is_part = name.trim_end() == part;
            } else if let Some(data) = line.strip_prefix("data: ").filter(|_| is_part) {
                let value = serde_json::from_str(data).expect("JSON");
                if holds(&value) {
                    return value;
                }
            }
        }
    }
}
