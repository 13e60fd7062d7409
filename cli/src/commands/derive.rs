//! `appell derive`

use std::path::PathBuf;

use appell::derivation::{Format, Stage};
use appell::{Source, files};

use crate::choice::{Choice, one_of};
use crate::destinations::extension;
use crate::failure::Error;
use crate::progress;

/// Writes the derivation, from frames to equations of motion.
///
/// Readable from top to bottom as text, LaTeX or HTML; or emitted as Rust.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell derive unicycle
  appell derive my_pendulum.toml --out derivation.html
  appell derive unicycle --stage linear --about \"theta=0, r=0, dot(psi)=0, u=0\"")]
pub(crate) struct Derive {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// Output format [default: that of the extension of `--out`, else text]
    #[arg(long, value_parser = one_of(&FORMATS))]
    format: Option<Output>,
    /// Last stage of the page. Each stage includes all earlier ones, except `equations`, the handout,
    /// which leaves out what it does not need. Rust is always complete
    #[arg(long, default_value = "equations", value_parser = one_of(&EXTENTS))]
    stage: Extent,
    /// Values in the steady motion, for `--stage linear`: `theta=0, dot(psi)=0`. States, rates and
    /// inputs that are not given stay symbolic
    #[arg(long, value_name = "CONDITIONS")]
    about: Vec<String>,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Output {
    Page(Format),
    Rust,
    Python,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Extent {
    Through(Stage),
    Linear,
}

const FORMATS: [Choice<Output>; 5] = [
    (
        "text",
        "Unicode, for a terminal",
        Output::Page(Format::Text),
    ),
    ("latex", "A document for LaTeX", Output::Page(Format::Latex)),
    ("html", "A page for a browser", Output::Page(Format::Html)),
    (
        "rust",
        "The module that a build script includes",
        Output::Rust,
    ),
    (
        "python",
        "Functions for NumPy, JAX, CasADi and SymPy alike",
        Output::Python,
    ),
];

/// What a file holds by its extension.
const ENDS: [(&str, Output); 6] = [
    ("txt", Output::Page(Format::Text)),
    ("md", Output::Page(Format::Text)),
    ("tex", Output::Page(Format::Latex)),
    ("html", Output::Page(Format::Html)),
    ("htm", Output::Page(Format::Html)),
    ("rs", Output::Rust),
];

const EXTENTS: [Choice<Extent>; 6] = [
    (
        "kinematics",
        "Frames, constraints, velocities, accelerations",
        Extent::Through(Stage::Kinematics),
    ),
    (
        "energy",
        "Acceleration energy, mass matrix, bias",
        Extent::Through(Stage::Energy),
    ),
    (
        "equations",
        "Pseudo-forces, Appell's equations, accelerations",
        Extent::Through(Stage::Equations),
    ),
    (
        "jacobians",
        "Jacobians of the motion",
        Extent::Through(Stage::Jacobians),
    ),
    (
        "all",
        "Constraint forces and outputs as well",
        Extent::Through(Stage::All),
    ),
    (
        "linear",
        "Only the linear equations about a steady motion: A, B, characteristic polynomial",
        Extent::Linear,
    ),
];

impl Derive {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = Source::find(&self.model)?;
        let format = self.format()?;
        let linear = self.stage == Extent::Linear && format != Output::Rust;
        if !linear && !self.about.is_empty() {
            let message = "--about needs --stage linear, as text, latex or html";
            return Err(Error::Usage(message.to_owned()));
        }
        let spinner = progress::spinner("deriving the equations of motion");
        let text = match (format, self.stage) {
            (Output::Rust, _) => source.rust(),
            (Output::Python, _) => source.python(),
            (Output::Page(format), Extent::Through(stage)) => source.derivation(stage, format),
            (Output::Page(format), Extent::Linear) => source.linear_equations(&self.about, format),
        };
        spinner.finish_and_clear();
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text?)?;
        Ok(())
    }

    /// The format that is asked for, by its name or by that of the file.
    fn format(&self) -> Result<Output, Error> {
        let extension = self.out.as_deref().and_then(extension);
        let promised = extension.as_ref().map(|extension| {
            let ends = ENDS.iter().find(|(end, _)| end == extension);
            ends.map(|(_, format)| *format)
        });
        match (self.format, promised) {
            (format, None) => Ok(format.unwrap_or(Output::Page(Format::Text))),
            (None, Some(Some(promised))) => Ok(promised),
            (Some(format), Some(Some(promised))) if format == promised => Ok(format),
            // An extension of one's own promises nothing.
            (Some(format), Some(None)) => Ok(format),
            _ => Err(Error::Usage(format!(
                "a derivation as `.{}`: choose a name that ends in .txt (text), .tex (LaTeX), .html or .rs (Rust), \
                 without another `--format`",
                extension.unwrap_or_default()
            ))),
        }
    }
}
