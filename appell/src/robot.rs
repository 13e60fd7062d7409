//! Robot descriptions, URDF and MJCF, as specs.

use std::path::{Path, PathBuf};

use appell_files::FileError;
pub use appell_robots::{
    ActuatorName, BodyName, Dictionary, Entry, Format, Imported, JointName, LeftOut, Letters, Lock,
    Options, SNAP, Without,
};
use appell_robots::{Failure, MAX_FILE};
use serde_json::{Value, json};
use walkdir::WalkDir;

use crate::{Error, Field, Source, check, files};

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
    let text = files::read(path, MAX_FILE)?;
    let file = path.to_string_lossy().replace('\\', "/");
    let folder = path.parent().unwrap_or(Path::new(""));
    let others = |name: &str| {
        let path = appell_files::within(root.unwrap_or(folder), folder, name);
        let bytes = path.and_then(|path| appell_files::read(&path, MAX_MESH));
        bytes.map_err(|why| match why {
            FileError::Outside { .. } => format!("{why}, or name a folder above both as the root"),
            why => why.to_string(),
        })
    };
    appell_robots::import_with(&file, &text, options, &others).map_err(told)
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

/// The result of importing a robot file, as JSON.
pub fn entry(file: &str, robot: &Imported) -> Value {
    let left_out = robot.left_out.iter();
    let left_out = left_out
        .map(|one| json!({ "what": one.what, "file": one.file, "lines": one.lines, "effect": one.effect }))
        .collect::<Vec<_>>();
    let warnings = robot.warnings.iter();
    let warnings = warnings
        .map(|report| json!({ "file": report.file(), "findings": check::findings(report) }))
        .collect::<Vec<_>>();
    json!({
        "file": file, "ok": true, "name": robot.name, "format": robot.format.word(), "bodies": robot.bodies,
        "joints": robot.joints, "nearly_right_angles": robot.nearly_right, "warnings": warnings, "left_out": left_out,
    })
}

/// The spec of a robot, as if it were read from a file.
pub fn source(file: &str, imported: &Imported) -> Source {
    Source::of(file, imported.spec.as_str())
}
