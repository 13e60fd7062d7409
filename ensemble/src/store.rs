//! Where chunks are kept.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use bytes::Bytes;

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

/// A place for named objects, each of which is there as a whole or not at all.
pub trait Store: Send + Sync {
    /// The names of all objects.
    fn names(&self) -> Result<Vec<String>, StoreError>;
    /// An object.
    fn read(&self, name: &str) -> Result<Bytes, StoreError>;
    /// Writes an object, or replaces it.
    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<(), StoreError>;
    /// Removes what interrupted writers left behind. Nobody writes meanwhile.
    fn tidy(&self) -> Result<(), StoreError> {
        Ok(())
    }
}

/// A folder of files.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

/// End of the name of a file that is being written.
const UNFINISHED: &str = ".unfinished";

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

    /// Writes beside the place, then renames: a killed writer leaves the place as it was.
    fn replace(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let process = std::process::id();
        let beside = self.path.join(format!(".{name}.{process}{UNFINISHED}"));
        let mut file = File::create(&beside)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(beside, self.path.join(name))
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
        let read = fs::read(self.path.join(name));
        Ok(read.map_err(|cause| self.error(name, cause))?.into())
    }

    fn write(&self, name: &str, bytes: Vec<u8>) -> Result<(), StoreError> {
        self.replace(name, &bytes)
            .map_err(|cause| self.error(name, cause))
    }

    fn tidy(&self) -> Result<(), StoreError> {
        let names = self.all().map_err(|cause| self.error("", cause))?;
        for name in names.iter().filter(|name| name.ends_with(UNFINISHED)) {
            fs::remove_file(self.path.join(name)).map_err(|cause| self.error(name, cause))?;
        }
        Ok(())
    }
}

/// Objects in memory.
#[derive(Debug, Default)]
pub struct Memory(Mutex<BTreeMap<String, Bytes>>);

impl Memory {
    fn objects(&self) -> MutexGuard<'_, BTreeMap<String, Bytes>> {
        // An object is put as a whole.
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
        self.objects().insert(name.to_owned(), bytes.into());
        Ok(())
    }
}
