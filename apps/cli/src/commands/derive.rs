//! `appell derive`

use std::path::PathBuf;

use appell::derivation::{Format, Stage};
use appell::{Source, files};
use appell_codegen::c;
use appell_codegen::program::FunctionKind;

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
    #[arg(long, value_enum)]
    format: Option<Output>,
    /// Last stage of the page. Each stage includes all earlier ones, except `equations`, the handout,
    /// which omits unnecessary quantities. Rust is always complete
    #[arg(long, default_value = "equations", value_enum)]
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

/// The output formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Output {
    /// Unicode, for a terminal
    Text,
    /// A document for LaTeX
    Latex,
    /// A page for a browser
    Html,
    /// The module that a build script includes
    Rust,
    /// C99: `--out NAME.c` writes source and header
    C,
    /// CUDA C++, one source: functions, and kernels for many places, one thread each
    Cuda,
    #[value(help = "Functions for NumPy, JAX, CasADi and SymPy alike")]
    Python,
    /// The spec with `[joints]` expanded into other sections
    Spec,
}

impl Output {
    /// Whether it is a page for a reader, which has stages.
    const fn is_page(self) -> bool {
        matches!(self, Self::Text | Self::Latex | Self::Html)
    }
}

/// How far a page goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Extent {
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

/// Formats by file extension.
const ENDS: [(&str, Output); 10] = [
    ("txt", Output::Text),
    ("md", Output::Text),
    ("tex", Output::Latex),
    ("html", Output::Html),
    ("htm", Output::Html),
    ("rs", Output::Rust),
    ("c", Output::C),
    ("cu", Output::Cuda),
    ("py", Output::Python),
    ("toml", Output::Spec),
];

impl Derive {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = engine::source(&self.model)?;
        let format = self.format()?;
        let is_c = matches!(format, Output::C | Output::Cuda);
        let is_linear = self.stage == Extent::Linear && format.is_page();
        let rules = [
            (
                !is_linear && !self.about.is_empty(),
                "--about needs --stage linear, as text, latex or html",
            ),
            (
                self.regressor && self.integrator,
                "--integrator needs the rates, which a regressor does not include",
            ),
            (
                !is_c && (self.float || self.integrator),
                "--float and --integrator need --format c or cuda",
            ),
            (
                self.regressor && format.is_page(),
                "--regressor needs --format rust, c, cuda or python",
            ),
        ];
        if let Some((_, message)) = rules.iter().find(|(is_broken, _)| *is_broken) {
            return Err(Error::Usage((*message).to_owned()));
        }
        let deriving = "deriving the equations of motion";
        if format == Output::C {
            let emitted = progress::during(deriving, |_| {
                source.c(&self.c_options(self.functions(&source)?))
            })?;
            return self.write_c(&emitted);
        }
        let text = progress::during(deriving, |_| self.text(&source, format))?;
        files::write(self.out.as_deref().unwrap_or("-".as_ref()), &text)?;
        Ok(())
    }

    /// The derivation as one text.
    fn text(&self, source: &Source, format: Output) -> Result<String, appell::Error> {
        let functions = || self.functions(source);
        let format = match format {
            Output::C | Output::Cuda => return source.cuda(&self.c_options(functions()?)),
            Output::Rust => return source.rust(&functions()?),
            Output::Python => return source.python(&functions()?),
            Output::Spec => return source.expanded(),
            Output::Text => Format::Text,
            Output::Latex => Format::Latex,
            Output::Html => Format::Html,
        };
        let stage = match self.stage {
            Extent::Kinematics => Stage::Kinematics,
            Extent::Energy => Stage::Energy,
            Extent::Equations => Stage::Equations,
            Extent::Jacobians => Stage::Jacobians,
            Extent::All => Stage::All,
            Extent::Linear => return source.linear_equations(&self.about, format),
        };
        source.derivation(stage, format)
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
            (format, None) => Ok(format.unwrap_or(Output::Text)),
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
