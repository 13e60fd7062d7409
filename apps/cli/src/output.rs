//! Text output, kept apart from files on standard output.

use std::path::{Path, PathBuf};

use crate::failure::Error;
use appell::files;
use appell_spec::visible;
use console::Term;
use serde::Serialize;

use crate::failure::tell;

/// Writes to standard output, with hidden characters of foreign texts escaped.
pub(crate) fn print(text: &str) -> Result<(), Error> {
    Ok(files::to_stdout(|to| {
        to.write_all(visible(text).as_bytes())
    })?)
}

/// Writes to standard output, or to standard error if one of the files is standard output.
pub(crate) fn print_beside(text: &str, files: &[&Option<PathBuf>]) -> Result<(), Error> {
    let mut files = files.iter().filter_map(|file| file.as_ref());
    if files.any(|path| files::is_stdout(path)) {
        tell(text);
        return Ok(());
    }
    print(text)
}

/// Writes a result as JSON to a file that was asked for.
pub(crate) fn json<V: Serialize>(
    file: Option<&Path>,
    value: impl FnOnce() -> V,
) -> Result<(), Error> {
    file.map_or(Ok(()), |path| Ok(files::write_json(path, &value())?))
}

/// The width of the terminal that shows standard output, if one does.
pub(crate) fn columns() -> Option<usize> {
    let (_, columns) = Term::stdout().size_checked()?;
    Some(columns.into())
}

/// A word of a command, in quotes where a shell would split or expand it.
pub(crate) fn shell(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}
