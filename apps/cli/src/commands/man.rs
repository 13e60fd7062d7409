//! `appell man`

use std::path::PathBuf;

use clap::CommandFactory as _;

use super::Arguments;
use crate::failure::Error;
use crate::output;
use appell::files;

/// Writes the manual pages, one for each command.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell man ~/.local/share/man/man1
  appell man man && man -l man/appell-simulate.1")]
pub(crate) struct Man {
    /// Output folder, created if missing
    folder: PathBuf,
}

impl Man {
    pub(super) fn run(&self) -> Result<(), Error> {
        let failed = |cause| appell::Error::writing(&self.folder)(cause);
        files::make_folder(&self.folder)?;
        clap_mangen::generate_to(Arguments::command(), &self.folder).map_err(failed)?;
        let folder = self.folder.display();
        output::print(&format!(
            "wrote appell.1 and those of the commands to {folder}\n"
        ))
    }
}
