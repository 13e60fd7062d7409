//! Output files of a command: each a file of its own, with an extension that fits its format.

use std::path::{Path, PathBuf};

use clap::ArgMatches;

use crate::failure::Error;
use appell::files;

/// Flags that name an output file, each with the extensions of its format.
const FLAGS: &[(&str, &[&str])] = &[
    ("json", &["json"]),
    ("csv", &["csv"]),
    ("table", &["csv"]),
    ("experiment", &["csv"]),
    ("html", &["html", "htm"]),
    ("write", &["toml"]),
    // Figures and derivations follow their extension.
    ("plot", &[]),
    ("out", &[]),
];

/// Extensions that imply a format.
const PROMISES: &[&str] = &[
    "json", "csv", "html", "htm", "toml", "svg", "png", "pdf", "tex", "rs", "txt",
];

/// Rejects two results for one file or stream, and a file whose extension implies another format.
pub(crate) fn check(command: &ArgMatches) -> Result<(), Error> {
    let mut taken: Vec<(&str, PathBuf)> = Vec::new();
    for (flag, extensions) in FLAGS {
        // A command has some of these flags.
        let Ok(Some(mut values)) = command.try_get_raw(flag) else {
            continue;
        };
        let Some(path) = values.next().map(PathBuf::from) else {
            continue;
        };
        if let Some((other, _)) = taken.iter().find(|(_, there)| *there == path) {
            return Err(Error::Usage(if files::is_stdout(&path) {
                format!(
                    "`--{other} -` and `--{flag} -` would mix on standard output: write one of them to a file"
                )
            } else {
                let path = path.display();
                format!(
                    "`--{other}` and `--{flag}` both name `{path}`: the second would replace the first"
                )
            }));
        }
        fits(flag, &path, extensions)?;
        taken.push((flag, path));
    }
    Ok(())
}

fn fits(flag: &str, path: &Path, extensions: &[&str]) -> Result<(), Error> {
    let Some(found) = extension(path) else {
        return Ok(());
    };
    let found = found.as_str();
    if extensions.is_empty() || extensions.contains(&found) || !PROMISES.contains(&found) {
        return Ok(());
    }
    let instead = path.with_extension(extensions[0]);
    Err(Error::Usage(format!(
        "`--{flag} {}` would hold {}, not .{found}: write `--{flag} {}`",
        path.display(),
        extensions[0].to_ascii_uppercase(),
        instead.display()
    )))
}

/// The extension of a file, in small letters.
pub(crate) fn extension(path: &Path) -> Option<String> {
    let extension = path.extension()?;
    Some(extension.to_string_lossy().to_ascii_lowercase())
}
