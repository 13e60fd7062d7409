//! A browser that opens a page without a window, driven over the `DevTools` protocol.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Whoever says nothing for so long will not say anything.
const PATIENCE: Duration = Duration::from_mins(1);
/// Where a browser may be found; `CHROMIUM` names another.
const PROGRAMS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
/// Drawing in space without a graphics processor.
const FLAGS: [&str; 9] = [
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--remote-debugging-pipe",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",
    "--window-size=900,640",
];
/// The browser speaks over the channels 3 and 4.
const SHELL: &str = "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1";

/// Lines of the ground differ less from the paper. A picture can be read until the next one is asked for: in the same frame, after the page.
const DRAWN: &str = "new Promise((done) => requestAnimationFrame(() => {
    const space = document.getElementById('space');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [space.width, space.height];
    const pen = copy.getContext('2d');
    pen.drawImage(space, 0, 0);
    const { data } = pen.getImageData(0, 0, copy.width, copy.height);
    const paper = getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number);
    const differs = (pixel) => paper.some((part, k) => Math.abs(data[4 * pixel + k] - part) > 80);
    const pixels = data.length / 4;
    let count = 0;
    for (let pixel = 0; pixel < pixels; pixel += 1) count += differs(pixel);
    done(count / pixels);
}))";

/// Browsers share the processors; one after the other they are not slow.
static TURN: Mutex<()> = Mutex::new(());

/// A browser with one page.
pub(crate) struct Browser {
    _turn: MutexGuard<'static, ()>,
    process: Child,
    to: ChildStdin,
    messages: Receiver<Value>,
    last: u64,
    session: String,
    events: Vec<Value>,
}

/// The program. Without one there is nothing, with the reason printed; a gate (`CI=true`) fails.
pub(crate) fn program() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let on_path = std::env::split_paths(&path)
        .flat_map(|folder| PROGRAMS.map(|program| folder.join(program)));
    let wanted = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let found = wanted.into_iter().chain(on_path).find(|p| p.is_file());
    if found.is_none() {
        let told = "there is no Chromium on the path, and CHROMIUM names none";
        assert!(std::env::var_os("CI").is_none(), "{told}");
        println!("not opened: {told}");
    }
    found
}

impl Browser {
    /// A browser with an empty page; its files go to a folder. Nothing where there is no browser.
    pub(crate) fn start(folder: &Path) -> Option<Self> {
        let program = program()?;
        // A test that failed in its turn has had it.
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let mut process = Command::new("sh")
            .arg("-c")
            .arg(SHELL)
            .arg(program)
            .args(FLAGS)
            .arg(format!("--user-data-dir={}", folder.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let to = process.stdin.take().expect("a pipe");
        let from = BufReader::new(process.stdout.take().expect("a pipe"));
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            for message in from.split(0) {
                let Ok(message) = message else { return };
                let message = serde_json::from_slice(&message).expect("JSON");
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let mut browser = Self {
            _turn: turn,
            process,
            to,
            messages,
            last: 0,
            session: String::new(),
            events: Vec::new(),
        };
        let target = browser.call("Target.createTarget", &json!({ "url": "about:blank" }));
        let wanted = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", &wanted);
        attached["sessionId"]
            .as_str()
            .expect("a session")
            .clone_into(&mut browser.session);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        Some(browser)
    }

    /// Sends a command and waits for its result.
    pub(crate) fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        write!(self.to, "{message}\0").expect("the browser listens");
        loop {
            let answer = self.messages.recv_timeout(PATIENCE);
            let mut answer = answer.unwrap_or_else(|cause| panic!("{method}: {cause}"));
            if answer["id"] == self.last {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].take();
            }
            self.events.push(answer);
        }
    }

    /// Prefers light or dark.
    pub(crate) fn prefer(&mut self, scheme: &str) {
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.call(
            "Emulation.setEmulatedMedia",
            &json!({ "features": [feature] }),
        );
    }

    /// Opens a file.
    pub(crate) fn open(&mut self, page: &Path) {
        let page = page.canonicalize().expect("the page");
        self.visit(&format!("file://{}", page.display()));
    }

    /// Opens an address.
    pub(crate) fn visit(&mut self, url: &str) {
        self.call("Page.navigate", &json!({ "url": url }));
        self.wait("document.readyState == 'complete'");
    }

    /// The value of an expression on the page, or of what it promises.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({
            "expression": expression, "returnByValue": true, "awaitPromise": true,
        });
        let mut answer = self.call("Runtime.evaluate", &parameters);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {answer}"
        );
        answer["result"]["value"].take()
    }

    /// The same, a number.
    pub(crate) fn number(&mut self, expression: &str) -> f64 {
        let value = self.value(expression);
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{expression}: {value} is no number"))
    }

    /// Waits until an expression holds.
    pub(crate) fn wait(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != json!(true) {
            assert!(start.elapsed() < PATIENCE, "`{expression}` never holds");
            pause(0.05);
        }
    }

    /// Presses a key on the page.
    pub(crate) fn press(&mut self, key: &str) {
        let event = format!("new KeyboardEvent('keydown', {{key: '{key}', bubbles: true}})");
        self.value(&format!("document.body.dispatchEvent({event})"));
    }

    /// The page as it is seen, PNG in base 64.
    pub(crate) fn picture(&mut self) -> String {
        let mut answer = self.call("Page.captureScreenshot", &json!({}));
        let data = answer["data"].take();
        data.as_str().expect("a picture").to_owned()
    }

    /// Waits until more than this part of the picture in space, of a page that plays, is neither paper nor
    /// ground.
    pub(crate) fn draws(&mut self, part: f64) {
        let start = Instant::now();
        loop {
            let drawn = self.number(DRAWN);
            if drawn > part {
                return;
            }
            assert!(
                start.elapsed() < PATIENCE,
                "{drawn} of the picture is drawn"
            );
            pause(0.05);
        }
    }

    /// What the page complained of, and what it asked of a network.
    pub(crate) fn complaints(&mut self) -> Vec<String> {
        // Whatever happened before this answer has been told.
        self.value("0");
        let told = self.events.iter().filter(|event| {
            let url = event["params"]["request"]["url"].as_str();
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.exceptionThrown" => true,
                // That a picture without a graphics processor is read back is no fault of the page.
                "Log.entryAdded" => !event.to_string().contains("GPU stall due to ReadPixels"),
                "Runtime.consoleAPICalled" => {
                    matches!(event["params"]["type"].as_str(), Some("error" | "warning"))
                }
                "Network.requestWillBeSent" => {
                    !url.is_some_and(|url| url.starts_with("file:") || url.starts_with("data:"))
                }
                _ => false,
            }
        });
        told.map(Value::to_string).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

pub(crate) fn pause(seconds: f64) {
    std::thread::sleep(Duration::from_secs_f64(seconds));
}
