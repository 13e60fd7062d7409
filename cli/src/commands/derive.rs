//! `appell derive`

use std::path::PathBuf;

use appell_codegen::emit::{Options, emit};
use appell_codegen::page::{self, page};
use appell_codegen::program::FunctionKind;
use appell_codegen::{Derived, compile::report, derived};

use crate::failure::Failure;
use crate::source::Source;
use crate::{files, progress};

/// Writes the derivation, from frames to equations of motion.
///
/// It is readable from top to bottom as text, LaTeX or HTML, or it is Rust.
#[derive(Debug, clap::Args)]
pub(crate) struct Derive {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// How it is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// How far the page reads; each stage holds everything before it, only `equations`, the
    /// handout, leaves out what it does not need. Rust is always complete
    #[arg(long, value_enum, default_value_t = Stage::Equations)]
    stage: Stage,
    /// Write to a file instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// How a derivation is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// Unicode, for a terminal
    Text,
    /// A document for LaTeX
    Latex,
    /// A page for a browser
    Html,
    /// The module that a build script includes
    Rust,
}

/// How far a page reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Stage {
    /// Frames, constraints, velocities, accelerations
    Kinematics,
    /// Acceleration energy, mass matrix, bias
    Energy,
    /// Pseudo-forces, Appell's equations, accelerations
    Equations,
    /// Jacobians of the motion
    Jacobians,
    /// Constraint forces and outputs as well
    All,
}

impl Derive {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let source = Source::find(&self.model)?;
        let text = derivation(&source, self.format, self.stage)?;
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text)
    }
}

/// The derivation of a spec.
pub(super) fn derivation(source: &Source, format: Format, stage: Stage) -> Result<String, Failure> {
    if format == Format::Rust {
        return rust(source);
    }
    let spinner = progress::spinner("deriving the equations of motion");
    let Derived {
        mechanism,
        mut derivation,
        ..
    } = derived(&source.file, &source.text)?;
    let stage = match stage {
        Stage::Kinematics => page::Stage::Kinematics,
        Stage::Energy => page::Stage::Energy,
        Stage::Equations => page::Stage::Equations,
        Stage::Jacobians => page::Stage::Jacobians,
        Stage::All => page::Stage::All,
    };
    let page = page(&mechanism, &mut derivation, stage)
        .map_err(|findings| report(&mechanism, &source.text, &findings))?;
    spinner.finish_and_clear();
    Ok(match format {
        Format::Latex => page::latex(&page),
        Format::Html => page::html(&page),
        Format::Text | Format::Rust => page::text(&page),
    })
}

/// The emitted module of a spec.
fn rust(source: &Source) -> Result<String, Failure> {
    if let Some(shipped) = source.shipped {
        return Ok(shipped.code.to_owned());
    }
    let spinner = progress::spinner("deriving the equations of motion");
    let program = appell_codegen::compile(&source.file, &source.text, &FunctionKind::ALL)?;
    let options = Options {
        spec: Some(source.text.clone()),
        ..Options::default()
    };
    let emitted =
        emit(&program, &options).map_err(|error| Failure::Computation(error.to_string()))?;
    spinner.finish_and_clear();
    Ok(emitted.source)
}
