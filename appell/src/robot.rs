//! Robot descriptions, URDF and MJCF, as specs.

use std::path::Path;

use appell_robots::{Failure, MAX_FILE};
pub use appell_robots::{Imported, LeftOut, Letters, Options, SNAP, Without};

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
        Failure::Unknown { name, help } => Error::request(
            Field::Letters,
            format!("`{name}` is no link, joint or parameter of the robot; {help}"),
        ),
    }
}

/// Reads a file with those that it includes, and the meshes that give bodies their inertia, and turns it into a spec.
pub fn read(path: &Path, options: &Options) -> Result<Imported, Error> {
    let text = files::read(path, MAX_FILE)?;
    let file = path.to_string_lossy().replace('\\', "/");
    let folder = path.parent().unwrap_or(Path::new(""));
    let others = |name: &str| {
        let named = folder.join(name);
        let there = std::fs::metadata(&named).ok()?;
        let can_be_read = there.is_file() && there.len() <= MAX_MESH;
        can_be_read.then(|| std::fs::read(&named).ok())?
    };
    appell_robots::import_with(&file, &text, options, &others).map_err(told)
}

/// The spec of a robot, as if it were read from a file.
pub fn source(file: &str, imported: &Imported) -> Source {
    Source {
        file: file.to_owned(),
        text: imported.spec.clone(),
        shipped: None,
    }
}
