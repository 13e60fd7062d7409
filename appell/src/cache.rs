//! Derived functions kept from run to run, in the cache folder of the user.

use std::fs::{self, File, FileTimes};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::time::SystemTime;

use appell_codegen::tapes::{Store, keep_in};
use appell_files::{Draft, read, remove_left_behind};
use etcetera::base_strategy::{BaseStrategy as _, choose_base_strategy};

/// Most bytes of all entries together.
const MOST: u64 = 512 << 20;

/// A folder of entries, each a file called by its key. Those read longest ago are removed where there are too many.
#[derive(Debug)]
pub struct Cache {
    folder: PathBuf,
    tidied: Once,
}

/// The size of a cache.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Size {
    /// Number of entries.
    pub entries: usize,
    /// Bytes of all entries.
    pub bytes: u64,
}

impl Cache {
    /// The cache in a folder, which is made when there is something to keep.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
            tidied: Once::new(),
        }
    }

    /// The cache of the user: the folder in the variable `APPELL_CACHE`, by default `appell` among the caches of the
    /// system; none if the variable is empty.
    pub fn of_user() -> Option<Self> {
        let folder = match std::env::var_os("APPELL_CACHE") {
            Some(folder) => {
                Some(PathBuf::from(folder)).filter(|folder| !folder.as_os_str().is_empty())
            }
            None => choose_base_strategy()
                .ok()
                .map(|folders| folders.cache_dir().join("appell")),
        };
        folder.map(Self::new)
    }

    /// Keeps functions here from now on, in the whole process.
    pub fn use_from_now_on(self) {
        keep_in(Box::new(self));
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Its size.
    pub fn size(&self) -> io::Result<Size> {
        let mut size = Size::default();
        for (_, bytes, _) in self.entries()? {
            size.entries += 1;
            size.bytes += bytes;
        }
        Ok(size)
    }

    /// Removes all entries; returns their size.
    pub fn clear(&self) -> io::Result<Size> {
        let size = self.size()?;
        for (path, ..) in self.entries()? {
            fs::remove_file(path)?;
        }
        Ok(size)
    }

    /// Path, bytes and time of the last use of each entry.
    fn entries(&self) -> io::Result<Vec<(PathBuf, u64, SystemTime)>> {
        let found = match fs::read_dir(&self.folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            found => found?,
        };
        let mut entries = Vec::new();
        for entry in found {
            let path = entry?.path();
            // Another process may remove it, and other files are not ours.
            if let Ok(about) = path.metadata()
                && path.extension().is_some_and(|end| end == ENDING)
            {
                entries.push((path, about.len(), about.modified()?));
            }
        }
        Ok(entries)
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(key).with_extension(ENDING)
    }

    fn write(&self, key: &str, entry: &[u8]) -> io::Result<()> {
        make_private(&self.folder)?;
        let mut draft = Draft::new(&self.path(key))?;
        draft.write_all(entry)?;
        draft.finish()
    }

    /// Removes what killed processes have left, and the entries used longest ago if there are too many.
    fn tidy(&self) -> io::Result<()> {
        remove_left_behind(&self.folder)?;
        let mut entries = self.entries()?;
        entries.sort_by_key(|(_, _, used)| *used);
        let mut bytes: u64 = entries.iter().map(|(_, bytes, _)| bytes).sum();
        for (path, size, _) in entries {
            if bytes <= MOST {
                break;
            }
            fs::remove_file(path)?;
            bytes = bytes.saturating_sub(size);
        }
        Ok(())
    }
}

const ENDING: &str = "tape";

impl Store for Cache {
    fn get(&self, key: &str) -> Option<Vec<u8>> {
        let path = self.path(key);
        let entry = read(&path, MOST).ok()?;
        // Without the time of its use it is merely removed earlier.
        let now = FileTimes::new().set_modified(SystemTime::now());
        drop(
            File::options()
                .append(true)
                .open(&path)
                .map(|file| file.set_times(now)),
        );
        Some(entry)
    }

    /// Where nothing can be written, functions are derived in every run.
    fn put(&self, key: &str, entry: &[u8]) {
        drop(self.write(key, entry));
        self.tidied.call_once(|| drop(self.tidy()));
    }
}

/// Makes a folder that only the user may read.
fn make_private(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}
