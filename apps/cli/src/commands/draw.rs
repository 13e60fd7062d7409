//! `appell draw`

use std::path::PathBuf;

use crate::engine;
use crate::failure::Error;
use crate::{picture, progress};
use appell::setup::Assignment;

/// Draws the mechanism at its initial state, angles marked, as SVG, PNG or PDF.
///
/// Mistakes in a spec, such as the sign of an angle, are often visible at once.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell draw unicycle
  appell draw my_pendulum.toml --initial theta=60deg --out tilted.svg")]
pub(crate) struct Draw {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// A parameter, such as R=0.3 or R=30cm
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// An initial value; the others are those of the spec
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    initial: Vec<Assignment>,
    /// Output file, `-` is standard output [default: name of the mechanism with `.svg`]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Draw {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = engine::source(&self.model)?;
        let svg = progress::during("deriving the equations of motion", |_| {
            source.drawing_at(&self.set, &self.initial)
        })?;
        let out = match &self.out {
            Some(out) => out.clone(),
            None => format!("{}.svg", source.mechanism()?.name).into(),
        };
        picture::write(&out, &svg)
    }
}
