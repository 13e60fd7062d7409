//! `appell derive`

use std::path::PathBuf;

use appell_codegen::emit::{Options, emit};
use appell_codegen::mechanics::assemble::ALL;

use crate::failure::Failure;
use crate::source::Source;
use crate::{files, progress};

/// The equations of motion, readable from top to bottom, or as Rust.
#[derive(Debug, clap::Args)]
pub(crate) struct Derive {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// How it is written
    #[arg(long, value_enum, default_value_t = Format::Rust)]
    format: Format,
    /// Write to a file instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// How a derivation is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// The module that a build script includes.
    Rust,
}

impl Derive {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let source = Source::find(&self.model)?;
        let text = match self.format {
            Format::Rust => rust(&source)?,
        };
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text)
    }
}

/// The emitted module of a spec.
pub(super) fn rust(source: &Source) -> Result<String, Failure> {
    if let Some(shipped) = source.shipped {
        return Ok(shipped.code.to_owned());
    }
    let spinner = progress::spinner("deriving the equations of motion");
    let program = appell_codegen::compile(&source.file, &source.text, &ALL)
        .map_err(|report| Failure::Reports(vec![report]))?;
    let options = Options { spec: Some(source.text.clone()), ..Options::default() };
    let emitted = emit(&program, &options).map_err(|error| Failure::Computation(error.to_string()))?;
    spinner.finish_and_clear();
    Ok(emitted.source)
}
