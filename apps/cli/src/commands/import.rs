//! `appell import`

use std::path::PathBuf;
use std::str::FromStr;

use appell::robot::{self, Imported, LeftOut, Letters, Lock, Options, Without};
use appell::{Severity, files};

use crate::destinations::extension;
use crate::failure::{self, Error, tell};
use crate::output::{self, shell};

/// Most lines of the file that are named for one kind of element.
const MOST_LINES: usize = 6;

/// Turns a robot file, URDF or MJCF, into a spec.
///
/// Links and joints keep their names. Links that are fixed together become one body, each joint a coordinate with
/// its range, its damping, spring, dry friction and armature, and an input that drives it: a torque or a force, or with
/// `--actuators` the commands of the file's actuators. Elements without a counterpart are listed with lines
/// and the effect of omission on the motion.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell import robot/arm.urdf -o arm.toml
  appell import robot/arm.xml -o servos.toml --actuators --parameters '*.mass,*.kp,elbow.damping'
  appell import robot/arm.xml -o arm_to_identify.toml --parameters inertias --without limits
  appell import robot/arm.xml -o stiff.toml --lock elbow=0.5 --lock reach")]
pub(crate) struct Import {
    /// The robot: a URDF or an MJCF file
    robot: PathBuf,
    /// Folder below which included files and meshes lie [default: that of the robot file]
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
    /// The spec, `-` is standard output [default: name of the robot file with `.toml`; an existing file is not
    /// overwritten]
    #[arg(long, short, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Numbers that become parameters: `none`, `inertias`, `all`, or names of links, joints and parameters
    ///
    /// The other numbers are written out, so that zeros and right angles simplify the equations. Names and patterns
    /// ELEMENT.ATTRIBUTE choose single numbers of the file: `*.mass`, `elbow.damping`, `hand.com.x`, `gravity`.
    #[arg(long, value_name = "WHICH", default_value = "none")]
    parameters: String,
    /// Items to omit, separated by commas
    ///
    /// One or several of `damping`, `armature`, `springs`, `friction`, `limits`, `couplings`, `compensation`, `points`
    /// (those at the origins of links that nothing uses).
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = Without::from_str)]
    without: Vec<Without>,
    /// Make a joint rigid, at a value in rad or m, or as the file draws it; can be repeated
    ///
    /// The links that it carries are fixed there: a model with fewer coordinates.
    #[arg(long, value_name = "JOINT[=VALUE]", value_parser = Lock::from_str, allow_hyphen_values = true)]
    lock: Vec<Lock>,
    /// Take angles within 1e-4 rad of a right angle for right angles
    #[arg(long)]
    snap: bool,
    /// Let the root of a URDF float; an MJCF states its floating bodies
    #[arg(long)]
    floating: bool,
    /// Make the actuators of an MJCF inputs, with their laws: gains, gear, limits
    ///
    /// Without it every joint has an input, a torque or a force.
    #[arg(long)]
    actuators: bool,
}

impl Import {
    pub(super) fn run(&self) -> Result<(), Error> {
        let default = PathBuf::from(
            self.robot
                .with_extension("toml")
                .file_name()
                .unwrap_or_default(),
        );
        let out = self.out.as_ref().unwrap_or(&default);
        if !files::is_stdout(out) && extension(out).is_none_or(|end| end != "toml") {
            let instead = out.with_extension("toml");
            let instead = shell(&instead.to_string_lossy());
            return Err(Error::Usage(format!(
                "a spec is a TOML file: write `--out {instead}`"
            )));
        }
        let options = Options {
            letters: Letters::read(&self.parameters),
            without: self.without.clone(),
            lock: self.lock.clone(),
            snap: self.snap,
            floating: self.floating,
            actuators: self.actuators,
            ..Options::default()
        };
        let robot = robot::read(&self.robot, self.root.as_deref(), &options)?;
        if self.out.is_none()
            && std::fs::read(out).is_ok_and(|there| there != robot.spec.as_bytes())
        {
            let file = shell(&out.to_string_lossy());
            return Err(Error::Usage(format!(
                "{file} exists with other contents; to replace it, name it with `-o {file}`"
            )));
        }
        files::write(out, &robot.spec)?;
        self.tell(&robot);
        let file = shell(&out.to_string_lossy());
        let bodies = if robot.bodies == 1 { "body" } else { "bodies" };
        let joints = if robot.joints == 1 { "joint" } else { "joints" };
        let counts = format!("{} {bodies}, {} {joints}", robot.bodies, robot.joints);
        let told = if files::is_stdout(out) {
            format!("wrote the spec to standard output: {counts}\n")
        } else {
            format!("wrote {file}: {counts}; next:\n  appell check {file}\n")
        };
        output::print_beside(&told, &[&Some(out.clone())])
    }

    /// Prints warnings, omitted items, and angles that are nearly right.
    fn tell(&self, robot: &Imported) {
        for warnings in &robot.warnings {
            let mut findings = warnings.diagnostics().iter();
            if findings.any(|finding| finding.severity != Severity::Note) {
                failure::report(warnings);
                tell("\n");
            }
        }
        if !robot.left_out.is_empty() {
            let file = self.robot.to_string_lossy().replace('\\', "/");
            for (acts, heading) in [
                (true, "left out, which changes the motion"),
                (false, "left out, for want of a counterpart"),
            ] {
                let own = robot
                    .left_out
                    .iter()
                    .filter(|one| one.effect.is_some() == acts);
                let own: Vec<String> = own.map(|one| left_out(one, &file)).collect();
                if !own.is_empty() {
                    tell(&format!("{heading}:\n{}\n", own.join("\n")));
                }
            }
        }
        let is_actuator = |one: &LeftOut| one.what.starts_with("actuator/");
        if !self.actuators && robot.left_out.iter().any(is_actuator) {
            tell(
                "with `--actuators` the commands of the actuators are the inputs, with their gains, gear and limits\n",
            );
        }
        if robot.nearly_right > 0 && !self.snap {
            let count = robot.nearly_right;
            let them = if count == 1 {
                "orientation or axis is"
            } else {
                "orientations and axes are"
            };
            tell(&format!(
                "{count} {them} within 1e-4 rad of a right angle, but not right; with `--snap` they are, and the \
                 equations shorter\n"
            ));
        }
    }
}

/// `robot` is the file that does not need to be named.
fn left_out(one: &LeftOut, robot: &str) -> String {
    let lines = one.lines.iter().take(MOST_LINES).map(ToString::to_string);
    let lines = lines.collect::<Vec<_>>().join(", ");
    let more = match one.lines.len().saturating_sub(MOST_LINES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let plural = if one.lines.len() == 1 { "" } else { "s" };
    let of = match one.file.as_str() {
        file if file == robot => String::new(),
        file => format!(" of {file}"),
    };
    let effect = (one.effect).map_or(String::new(), |effect| format!(" ({effect})"));
    format!("  {}: line{plural} {lines}{more}{of}{effect}", one.what)
}
