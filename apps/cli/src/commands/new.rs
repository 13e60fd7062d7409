//! `appell new`

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;

use crate::failure::Error;
use crate::output;

/// Writes a commented spec to start from.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell new my_pendulum")]
pub(crate) struct New {
    /// Name of the mechanism: a letter, then letters, digits and `_`
    name: String,
}

impl New {
    pub(super) fn run(&self) -> Result<(), Error> {
        let text =
            appell_spec::starter(&self.name).map_err(|error| Error::Usage(error.to_string()))?;
        let path = PathBuf::from(format!("{}.toml", self.name));
        // Creation fails if the file exists: nothing is overwritten.
        let created = OpenOptions::new().write(true).create_new(true).open(&path);
        match created.and_then(|mut file| file.write_all(text.as_bytes())) {
            Ok(()) => output::print(&format!(
                "wrote {path}; next:\n  appell check {path}\n  appell simulate {path} --plot {name}.svg\n",
                path = path.display(),
                name = self.name
            )),
            Err(cause) if cause.kind() == ErrorKind::AlreadyExists => Err(Error::Usage(format!(
                "{} already exists; choose another name, or remove the file",
                path.display()
            ))),
            Err(cause) => Err(appell::Error::writing(&path)(cause).into()),
        }
    }
}
