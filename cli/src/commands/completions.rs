//! `appell completions`

use clap::CommandFactory as _;

use super::Arguments;
use crate::failure::Error;
use crate::output;

/// Writes shell completions to standard output.
///
/// For bash: `appell completions bash > ~/.local/share/bash-completion/completions/appell`
#[derive(Debug, clap::Args)]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub(super) fn run(&self) -> Result<(), Error> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Arguments::command(), "appell", &mut script);
        output::print(&String::from_utf8_lossy(&script))
    }
}
