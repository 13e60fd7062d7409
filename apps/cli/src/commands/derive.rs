//! `appell derive`

use std::path::PathBuf;

use appell::derivation::{Format, Stage};
use appell::{Source, files};
use appell_codegen::c;
use appell_codegen::program::FunctionKind;

use crate::choice::{Choice, one_of};
use crate::destinations::extension;
use crate::engine;
use crate::failure::Error;
use crate::{output, progress};

/// Writes the derivation, from frames to equations of motion.
///
/// Readable from top to bottom as text, LaTeX or HTML; or emitted as Rust; or the spec itself, with its
/// joints written out.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell derive unicycle
  appell derive my_pendulum.toml --out derivation.html
  appell derive unicycle --out unicycle.c
  appell derive unicycle --out unicycle.py
  appell derive my_pendulum.toml --format spec
  appell derive unicycle --stage linear --about \"theta=0, r=0, dot(psi)=0, u=0\"")]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub(crate) struct Derive {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// Output format [default: that of the extension of `--out`, else text]
    #[arg(long, value_parser = one_of(&FORMATS))]
    format: Option<Output>,
    /// Last stage of the page. Each stage includes all earlier ones, except `equations`, the handout,
    /// which omits unnecessary quantities. Rust is always complete
    #[arg(long, default_value = "equations", value_parser = one_of(&EXTENTS))]
    stage: Extent,
    /// Values in the steady motion, for `--stage linear`: `theta=0, dot(psi)=0`. States, rates and
    /// inputs that are not given stay symbolic
    #[arg(long, value_name = "CONDITIONS")]
    about: Vec<String>,
    /// C, CUDA: numbers of 32 bits instead of 64
    #[arg(long)]
    float: bool,
    /// C, CUDA: a step of the classical Runge-Kutta method as well
    #[arg(long)]
    integrator: bool,
    /// Rust, C, CUDA, Python: inverse dynamics as a linear function of inertial and load parameters instead
    #[arg(long)]
    regressor: bool,
    /// Rust, C, CUDA, Python: derivatives of the rates by the parameters as well where there are more than 64
    #[arg(long)]
    parameter_jacobian: bool,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Output {
    Page(Format),
    Rust,
    C,
    Cuda,
    Python,
    Spec,
}

impl Output {
    /// Whether it is a page for a reader, which has stages.
    const fn is_page(self) -> bool {
        matches!(self, Self::Page(_))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Extent {
    Through(Stage),
    Linear,
}

const FORMATS: [Choice<Output>; 8] = [
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
        "c",
        "C99: `--out NAME.c` writes source and header",
        Output::C,
    ),
    (
        "cuda",
        "CUDA C++, one source: functions, and kernels for many places, one thread each",
        Output::Cuda,
    ),
    (
        "python",
        "Functions for NumPy, JAX, CasADi and SymPy alike",
        Output::Python,
    ),
    (
        "spec",
        "The spec with `[joints]` expanded into other sections",
        Output::Spec,
    ),
];

/// Formats by file extension.
const ENDS: [(&str, Output); 10] = [
    ("txt", Output::Page(Format::Text)),
    ("md", Output::Page(Format::Text)),
    ("tex", Output::Page(Format::Latex)),
    ("html", Output::Page(Format::Html)),
    ("htm", Output::Page(Format::Html)),
    ("rs", Output::Rust),
    ("c", Output::C),
    ("cu", Output::Cuda),
    ("py", Output::Python),
    ("toml", Output::Spec),
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
        let source = engine::source(&self.model)?;
        let format = self.format()?;
        let linear = self.stage == Extent::Linear && format.is_page();
        if !linear && !self.about.is_empty() {
            let message = "--about needs --stage linear, as text, latex or html";
            return Err(Error::Usage(message.to_owned()));
        }
        if self.regressor && self.integrator {
            let message = "--integrator needs the rates, which a regressor does not include";
            return Err(Error::Usage(message.to_owned()));
        }
        if !matches!(format, Output::C | Output::Cuda) && (self.float || self.integrator) {
            let message = "--float and --integrator need --format c or cuda";
            return Err(Error::Usage(message.to_owned()));
        }
        if self.regressor && format.is_page() {
            let message = "--regressor needs --format rust, c, cuda or python";
            return Err(Error::Usage(message.to_owned()));
        }
        let spinner = progress::spinner("deriving the equations of motion");
        let functions = self.functions(&source);
        let text = match (format, self.stage) {
            (Output::C, _) => {
                let emitted = source.c(&self.c_options(functions?));
                spinner.finish_and_clear();
                return self.write_c(&emitted?);
            }
            (Output::Cuda, _) => {
                functions.and_then(|functions| source.cuda(&self.c_options(functions)))
            }
            (Output::Rust, _) => functions.and_then(|functions| source.rust(&functions)),
            (Output::Python, _) => functions.and_then(|functions| source.python(&functions)),
            (Output::Spec, _) => source.expanded(),
            (Output::Page(format), Extent::Through(stage)) => source.derivation(stage, format),
            (Output::Page(format), Extent::Linear) => source.linear_equations(&self.about, format),
        };
        spinner.finish_and_clear();
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text?)?;
        Ok(())
    }

    fn functions(&self, source: &Source) -> Result<Vec<FunctionKind>, appell::Error> {
        if self.regressor {
            Ok(vec![FunctionKind::Regressor])
        } else if self.parameter_jacobian {
            Ok(FunctionKind::STANDARD.to_vec())
        } else {
            source.functions()
        }
    }

    fn c_options(&self, functions: Vec<FunctionKind>) -> c::Options {
        c::Options {
            functions,
            real: if self.float {
                c::Real::Float
            } else {
                c::Real::Double
            },
            integrator: self.integrator,
        }
    }

    /// Writes source and header, which bear the name of the mechanism.
    fn write_c(&self, emitted: &c::Emitted) -> Result<(), Error> {
        let name = &emitted.name;
        let file = self.out.as_deref();
        let Some(file) =
            file.filter(|file| file.file_stem().is_some_and(|stem| stem == name.as_str()))
        else {
            let message =
                format!("C is a source and a header: write `--out {name}.c`, in any folder");
            return Err(Error::Usage(message));
        };
        let header = file.with_extension("h");
        files::write(&header, &emitted.header)?;
        files::write(file, &emitted.source)?;
        output::print(&format!(
            "wrote {} and {}\n",
            file.display(),
            header.display()
        ))
    }

    /// The format, stated or by the file extension.
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
            // An unknown extension implies no format.
            (Some(format), Some(None)) => Ok(format),
            _ => Err(Error::Usage(format!(
                "a derivation as `.{}`: choose a name that ends in .txt (text), .tex (LaTeX), .html, .rs (Rust), .c, .cu (CUDA), .py (Python) or .toml (spec), \
                 without another `--format`",
                extension.unwrap_or_default()
            ))),
        }
    }
}
