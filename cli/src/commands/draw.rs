//! `appell draw`

use std::path::{Path, PathBuf};

use appell_codegen::{Derived, compile::report, derived};
use appell_report::drawing::drawing;

use crate::{picture, progress};
use appell::Error;
use appell::source::Source;

/// Draws the mechanism at its initial state, as SVG.
///
/// Mistakes in a spec, such as the sign of an angle, are often visible at once.
#[derive(Debug, clap::Args)]
pub(crate) struct Draw {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// Output file, `-` is standard output [default: name of the mechanism with `.svg`]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Draw {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = Source::find(&self.model)?;
        let spinner = progress::spinner("deriving the equations of motion");
        let Derived {
            mechanism,
            derivation,
            ..
        } = derived(&source.file, &source.text)?;
        let svg = drawing(&mechanism, derivation)
            .map_err(|findings| report(&mechanism, &source.text, &findings))?;
        spinner.finish_and_clear();
        let default = format!("{}.svg", mechanism.name);
        picture::write(self.out.as_deref().unwrap_or(Path::new(&default)), &svg)
    }
}
