//! Atomic writing of files.

use std::fs::{File, Metadata, TryLockError};
use std::io::{self, BufWriter, IntoInnerError, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tempfile::{Builder, NamedTempFile};

/// Suffix of the name of a draft, which begins with a dot.
const SUFFIX: &str = ".draft";

/// Where file locks are not available, a draft older than this is abandoned.
const LEFT_BEHIND: Duration = Duration::from_hours(1);

/// The drafts of this process.
static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn drafts() -> MutexGuard<'static, Vec<PathBuf>> {
    // A panic cannot leave a list of paths inconsistent.
    DRAFTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all drafts of this process. Called before a signal terminates it.
pub fn remove_drafts() {
    for draft in drafts().drain(..) {
        // The process is terminating: errors cannot be reported.
        let _ = std::fs::remove_file(draft);
    }
}

/// Removes the abandoned drafts of a folder. Drafts that are still being written are kept.
pub fn remove_left_behind(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with('.') && name.ends_with(SUFFIX) && is_left_behind(&path) {
            match std::fs::remove_file(&path) {
                // Another process has removed it meanwhile.
                Err(cause) if cause.kind() != io::ErrorKind::NotFound => return Err(cause),
                _ => {}
            }
        }
    }
    Ok(())
}

fn is_left_behind(draft: &Path) -> bool {
    let about = std::fs::symlink_metadata(draft);
    let Some(about) = about.ok().filter(Metadata::is_file) else {
        return false;
    };
    match File::open(draft).map(|file| file.try_lock()) {
        Ok(Ok(())) => true,
        Ok(Err(TryLockError::Error(_))) => {
            let age = about.modified().ok().and_then(|at| at.elapsed().ok());
            age.is_some_and(|age| age > LEFT_BEHIND)
        }
        _ => false,
    }
}

/// An entry of the list of drafts.
#[derive(Debug)]
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        drafts().retain(|draft| *draft != self.0);
    }
}

/// A new file under a random name in the folder of its target. [`Draft::finish`] renames it to the target; a draft that
/// is dropped before is removed.
#[derive(Debug)]
pub struct Draft {
    file: BufWriter<NamedTempFile>,
    target: PathBuf,
    // Dropped after `file`, so that the file is removed first.
    _listed: Listed,
}

impl Draft {
    /// A draft of the file at `target`, whose folder must exist.
    pub fn new(target: &Path) -> io::Result<Self> {
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut naming = Builder::new();
        naming.prefix(".").suffix(SUFFIX);
        // The usual permissions of new files, which the umask restricts.
        #[cfg(unix)]
        naming.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // The list is locked while the file is created, so that a signal handler does not miss it.
        let mut drafts = drafts();
        let file = naming.tempfile_in(folder)?;
        // The lock marks the draft as in use; systems without locks go by its age.
        let _ = file.as_file().try_lock();
        drafts.push(file.path().to_owned());
        Ok(Self {
            _listed: Listed(file.path().to_owned()),
            file: BufWriter::new(file),
            target: target.to_owned(),
        })
    }

    /// Flushes the file to disk and renames it to its target. An existing file is replaced; its permissions are kept.
    pub fn finish(self) -> io::Result<()> {
        let file = self.file.into_inner().map_err(IntoInnerError::into_error)?;
        if let Ok(there) = std::fs::metadata(&self.target) {
            file.as_file().set_permissions(there.permissions())?;
        }
        file.as_file().sync_all()?;
        file.persist(&self.target).map_err(|error| error.error)?;
        Ok(())
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
