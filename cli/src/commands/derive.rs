//! `appell derive`

use std::path::PathBuf;

use appell_codegen::emit::{Options, emit};
use appell_codegen::linearisation::{Linearisation, SteadyMotion};
use appell_codegen::program::FunctionKind;
use appell_codegen::{Derived, compile::report, derived};
use appell_report::derivation::{self, Page, page};

use crate::progress;
use appell::Error;
use appell::conditions::conditions;
use appell::files;
use appell::source::Source;

/// Writes the derivation, from frames to equations of motion.
///
/// Readable from top to bottom as text, LaTeX or HTML; or emitted as Rust.
#[derive(Debug, clap::Args)]
pub(crate) struct Derive {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Last stage of the page. Each stage includes all earlier ones, except `equations`, the handout,
    /// which leaves out what it does not need. Rust is always complete
    #[arg(long, value_enum, default_value_t = Stage::Equations)]
    stage: Stage,
    /// Values in the steady motion, for `--stage linear`: `theta=0, dot(psi)=0`. States, rates and
    /// inputs that are not given stay symbolic
    #[arg(long, value_name = "CONDITIONS")]
    about: Vec<String>,
    /// Write to a file instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// The output format of a derivation.
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

/// The last stage of a page.
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
    /// Only the linear equations about a steady motion: A, B, characteristic polynomial
    Linear,
}

impl Derive {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = Source::find(&self.model)?;
        let linear = self.stage == Stage::Linear && self.format != Format::Rust;
        if !linear && !self.about.is_empty() {
            let message = "--about needs --stage linear, as text, latex or html";
            return Err(Error::Usage(message.to_owned()));
        }
        let text = derivation(&source, self.format, self.stage, &self.about)?;
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text)
    }
}

/// The derivation of a spec; `about` are the conditions of the motion for [`Stage::Linear`].
pub(super) fn derivation(
    source: &Source,
    format: Format,
    stage: Stage,
    about: &[String],
) -> Result<String, Error> {
    if format == Format::Rust {
        return rust(source);
    }
    let spinner = progress::spinner("deriving the equations of motion");
    let mut derived = derived(&source.file, &source.text)?;
    let stage = match stage {
        Stage::Kinematics => Some(derivation::Stage::Kinematics),
        Stage::Energy => Some(derivation::Stage::Energy),
        Stage::Equations => Some(derivation::Stage::Equations),
        Stage::Jacobians => Some(derivation::Stage::Jacobians),
        Stage::All => Some(derivation::Stage::All),
        Stage::Linear => None,
    };
    let page = match stage {
        Some(stage) => page(&derived.mechanism, &mut derived.derivation, stage)
            .map_err(|findings| report(&derived.mechanism, &source.text, &findings))?,
        None => linear(&source.text, &mut derived, about)?,
    };
    spinner.finish_and_clear();
    Ok(match format {
        Format::Latex => derivation::latex(&page),
        Format::Html => derivation::html(&page),
        Format::Text | Format::Rust => derivation::text(&page),
    })
}

/// The linear equations about a steady motion.
fn linear(spec: &str, derived: &mut Derived, about: &[String]) -> Result<Page, Error> {
    let Derived {
        mechanism,
        derivation,
        ..
    } = derived;
    let conditions = conditions("--about", spec, mechanism, derivation, about)?;
    let steady = SteadyMotion::new(mechanism, derivation, &conditions);
    let linear = steady.and_then(|steady| Linearisation::about(derivation, steady));
    let linear = linear.map_err(|error| Error::Usage(format!("--about: {error}")))?;
    Ok(derivation::linear(mechanism, derivation, &linear))
}

/// The emitted module of a spec.
fn rust(source: &Source) -> Result<String, Error> {
    if let Some(shipped) = source.shipped {
        return Ok(shipped.code.to_owned());
    }
    let spinner = progress::spinner("deriving the equations of motion");
    let program = appell_codegen::compile(&source.file, &source.text, &FunctionKind::STANDARD)?;
    let options = Options {
        spec: Some(source.text.clone()),
        ..Options::default()
    };
    let emitted =
        emit(&program, &options).map_err(|error| Error::Computation(error.to_string()))?;
    spinner.finish_and_clear();
    Ok(emitted.source)
}
