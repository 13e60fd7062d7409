//! `appell sample`

use std::path::{Path, PathBuf};

use crate::failure::Error;
use crate::output::{self, shell};

/// Writes a folder to try the other commands with.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell sample rig rig
  appell sample arm arm
  appell sample capture capture
  appell sample robot robot
  appell sample study study")]
pub(crate) struct Sample {
    #[command(subcommand)]
    what: What,
}

/// What there is to try.
#[derive(Debug, clap::Subcommand)]
enum What {
    /// A simulated rig: its spec, which omits one effect, three recordings and their description
    Rig {
        /// Output folder, created if missing; nothing is overwritten
        folder: PathBuf,
    },
    /// A two-link arm with a payload and an end stop, both missing from its spec, and three recordings
    Arm {
        /// Output folder, created if missing; nothing is overwritten
        folder: PathBuf,
    },
    /// Motion capture of a simulated rider on an electric unicycle: two rides and the skeleton file
    Capture {
        /// Output folder, created if missing; nothing is overwritten
        folder: PathBuf,
    },
    /// A small robot arm, as URDF and as MJCF
    Robot {
        /// Output folder, created if missing; nothing is overwritten
        folder: PathBuf,
    },
    /// A study of riders who differ in mass, height and stiffness
    Study {
        /// Output folder, created if missing; nothing is overwritten
        folder: PathBuf,
    },
}

/// Name and text of the study.
const STUDY: (&str, &str) = ("rider.toml", include_str!("../../ensembles/rider.toml"));

impl Sample {
    pub(super) fn run(&self) -> Result<(), Error> {
        let told = match &self.what {
            What::Rig { folder } => recorded(folder, &appell::sample::rig(folder)?),
            What::Arm { folder } => recorded(folder, &appell::sample::arm(folder)?),
            What::Robot { folder } => {
                let files = appell::sample::robot(folder)?;
                let at = shell(&folder.to_string_lossy());
                let first = shell(&folder.join(files[0]).to_string_lossy());
                format!(
                    "wrote {} to {at}; next:\n  appell import {first}\n",
                    files.join(", ")
                )
            }
            What::Study { folder } => {
                let (name, text) = STUDY;
                appell::sample::write(folder, &[(name, text.to_owned())])?;
                let [study, results] =
                    [name, "results"].map(|n| shell(&folder.join(n).to_string_lossy()));
                format!("wrote {study}; next:\n  appell ensemble {study} --out {results}\n")
            }
            What::Capture { folder } => {
                let written = appell_papers::book::euc::sample::capture(folder)?;
                let at = shell(&folder.to_string_lossy());
                let rides: Vec<String> = (written.files[1..].iter())
                    .map(|ride| shell(&folder.join(ride).to_string_lossy()))
                    .collect();
                format!(
                    "wrote {} to {at}; next:\n  appell motion {} {} --out rides\n  \
                     appell inverse euc_3dof --data rides --free h --bias phi\nthe truth: h = {:.3} m\n",
                    written.files.join(", "),
                    shell(&folder.join(&written.files[0]).to_string_lossy()),
                    rides.join(" "),
                    written.height,
                )
            }
        };
        output::print(&told)
    }
}

/// Report on a written rig.
fn recorded(folder: &Path, files: &[&str]) -> String {
    let (files, at) = (files.join(", "), shell(&folder.to_string_lossy()));
    format!(
        "wrote {files} to {at}; next:\n  appell recording {at}\n  appell diagnose --data {at} --html gap.html\n"
    )
}
