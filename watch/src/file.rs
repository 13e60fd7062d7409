//! The file of the spec: its text whenever it is saved.

use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, SystemTime};

use crate::worker::Inbox;
use appell_spec::limits::MAX_FILE;
use notify::event::{AccessKind, AccessMode, EventKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

/// A save is several events, which come together.
const TOGETHER: Duration = Duration::from_millis(3);
/// Some editors empty a file before they write it.
const WRITING: Duration = Duration::from_millis(40);
/// What the operating system does not tell is seen after this time.
const LOOK: Duration = Duration::from_millis(500);

/// The text of the file, or why there is none.
pub(crate) type Text = Result<String, String>;

/// Sends the text now and whenever it changes, until nobody wants it; the path is absolute.
pub(crate) fn follow(path: &Path, texts: Inbox) -> std::io::Result<()> {
    let path = path.to_owned();
    let (tell, told) = channel();
    let watcher = watcher(&path, tell.clone());
    let name = "file of the spec".to_owned();
    thread::Builder::new().name(name).spawn(move || {
        // It tells as long as it lives; the sender keeps the channel open where there is none.
        let _alive = (watcher, tell);
        read_again(&path, &told, &texts);
    })?;
    Ok(())
}

/// Watches the folder, since many editors put a new file in place of the old one.
fn watcher(path: &Path, tell: Sender<()>) -> Option<RecommendedWatcher> {
    let (folder, name) = (path.parent()?, path.file_name()?.to_owned());
    let told = move |event: notify::Result<notify::Event>| {
        let concerns = event.as_ref().is_ok_and(|event| {
            let is_it = |path: &std::path::PathBuf| path.file_name() == Some(&name);
            // Reading is no change, and is what follows one.
            let is_reading = match event.kind {
                EventKind::Access(AccessKind::Close(AccessMode::Write)) => false,
                EventKind::Access(_) => true,
                _ => false,
            };
            !is_reading && (event.paths.is_empty() || event.paths.iter().any(is_it))
        });
        if concerns || event.is_err() {
            // The reader has ended when the server has.
            let _ = tell.send(());
        }
    };
    let mut watcher = notify::recommended_watcher(told).ok()?;
    watcher.watch(folder, RecursiveMode::NonRecursive).ok()?;
    Some(watcher)
}

fn read_again(path: &Path, told: &Receiver<()>, texts: &Inbox) {
    let mut last = None;
    let mut seen = None;
    loop {
        seen = looks(path).or(seen);
        let mut text = read(path);
        if text.as_ref().is_ok_and(String::is_empty) {
            thread::sleep(WRITING);
            text = read(path);
        }
        if last.as_ref() != Some(&text) {
            last = Some(text.clone());
            if !texts.put(text) {
                return;
            }
        }
        if !changed(path, told, seen) {
            return;
        }
    }
}

/// Waits for a change; false when there will be none.
fn changed(path: &Path, told: &Receiver<()>, seen: Option<(u64, SystemTime)>) -> bool {
    loop {
        match told.recv_timeout(LOOK) {
            Ok(()) => {
                thread::sleep(TOGETHER);
                while told.try_recv().is_ok() {}
                return true;
            }
            Err(RecvTimeoutError::Timeout) if looks(path) == seen => {}
            Err(RecvTimeoutError::Timeout) => return true,
            Err(RecvTimeoutError::Disconnected) => return false,
        }
    }
}

/// How long the file is, and when it was written.
fn looks(path: &Path) -> Option<(u64, SystemTime)> {
    let about = std::fs::metadata(path).ok()?;
    Some((about.len(), about.modified().ok()?))
}

fn read(path: &Path) -> Text {
    let is_file = std::fs::metadata(path).is_ok_and(|about| about.is_file());
    if !is_file {
        return Err("the file is not there".to_owned());
    }
    appell::files::read(path, MAX_FILE as u64).map_err(|error| error.to_string())
}
