//! A spec as an FMU: a package that simulation tools import, with the equations as machine code and as C.

mod error;

use std::io::{Cursor, Write as _};
use std::path::Path;
use std::process::Command;
use std::{env, fs, io};

use appell_codegen::fmu::{self, Emitted};
use appell_runtime::model::ModelInfo;
use zip::write::{SimpleFileOptions, ZipWriter};

use crate::source::Source;
use crate::{Error, files};

pub use appell_codegen::fmu::InputsOfStep;
pub use error::FmuError;

/// C compilers that are tried where the environment variable `CC` names none.
const COMPILERS: [&str; 3] = ["cc", "gcc", "clang"];
/// Results are the same on all machines: products and sums are rounded one by one.
const FLAGS: [&str; 6] = [
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-fPIC",
    "-shared",
    "-fvisibility=hidden",
];

/// Contents of an FMU.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// Leave the compilation to the tool that imports it.
    pub sources_only: bool,
    /// Inputs within a communication step of co-simulation.
    pub inputs: InputsOfStep,
}

/// An FMU of FMI 3.0, for model exchange and co-simulation.
#[derive(Debug, Clone)]
pub struct Fmu {
    /// Model identifier and name of the file without its extension.
    pub name: String,
    /// The variables behind it.
    pub info: ModelInfo,
    /// The platform of its machine code, such as `x86_64-linux`; none where it holds sources only.
    pub platform: Option<String>,
    /// The file.
    pub bytes: Vec<u8>,
}

impl Source {
    /// An FMU. Equal specs and compilers give equal bytes.
    ///
    /// ```
    /// use appell::Source;
    /// use appell::fmu::Options;
    ///
    /// let fmu = Source::shipped("pendulum")?.fmu(&Options { sources_only: true, ..Options::default() })?;
    /// assert_eq!(fmu.name, "pendulum");
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn fmu(&self, options: &Options) -> Result<Fmu, Error> {
        let program = appell_codegen::compile(&self.file, &self.text, &fmu::functions())?;
        let emitted = fmu::emit(&program, options.inputs);
        let (platform, binary) = if options.sources_only {
            (None, None)
        } else {
            let (platform, extension) = platform()?;
            let code = compiled(&emitted)?;
            let path = format!("binaries/{platform}/{}.{extension}", emitted.name);
            (Some(platform), Some((path, code)))
        };
        let bytes = packed(&emitted, binary.as_ref()).map_err(FmuError::from)?;
        Ok(Fmu {
            name: emitted.name,
            info: program.info,
            platform,
            bytes,
        })
    }
}

/// The name of this platform in FMI, and the extension of its shared libraries.
fn platform() -> Result<(String, &'static str), FmuError> {
    let (system, extension) = match env::consts::OS {
        "linux" => ("linux", "so"),
        "macos" => ("darwin", "dylib"),
        other => return Err(unsupported(other)),
    };
    match env::consts::ARCH {
        architecture @ ("x86_64" | "aarch64") => {
            Ok((format!("{architecture}-{system}"), extension))
        }
        _ => Err(unsupported(system)),
    }
}

fn unsupported(system: &str) -> FmuError {
    let platform = format!("{} and {system}", env::consts::ARCH);
    FmuError::Platform { platform }
}

/// The shared library.
fn compiled(emitted: &Emitted) -> Result<Vec<u8>, Error> {
    let failed = |doing| move |cause| FmuError::Scratch { doing, cause };
    // Removed at the end; on failure it stays among temporary files.
    let folder = tempfile::Builder::new().prefix("appell-fmu-").tempdir();
    let folder = folder.map_err(failed("make a folder for the compilation"))?;
    for (name, text) in &emitted.sources {
        files::write(&folder.path().join(name), text)?;
    }
    compile(emitted, folder.path())?;
    let library = fs::read(folder.path().join(LIBRARY));
    Ok(library.map_err(failed("read the compiled library"))?)
}

/// The name of the library while it is made.
const LIBRARY: &str = "library";

/// Runs the first compiler that is there.
fn compile(emitted: &Emitted, folder: &Path) -> Result<(), FmuError> {
    let wanted = env::var("CC").ok().filter(|name| !name.trim().is_empty());
    let compilers = match &wanted {
        Some(wanted) => vec![wanted.as_str()],
        None => COMPILERS.to_vec(),
    };
    for compiler in &compilers {
        // CC may have arguments, as in `ccache gcc`.
        let mut words = compiler.split_whitespace();
        let told = Command::new(words.next().unwrap_or_default())
            .args(words)
            .args(FLAGS)
            .args(&emitted.compiled)
            .args(["-o", LIBRARY, "-lm"])
            .current_dir(folder)
            .output();
        let told = match told {
            Ok(told) if told.status.success() => return Ok(()),
            Ok(told) => String::from_utf8_lossy(&told.stderr).into_owned(),
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => continue,
            Err(cause) => cause.to_string(),
        };
        return Err(FmuError::Compiler {
            compiler: (*compiler).to_owned(),
            told: [""]
                .into_iter()
                .chain(told.lines().take(20))
                .collect::<Vec<_>>()
                .join("\n  "),
        });
    }
    let tried = compilers.join(", ");
    Err(FmuError::NoCompiler { tried })
}

/// The file: a ZIP archive without times.
fn packed(
    emitted: &Emitted,
    binary: Option<&(String, Vec<u8>)>,
) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let plain = SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
        .unix_permissions(0o644);
    let mut add = |path: &str, bytes: &[u8], options| -> zip::result::ZipResult<()> {
        archive.start_file(path, options)?;
        archive.write_all(bytes)?;
        Ok(())
    };
    add(
        "modelDescription.xml",
        emitted.model_description.as_bytes(),
        plain,
    )?;
    if let Some((path, code)) = binary {
        add(path, code, plain.unix_permissions(0o755))?;
    }
    add(
        "sources/buildDescription.xml",
        emitted.build_description.as_bytes(),
        plain,
    )?;
    for (name, text) in &emitted.sources {
        add(&format!("sources/{name}"), text.as_bytes(), plain)?;
    }
    Ok(archive.finish()?.into_inner())
}
