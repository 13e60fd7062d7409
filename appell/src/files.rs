//! Files that appear complete or not at all.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Read as _, Write};
use std::path::{Path, PathBuf};

use crate::Error;

/// Largest recording or list of cases, in bytes.
pub const MAX_DATA: u64 = 1 << 30;

/// Writes a text; `-` is standard output.
pub fn write(path: &Path, text: &str) -> Result<(), Error> {
    write_with(path, |to| to.write_all(text.as_bytes()))
}

/// Writes a file through a draft beside it; `-` is standard output. What stands there and is no
/// regular file, such as a pipe or a device, is written to and not replaced.
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
    let permissions = there.map(|there| there.permissions());
    if permissions.as_ref().is_some_and(fs::Permissions::readonly) {
        let cause = io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only");
        return Err(Error::writing(path)(cause));
    }
    if let Some(folder) = target.parent().filter(|at| !at.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(Error::writing(folder))?;
    }
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    let draft = target.with_file_name(name);
    fs::File::create(&draft)
        .and_then(|file| fill_buffered(file, fill))
        .and_then(|()| permissions.map_or(Ok(()), |own| fs::set_permissions(&draft, own)))
        .and_then(|()| fs::rename(&draft, &target))
        .map_err(|cause| {
            // The draft is of no use; that it cannot be removed would only hide the cause.
            let _ = fs::remove_file(&draft);
            Error::writing(path)(cause)
        })
}

/// A link stays a link: its target is what the user means, even where it does not exist yet.
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

/// Writes JSON, one line break at its end.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|cause| Error::Computation(format!("the result is not JSON: {cause}")))?;
    write(path, &(text + "\n"))
}

/// A reader who has seen enough, such as `head`, is no failure.
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

/// Reads a text file of at most so many bytes; `-` is standard input.
pub fn read(path: &Path, most: u64) -> Result<String, Error> {
    let mut bytes = Vec::new();
    // One byte more tells that there are too many.
    let read = if is_stdout(path) {
        io::stdin().take(most + 1).read_to_end(&mut bytes)
    } else {
        fs::File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes))
    };
    let count = read.map_err(Error::reading(path))?;
    let file = path.display();
    if count as u64 > most {
        return Err(Error::Data(format!(
            "{file} is larger than {} MiB, which is the most that is read",
            most >> 20
        )));
    }
    String::from_utf8(bytes).map_err(|cause| {
        let before = &cause.as_bytes()[..cause.utf8_error().valid_up_to()];
        let line = before.split(|byte| *byte == b'\n').count();
        Error::Data(format!("{file}:{line}: the file is not UTF-8 text"))
    })
}
