//! Files that are written completely or not at all.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Read as _, Write};
use std::path::{Path, PathBuf};

use appell_files::Draft;
pub use appell_files::{below, remove_drafts};

use crate::Error;

/// Maximum size of a recording or of a list of cases, in bytes.
pub const MAX_DATA: u64 = 1 << 30;

/// Writes a text; `-` is standard output.
pub fn write(path: &Path, text: &str) -> Result<(), Error> {
    write_with(path, |to| to.write_all(text.as_bytes()))
}

/// Writes a file by way of a temporary file in the same folder; `-` is standard output. A pipe or a device is
/// written to directly.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Error> {
    if is_stdout(path) {
        return to_stdout(fill);
    }
    let target = behind_links(path);
    let there = fs::metadata(&target).ok();
    if there.as_ref().is_some_and(|there| !there.is_file()) {
        let special = OpenOptions::new().write(true).open(&target);
        return special
            .and_then(|file| fill_buffered(file, fill))
            .map_err(Error::writing(path));
    }
    if there.is_some_and(|there| there.permissions().readonly()) {
        let cause = io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only");
        return Err(Error::writing(path)(cause));
    }
    let folder = target.parent().filter(|at| !at.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        let message = format!("there is no folder `{}`: create it first", folder.display());
        return Err(Error::data(path.display(), message));
    }
    let mut draft = Draft::new(&target).map_err(Error::writing(path))?;
    fill(&mut draft)
        .and_then(|()| draft.finish())
        .map_err(Error::writing(path))
}

/// Creates a requested folder and its parents.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(Error::writing(path))
}

/// The target of a link, even if it does not exist yet: links are preserved.
fn behind_links(path: &Path) -> PathBuf {
    let beside = |target: PathBuf| path.parent().unwrap_or(path).join(target);
    fs::canonicalize(path)
        .or_else(|_| fs::read_link(path).map(beside))
        .unwrap_or_else(|_| path.to_owned())
}

fn fill_buffered(
    to: impl Write,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut to = BufWriter::new(to);
    fill(&mut to)?;
    to.flush()
}

/// Writes JSON with a final line break.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), Error> {
    write(path, &json_text(value)?)
}

/// The text of a JSON file.
pub fn json_text(value: &impl serde::Serialize) -> Result<String, Error> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

/// Writes to standard output; a closed pipe is not an error.
pub fn to_stdout(fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    match fill_buffered(io::stdout().lock(), fill) {
        Err(cause) if cause.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::writing(Path::new("standard output"))(cause))
        }
        _ => Ok(()),
    }
}

/// Whether a path means standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads a text file of at most `most` bytes; `-` is standard input.
///
/// The file is a regular one, or one that the shell has opened: `/dev/stdin`, or `<(command)`.
pub fn read(path: &Path, most: u64) -> Result<String, Error> {
    if is_stdout(path) {
        return read_open(Path::new("standard input"), io::stdin(), most);
    }
    let is_open = path.starts_with("/dev/fd") || path.starts_with("/dev/stdin");
    if is_open && let Ok(file) = fs::File::open(path) {
        return read_open(path, file, most);
    }
    Ok(appell_files::read_text(path, most)?)
}

fn read_open(name: &Path, from: impl io::Read, most: u64) -> Result<String, Error> {
    let mut text = String::new();
    // One byte more shows that there are too many.
    let read = from.take(most + 1).read_to_string(&mut text);
    let count = read.map_err(Error::reading(name))?;
    if count as u64 > most {
        let message = format!("the text exceeds the limit of {} MiB", most >> 20);
        return Err(Error::data(name.display(), message));
    }
    Ok(text)
}
