//! For build scripts: compiles specs to Rust modules in `OUT_DIR`.
//!
//! ```ignore
//! // build.rs
//! fn main() {
//!     appell_codegen::build("mechanisms/furuta.toml");
//! }
//! ```
//!
//! ```ignore
//! // src/main.rs
//! mod furuta {
//!     #![doc = include_str!(concat!(env!("OUT_DIR"), "/furuta.md"))]
//!     #![allow(non_snake_case)]
//!     include!(concat!(env!("OUT_DIR"), "/furuta.rs"));
//! }
//! ```

// A build script is a `main`.
#![allow(clippy::needless_doctest_main)]

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use appell_spec::foreign::one_line;
use appell_spec::{Report, Severity};
use thiserror::Error;

use crate::c;
use crate::compile::{Derived, audited, report};
use crate::emit::{self, Emitted, Options, emit};
use crate::mechanics::assemble;
use crate::program::FunctionKind;
use crate::program::Program;

/// Compiles one spec. If it is invalid, prints the diagnostics and ends the build script.
pub fn build(spec: impl Into<PathBuf>) {
    Build::new().spec(spec).run();
}

/// Options of a build script.
#[derive(Debug, Clone, Default)]
pub struct Build {
    specs: Vec<PathBuf>,
    out_dir: Option<PathBuf>,
    options: Options,
    adjoints: bool,
    parameter_jacobians: bool,
    c: Option<c::Options>,
}

/// A mechanism that was compiled.
#[derive(Debug)]
pub struct Generated {
    /// Its spec.
    pub spec: PathBuf,
    /// The text of the spec.
    pub text: String,
    /// Its functions.
    pub program: Program,
    /// Rust, page and costs.
    pub emitted: Emitted,
}

/// Why compilation failed.
#[derive(Debug, Error)]
pub enum BuildError {
    /// A file or folder cannot be read or written.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        cause: io::Error,
    },
    /// Invalid specs: the concatenated reports.
    #[error("{reports}")]
    Specs {
        /// Rendered reports.
        reports: String,
    },
    /// A program cannot be written as Rust.
    #[error("{}: {cause}", spec.display())]
    Emit {
        /// The spec.
        spec: PathBuf,
        /// The error.
        cause: emit::Error,
    },
    /// Two specs describe mechanisms of the same name, so that their modules collide.
    #[error("{} and {} both describe a mechanism `{name}`; rename one of them", first.display(), second.display())]
    SameName {
        /// The name.
        name: String,
        /// One spec.
        first: PathBuf,
        /// The other.
        second: PathBuf,
    },
    /// Neither an output folder nor `OUT_DIR` is set.
    #[error(
        "`OUT_DIR` is not set: call this from a build script, or choose a folder with `out_dir`"
    )]
    NoOutDir,
}

impl Build {
    /// A build without specs.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a spec; the path is relative to the crate.
    #[must_use]
    pub fn spec(mut self, path: impl Into<PathBuf>) -> Self {
        self.specs.push(path.into());
        self
    }

    /// Adds specs.
    #[must_use]
    pub fn specs(mut self, paths: impl IntoIterator<Item = PathBuf>) -> Self {
        self.specs.extend(paths);
        self
    }

    /// Writes to another folder than `OUT_DIR`.
    #[must_use]
    pub fn out_dir(mut self, folder: impl Into<PathBuf>) -> Self {
        self.out_dir = Some(folder.into());
        self
    }

    /// Path of the run-time crate in the emitted text, `::appell_runtime` unless changed.
    #[must_use]
    pub fn runtime(mut self, path: &str) -> Self {
        path.clone_into(&mut self.options.runtime);
        self
    }

    /// Also emits the adjoints of rates and outputs, which make gradients of likelihoods exact and fast; this about
    /// doubles the amount of code.
    #[must_use]
    pub fn adjoints(mut self) -> Self {
        self.adjoints = true;
        self
    }

    /// Also emits P = ∂ẋ/∂p of mechanisms with more than 64 parameters, which then makes up most of the code; without
    /// it `Model::parameter_jacobian` uses differences.
    #[must_use]
    pub fn parameter_jacobians(mut self) -> Self {
        self.parameter_jacobians = true;
        self
    }

    /// Also writes the equations in C99: `NAME.h` and `NAME.c`, where `NAME` is that of the mechanism in C.
    #[must_use]
    pub fn c(mut self, options: c::Options) -> Self {
        self.c = Some(options);
        self
    }

    /// Compiles every spec to `NAME.rs` and `NAME.md`. All invalid specs are reported together.
    ///
    /// If the environment variable `GENERATED_DIR` is set, copies are written to that folder, for reading.
    pub fn generate(&self) -> Result<Vec<Generated>, BuildError> {
        println!("cargo::rerun-if-env-changed=GENERATED_DIR");
        let out_dir = match (&self.out_dir, std::env::var_os("OUT_DIR")) {
            (Some(folder), _) => folder.clone(),
            (None, Some(folder)) => PathBuf::from(folder),
            (None, None) => return Err(BuildError::NoOutDir),
        };
        let mut folders = vec![out_dir];
        folders.extend(std::env::var_os("GENERATED_DIR").map(|dir| copies(Path::new(&dir))));

        let mut compiled: Vec<Generated> = Vec::new();
        let mut reports = Vec::new();
        for spec in &self.specs {
            println!("cargo::rerun-if-changed={}", spec.display());
            let text = fs::read_to_string(spec).map_err(|cause| BuildError::Io {
                path: spec.clone(),
                cause,
            })?;
            // Path separators in messages and comments do not depend on the system.
            let file = spec.to_string_lossy().replace('\\', "/");
            match program(&file, &text, |parameters| self.kinds(parameters)) {
                Ok(program) => compiled.push(self.emitted(spec, text, program)?),
                Err(report) => reports.push(report.plain()),
            }
        }
        if !reports.is_empty() {
            return Err(BuildError::Specs {
                reports: reports.join("\n"),
            });
        }
        for (i, second) in compiled.iter().enumerate() {
            let name = &second.program.info.name;
            if let Some(first) = compiled[..i].iter().find(|c| c.program.info.name == *name) {
                let (first, second) = (first.spec.clone(), second.spec.clone());
                return Err(BuildError::SameName {
                    name: name.to_string(),
                    first,
                    second,
                });
            }
        }
        for folder in &folders {
            for one in &compiled {
                let name = &one.program.info.name;
                write(&folder.join(format!("{name}.rs")), &one.emitted.source)?;
                write(&folder.join(format!("{name}.md")), &one.emitted.docs)?;
                if let Some(options) = &self.c {
                    let c = c::emit(&one.program, options);
                    write(&folder.join(format!("{}.h", c.name)), &c.header)?;
                    write(&folder.join(format!("{}.c", c.name)), &c.source)?;
                }
            }
        }
        Ok(compiled)
    }

    fn kinds(&self, parameters: usize) -> Vec<FunctionKind> {
        match (self.adjoints, self.parameter_jacobians) {
            (true, _) => FunctionKind::ALL.to_vec(),
            (false, true) => FunctionKind::STANDARD.to_vec(),
            (false, false) => FunctionKind::standard(parameters),
        }
    }

    fn emitted(
        &self,
        spec: &Path,
        text: String,
        program: Program,
    ) -> Result<Generated, BuildError> {
        let options = Options {
            spec: Some(text.clone()),
            ..self.options.clone()
        };
        let emitted = emit(&program, &options).map_err(|cause| BuildError::Emit {
            spec: spec.to_owned(),
            cause,
        })?;
        Ok(Generated {
            spec: spec.to_owned(),
            text,
            program,
            emitted,
        })
    }

    /// [`Build::generate`] for a `main` without error handling: prints diagnostics in full, then ends the build
    /// script.
    pub fn run(&self) -> Vec<Generated> {
        match self.generate() {
            Ok(generated) => generated,
            Err(error) => {
                // Cargo prints the standard error output of a failed build script.
                eprintln!("{error}");
                std::process::exit(1)
            }
        }
    }
}

/// The program of a spec; suspicious parts of it are reported as build warnings.
fn program(
    file: &str,
    text: &str,
    kinds: impl Fn(usize) -> Vec<FunctionKind>,
) -> Result<Program, Report> {
    let Derived {
        mechanism,
        derivation,
        warnings,
    } = audited(file, text)?;
    let warnings = Report::new(file, text, warnings);
    let diagnostics = warnings.diagnostics().iter();
    for warning in diagnostics.filter(|d| d.severity != Severity::Note) {
        let at = warning.labels.first().map_or(0, |(span, _)| span.start);
        let (line, column) = warnings.line_column(at);
        let told = format!("{file}:{line}:{column}: {}", warning.message);
        println!("cargo::warning={}", one_line(&told));
    }
    let kinds = kinds(mechanism.parameters.len());
    assemble::program(derivation, &mechanism, &kinds)
        .map_err(|findings| report(&mechanism, text, &findings))
}

/// Cargo runs build scripts in the folder of their crate; a relative folder for copies is resolved in the folder
/// where Cargo was called, which the crates of a workspace share.
fn copies(folder: &Path) -> PathBuf {
    let called = || std::env::var_os("PWD").map(PathBuf::from);
    if folder.is_absolute() {
        folder.to_owned()
    } else {
        called().unwrap_or_default().join(folder)
    }
}

/// Writes a file atomically, and only if its text changes.
pub fn write(path: &Path, text: &str) -> Result<(), BuildError> {
    if fs::read(path).is_ok_and(|old| old == text.as_bytes()) {
        return Ok(());
    }
    let told = |cause| BuildError::Io {
        path: path.to_owned(),
        cause,
    };
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(told)?;
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    let draft = path.with_file_name(name);
    fs::write(&draft, text)
        .and_then(|()| fs::rename(&draft, path))
        .map_err(|cause| {
            // A failure to remove the temporary file would only hide the cause.
            let _ = fs::remove_file(&draft);
            told(cause)
        })
}
