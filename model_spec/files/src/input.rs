//! Reading of untrusted files.

use std::fs::{File, FileType};
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

/// Why a file is not read. Messages never quote the contents of the file.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// A pipe, a device, a socket or a folder.
    #[error("{}: this is {kind}; name a regular file", path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
        /// The kind of file, with its article.
        kind: &'static str,
    },
    /// The file is too large.
    #[error("{}: the file exceeds the limit of {}", path.display(), size(*most))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its maximum size in bytes.
        most: u64,
    },
    /// The file is not text.
    #[error("{}:{line}: the file is not UTF-8 text", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// The first line that is not text.
        line: usize,
    },
    /// A file references one outside of its folder.
    #[error(
        "`{}` is not below {}: copy the file there",
        named.escape_debug(), folder(root)
    )]
    Outside {
        /// The path as written in the file.
        named: String,
        /// The folder.
        root: PathBuf,
    },
    /// An error of the operating system.
    #[error("cannot read {}: {cause}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// Its error.
        #[source]
        cause: io::Error,
    },
}

/// A size with its unit.
fn size(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} bytes"),
        1024..0x10_0000 => format!("{} KiB", bytes >> 10),
        _ => format!("{} MiB", bytes >> 20),
    }
}

fn folder(path: &Path) -> String {
    if path.as_os_str().is_empty() {
        "the folder of the file that names it".to_owned()
    } else {
        format!("`{}`", path.display())
    }
}

/// Opens a regular file of at most `most` bytes.
pub fn open(path: &Path, most: u64) -> Result<File, FileError> {
    let system = |cause| FileError::System {
        path: path.to_owned(),
        cause,
    };
    // Checked before opening, as opening a pipe blocks until there is a writer.
    regular(path, std::fs::metadata(path).map_err(system)?.file_type())?;
    let file = File::open(path).map_err(system)?;
    let about = file.metadata().map_err(system)?;
    regular(path, about.file_type())?;
    if about.len() > most {
        Err(too_large(path, most))
    } else {
        Ok(file)
    }
}

/// The bytes of a regular file of at most `most` bytes.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    // The limit also covers growing files, and files of the kernel that report no length.
    let read = open(path, most)?
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes);
    let count = read.map_err(|cause| FileError::System {
        path: path.to_owned(),
        cause,
    })?;
    if count as u64 > most {
        Err(too_large(path, most))
    } else {
        Ok(bytes)
    }
}

/// The text of a regular file of at most `most` bytes.
pub fn read_text(path: &Path, most: u64) -> Result<String, FileError> {
    String::from_utf8(read(path, most)?).map_err(|cause| {
        let before = &cause.as_bytes()[..cause.utf8_error().valid_up_to()];
        FileError::NotText {
            path: path.to_owned(),
            line: before.split(|byte| *byte == b'\n').count(),
        }
    })
}

/// The path of a file that is referenced by a file in `folder`. It must lie below `root`, also after
/// symbolic links are resolved.
///
/// A file that does not exist is no error here, so that the caller can report it.
pub fn within(root: &Path, folder: &Path, named: &str) -> Result<PathBuf, FileError> {
    let outside = || FileError::Outside {
        named: named.to_owned(),
        root: root.to_owned(),
    };
    if Path::new(named).has_root() {
        return Err(outside());
    }
    let path = folder.join(named);
    let here =
        |path: &Path| std::path::absolute(Path::new(".").join(path)).map(|path| plain(&path));
    let is_below = here(&path).and_then(|path| Ok(path.starts_with(here(root)?)));
    if !is_below.unwrap_or(false) {
        return Err(outside());
    }
    // A file that is missing or not accessible cannot be resolved.
    let real = |path: &Path| Path::new(".").join(path).canonicalize();
    match (real(&path), real(root)) {
        (Ok(target), Ok(root)) if !target.starts_with(&root) => Err(outside()),
        _ => Ok(path),
    }
}

/// The path of a file that is referenced by a file in the folder `root`. It must lie below this folder.
pub fn below(root: &Path, named: &str) -> Result<PathBuf, FileError> {
    within(root, root, named)
}

/// An absolute path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

fn too_large(path: &Path, most: u64) -> FileError {
    FileError::TooLarge {
        path: path.to_owned(),
        most,
    }
}

fn regular(path: &Path, kind: FileType) -> Result<(), FileError> {
    if kind.is_file() {
        return Ok(());
    }
    Err(FileError::NotRegular {
        path: path.to_owned(),
        kind: if kind.is_dir() {
            "a folder"
        } else {
            "a pipe, a socket or a device"
        },
    })
}
