//! Files that are read.

use std::fs::{File, FileType};
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

/// Why a file is not read. No message holds a part of the file.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// A pipe, a device, a socket or a folder.
    #[error("{}: this is {kind}; name a regular file", path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
        /// What it is instead.
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
    /// A file names one that does not lie below its folder.
    #[error(
        "`{}` is not below {}: copy the file there, or name it on the command line",
        named.escape_debug(), folder(root)
    )]
    Outside {
        /// The name in the file.
        named: String,
        /// The folder.
        root: PathBuf,
    },
    /// The operating system refuses.
    #[error("cannot read {}: {cause}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// Its error.
        #[source]
        cause: io::Error,
    },
}

/// A size in words.
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
    // Before it is opened: to open a pipe waits for who writes to it.
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
    // A file that grows meanwhile, or one of the kernel that has no length, is read no further.
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

/// The path of a file that another one names: below `root`, the folder of the latter, also when links are followed.
///
/// A file that does not exist has a path as well, so that the caller can say so.
pub fn below(root: &Path, named: &str) -> Result<PathBuf, FileError> {
    let outside = || FileError::Outside {
        named: named.to_owned(),
        root: root.to_owned(),
    };
    let mut depth = 0_usize;
    for part in Path::new(named).components() {
        depth = match part {
            Component::Normal(_) => depth + 1,
            Component::CurDir => depth,
            Component::ParentDir => depth.checked_sub(1).ok_or_else(outside)?,
            Component::RootDir | Component::Prefix(_) => return Err(outside()),
        };
    }
    let path = root.join(named);
    let here = if root.as_os_str().is_empty() {
        Path::new(".")
    } else {
        root
    };
    // Without the file, or without the right to see it, there is nothing to follow.
    if let (Ok(target), Ok(root)) = (path.canonicalize(), here.canonicalize())
        && !target.starts_with(root)
    {
        return Err(outside());
    }
    Ok(path)
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
