//! The file of the spec: its text whenever it is saved.

use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, SystemTime};

use crate::worker::Inbox;
use appell_spec::limits::MAX_FILE;
use notify::event::{AccessKind, AccessMode, EventKind};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

/// A save causes several events; those within this time count as one.
const TOGETHER: Duration = Duration::from_millis(3);
/// Some editors empty a file before they write it.
const WRITING: Duration = Duration::from_millis(40);
/// Polling interval, for changes without an event from the operating system.
const LOOK: Duration = Duration::from_millis(500);

/// The text of the file, or the reason why it cannot be read.
pub(crate) type Text = Result<String, String>;

/// Sends the text now and at every change until the receiver is dropped; the path is absolute.
pub(crate) fn follow(path: &Path, texts: Inbox) -> std::io::Result<()> {
    let path = path.to_owned();
    let (tell, told) = channel();
    let watcher = watcher(&path, tell.clone());
    let name = "file of the spec".to_owned();
    thread::Builder::new().name(name).spawn(move || {
        // Keeps the watcher alive; the sender keeps the channel open if there is no watcher.
        let _alive = (watcher, tell);
        read_again(&path, &told, &texts);
    })?;
    Ok(())
}

/// Watches the folder, since many editors replace the file by a new one.
fn watcher(path: &Path, tell: Sender<()>) -> Option<RecommendedWatcher> {
    let (folder, name) = (path.parent()?, path.file_name()?.to_owned());
    let told = move |event: notify::Result<notify::Event>| {
        let concerns = event.map_or(true, |event| {
            // Read access is no change, and each reload causes it.
            let written = AccessKind::Close(AccessMode::Write);
            let is_reading = matches!(event.kind, EventKind::Access(kind) if kind != written);
            let mut paths = event.paths.iter().map(|path| path.file_name());
            !is_reading && (event.paths.is_empty() || paths.any(|own| own == Some(&name)))
        });
        if concerns {
            // Sending fails only after the server has ended.
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

/// Waits for a change; false if the channel is closed.
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

/// Length and modification time of the file.
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
