//! `appell lsp`

use crate::failure::Error;

/// Serves an editor that writes specs: findings, meanings of names, renaming, completion.
///
/// The editor starts it and speaks the language server protocol over standard input and output.
/// `docs/editors.md` tells how VS Code, Neovim and Helix are set up.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell lsp")]
pub(crate) struct Lsp {}

impl Lsp {
    pub(super) fn run(self) -> Result<(), Error> {
        let Self {} = self;
        let served = appell_lsp::serve_stdio();
        served.map_err(|cause| Error::Computation(format!("the language server: {cause}")))
    }
}
