//! `appell sample`

use std::path::PathBuf;

use crate::failure::Error;
use crate::output;

/// Writes a folder to try the other commands with.
#[derive(Debug, clap::Args)]
pub(crate) struct Sample {
    #[command(subcommand)]
    what: What,
}

/// What there is to try.
#[derive(Debug, clap::Subcommand)]
enum What {
    /// A simulated rig with its spec, three recordings and their description: something moves it that its spec lacks
    Rig {
        /// The folder, which is made if it is not there; nothing is overwritten
        folder: PathBuf,
    },
}

impl Sample {
    pub(super) fn run(&self) -> Result<(), Error> {
        let What::Rig { folder } = &self.what;
        let files = appell::sample::rig(folder)?;
        let shown = folder.display();
        output::print(&format!(
            "wrote {} to {shown}; next:\n  appell recording {shown}\n  appell diagnose --data {shown} --html gap.html\n",
            files.join(", ")
        ))
    }
}
