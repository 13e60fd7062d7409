//! Robot descriptions, URDF and MJCF, as specs.

use std::path::{Path, PathBuf};

use appell_files::FileError;
pub use appell_robots::{
    ActuatorName, BodyName, Dictionary, Entry, Format, Imported, JointName, LeftOut, Letters, Lock,
    Options, SNAP, Without,
};
use appell_robots::{Change, Corrected, Failure, MAX_FILE};
use walkdir::WalkDir;

use crate::{Error, Field, Source, files};

/// Largest mesh, in bytes.
const MAX_MESH: u64 = 1 << 28;

/// Turns the text of a URDF or an MJCF file into a spec; `file` is its name in messages and in the spec.
///
/// ```
/// use appell::robot::{self, Options};
///
/// let rod = r#"<mujoco model="rod"><worldbody><body name="rod">
///   <joint name="hinge" axis="0 1 0"/>
///   <inertial pos="0 0 -0.5" mass="1" diaginertia="0.08 0.08 0.001"/>
/// </body></worldbody></mujoco>"#;
/// let imported = robot::import("rod.xml", rod, &Options::default())?;
/// assert_eq!(imported.joints, 1);
/// assert!(robot::source("rod.toml", &imported).check().is_ok());
/// # Ok::<(), appell::Error>(())
/// ```
pub fn import(file: &str, text: &str, options: &Options) -> Result<Imported, Error> {
    appell_robots::import(file, text, options).map_err(told)
}

fn told(failure: Failure) -> Error {
    match failure {
        Failure::File(report) => Error::Report(report),
        Failure::Lock(why) => Error::request(Field::Lock, why),
        Failure::Unknown { name, help } => Error::request(
            Field::Letters,
            format!("`{name}` is no link, joint or parameter of the robot; {help}"),
        ),
    }
}

/// Reads a file with those that it includes, and the meshes that give bodies their inertia, and turns it into a spec.
/// These files are below `root`, or else below the folder of the file.
pub fn read(path: &Path, root: Option<&Path>, options: &Options) -> Result<Imported, Error> {
    read_text(path, &files::read(path, MAX_FILE)?, root, options)
}

/// [`read`], given the text of the file.
pub(crate) fn read_text(
    path: &Path,
    text: &str,
    root: Option<&Path>,
    options: &Options,
) -> Result<Imported, Error> {
    let others = beside(path, root);
    appell_robots::import_with(&name(path), text, options, &others).map_err(told)
}

/// The text of an MJCF file with changes; everything else stays byte for byte.
pub(crate) fn corrected(
    path: &Path,
    text: &str,
    changes: &[Change],
    remarks: &[String],
) -> Result<Corrected, Error> {
    let others = beside(path, None);
    appell_robots::corrected(&name(path), text, changes, remarks, &others).map_err(told)
}

/// The name of a file in messages.
fn name(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

/// Reads files that a robot file names, below `root` or else below its folder.
fn beside<'p>(
    path: &'p Path,
    root: Option<&'p Path>,
) -> impl Fn(&str) -> Result<Vec<u8>, String> + 'p {
    let folder = path.parent().unwrap_or(Path::new(""));
    move |name: &str| {
        let path = appell_files::within(root.unwrap_or(folder), folder, name);
        let bytes = path.and_then(|path| appell_files::read(&path, MAX_MESH));
        bytes.map_err(|why| match why {
            FileError::Outside { .. } => format!("{why}, or name a folder above both as the root"),
            why => why.to_string(),
        })
    }
}

/// The robot files of a folder and of the folders in it, by their names, each with its format.
///
/// A robot file ends in `.urdf`, or in `.xml` and begins with `<robot` or `<mujoco`. Links to folders are not followed.
pub fn find(folder: &Path) -> Result<Vec<(PathBuf, Format)>, Error> {
    /// Deepest nesting of folders.
    const MOST_NESTED: usize = 32;
    let all = WalkDir::new(folder).max_depth(MOST_NESTED);
    let mut found = Vec::new();
    for entry in all.sort_by_file_name() {
        let entry = entry.map_err(|error| {
            let path = error.path().unwrap_or(folder).to_owned();
            Error::reading(&path)(error.into())
        })?;
        let ends = |end: &str| entry.path().extension().is_some_and(|own| own == end);
        if !(ends("urdf") || ends("xml")) || !entry.path().is_file() {
            continue;
        }
        let format = files::read(entry.path(), MAX_FILE).ok();
        let format = format.and_then(|text| Format::of(&text));
        // A URDF file with another root element is reported as invalid.
        let format = format.or(ends("urdf").then_some(Format::Urdf));
        found.extend(format.map(|format| (entry.into_path(), format)));
    }
    Ok(found)
}

/// The spec of a robot, as if it were read from a file.
pub fn source(file: &str, imported: &Imported) -> Source {
    Source::of(file, imported.spec.as_str())
}
