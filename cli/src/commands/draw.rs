//! `appell draw`

use std::path::PathBuf;

use crate::failure::Error;
use crate::{picture, progress};
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
        let svg = source.drawing();
        spinner.finish_and_clear();
        let svg = svg?;
        let out = match &self.out {
            Some(out) => out.clone(),
            None => format!("{}.svg", source.mechanism()?.name).into(),
        };
        picture::write(&out, &svg)
    }
}
