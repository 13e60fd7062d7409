//! Storage of chunks.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use appell_files::{Draft, remove_left_behind};
use bytes::Bytes;

use crate::limits::MAX_CHUNK_BYTES;

/// Why a store fails.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {cause}")]
pub struct StoreError {
    /// The file or the address.
    pub place: String,
    /// The reason.
    #[source]
    pub cause: Box<dyn std::error::Error + Send + Sync>,
}

impl StoreError {
    pub(crate) fn new(
        place: impl Into<String>,
        cause: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self {
            place: place.into(),
            cause: cause.into(),
        }
    }
}

/// A store of named objects with atomic writes.
pub trait Store: Send + Sync {
    /// The names of all objects.
    fn names(&self) -> Result<Vec<String>, StoreError>;
    /// An object.
    fn read(&self, name: &str) -> Result<Bytes, StoreError>;
    /// Writes an object, or replaces it.
    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<(), StoreError>;
    /// Removes leftovers of interrupted writers, but not the files of active ones.
    fn tidy(&self) -> Result<(), StoreError> {
        Ok(())
    }
}

/// An error where a name could mean another place, or a hidden file.
pub(crate) fn check(name: &str) -> Result<(), StoreError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    if !name.is_empty() && !name.starts_with('.') && name.chars().all(is_plain) {
        return Ok(());
    }
    let cause = "a name consists of letters, digits, `_`, `-` and `.`, and does not begin with `.`";
    Err(StoreError::new(appell_spec::shown(name), cause))
}

/// A folder of files.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

/// Drafts of one object: another process may take one for left behind before it is locked.
const DRAFTS: usize = 8;

impl Folder {
    /// The folder, which is made if it is not there.
    pub fn new(path: &Path) -> Result<Self, StoreError> {
        let folder = Self {
            path: path.to_owned(),
        };
        fs::create_dir_all(path).map_err(|cause| folder.error("", cause))?;
        Ok(folder)
    }

    fn error(&self, name: &str, cause: io::Error) -> StoreError {
        StoreError::new(self.path.join(name).to_string_lossy(), cause)
    }

    fn all(&self) -> io::Result<Vec<String>> {
        let entries = fs::read_dir(&self.path)?;
        let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        names.collect()
    }

    /// Writes a temporary file in the same folder and renames it, so that an interrupted write changes nothing.
    fn replace(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let place = self.path.join(name);
        let mut tried = 0;
        loop {
            tried += 1;
            let mut draft = Draft::new(&place)?;
            draft.write_all(bytes)?;
            match draft.finish() {
                Err(cause) if cause.kind() == io::ErrorKind::NotFound && tried < DRAFTS => {}
                written => return written,
            }
        }
    }
}

impl Store for Folder {
    fn names(&self) -> Result<Vec<String>, StoreError> {
        let mut names = self.all().map_err(|cause| self.error("", cause))?;
        names.retain(|name| !name.starts_with('.'));
        names.sort();
        Ok(names)
    }

    fn read(&self, name: &str) -> Result<Bytes, StoreError> {
        check(name)?;
        let read = appell_files::read(&self.path.join(name), MAX_CHUNK_BYTES);
        let read = read.map_err(|cause| StoreError::new(name, cause));
        Ok(read?.into())
    }

    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<(), StoreError> {
        check(name)?;
        self.replace(name, &bytes)
            .map_err(|cause| self.error(name, cause))
    }

    fn tidy(&self) -> Result<(), StoreError> {
        remove_left_behind(&self.path).map_err(|cause| self.error("", cause))
    }
}

/// Objects in memory.
#[derive(Debug, Default)]
pub struct Memory(Mutex<BTreeMap<String, Bytes>>);

impl Memory {
    fn objects(&self) -> MutexGuard<'_, BTreeMap<String, Bytes>> {
        // Each insertion is complete, even if a writer has panicked since.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Store for Memory {
    fn names(&self) -> Result<Vec<String>, StoreError> {
        Ok(self.objects().keys().cloned().collect())
    }

    fn read(&self, name: &str) -> Result<Bytes, StoreError> {
        let found = self.objects().get(name).cloned();
        found.ok_or_else(|| StoreError::new(name, "there is no such object"))
    }

    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<(), StoreError> {
        check(name)?;
        self.objects().insert(name.to_owned(), bytes.into());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that is removed at the end of the test.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(name: &str) -> Self {
            let process = std::process::id();
            let path = std::env::temp_dir().join(format!("appell-store-{name}-{process}"));
            fs::create_dir_all(&path).expect("a folder");
            Self(path)
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_name_stays_in_its_folder() {
        let scratch = Scratch::new("names");
        let folder = Folder::new(&scratch.0.join("inner")).expect("a folder");
        let memory = Memory::default();
        for name in [
            "", ".", "..", "../out", "a/b", "/tmp/x", "a\\b", "c:x", ".hidden", "a\0",
        ] {
            assert!(folder.write(name, vec![1]).is_err(), "{name:?}");
            assert!(memory.write(name, vec![1]).is_err(), "{name:?}");
            assert!(folder.read(name).is_err(), "{name:?}");
        }
        let names = |path: &Path| fs::read_dir(path).expect("a folder").count();
        assert_eq!((names(&scratch.0), names(&folder.path)), (1, 0));
        folder.write("a_B-1.svg", vec![1]).expect("a name");
        assert_eq!(folder.names().expect("names"), ["a_B-1.svg"]);
    }

    /// Two of three of such writers failed when each removed all drafts.
    #[test]
    fn many_write_the_same_objects_and_tidy_at_once() {
        let scratch = Scratch::new("many");
        let one = |_| {
            let folder = Folder::new(&scratch.0).expect("a folder");
            for round in 0..20 {
                let name = format!("{}.parquet", round % 3);
                folder.write(&name, vec![7; 5000]).expect("written");
                folder.tidy().expect("tidied");
                assert_eq!(folder.read(&name).expect("read"), vec![7; 5000]);
            }
        };
        std::thread::scope(|scope| {
            for writer in 0..6 {
                scope.spawn(move || one(writer));
            }
        });
        let left = fs::read_dir(&scratch.0).expect("a folder");
        assert_eq!(left.count(), 3);
    }

    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_read() {
        let scratch = Scratch::new("regular");
        let folder = Folder::new(&scratch.0).expect("a folder");
        std::os::unix::fs::symlink("/dev/zero", scratch.0.join("zero")).expect("a link");
        fs::create_dir(scratch.0.join("inner")).expect("a folder");
        assert!(folder.read("zero").is_err());
        assert!(folder.read("inner").is_err());
    }
}
