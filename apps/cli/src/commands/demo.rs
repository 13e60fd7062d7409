//! `appell demo`: spec to simulation in one command.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::failure::Error;
use appell::derivation::{Format, Stage};
use appell::source::Source;
use appell::{DiagnosisOptions, Law, Motion, Simulated, files, sample};
use appell_report::figure::Figure;
use appell_runtime::integrate::Options;

use super::simulate::{simulated, write_csv};
use crate::diagnosed;
use crate::output::shell;
use crate::{engine, output, progress, summary};

/// The lane change of the paper at 5 m/s.
const LANE_CHANGE: &str = include_str!("../../feedback/lane_change_5_m_s.toml");

/// Derives the unicycle, lets it change lanes under feedback, and diagnoses a rig whose spec lacks an effect.
///
/// The last part is `appell sample rig` and `appell diagnose`.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell demo --out demo")]
pub(crate) struct Demo {
    /// Output folder
    #[arg(long, short, value_name = "DIR", default_value = "demo")]
    out: PathBuf,
}

impl Demo {
    pub(super) fn run(&self) -> Result<(), Error> {
        files::make_folder(&self.out)?;
        let mut written = Written {
            folder: &self.out,
            list: String::new(),
        };
        let motion = lane_change(&mut written)?;
        let gap = rig(&mut written)?;
        output::print(&format!("{motion}\n{gap}\nopen:\n{}", written.list))
    }
}

/// The written files, with a line for each.
struct Written<'a> {
    folder: &'a Path,
    list: String,
}

impl Written<'_> {
    fn place(&mut self, name: &str, about: &str) -> PathBuf {
        let path = self.folder.join(name);
        // Writing to a string cannot fail.
        let _ = writeln!(self.list, "  {:<28} {about}", path.display());
        path
    }
}

/// The lane change of the paper, from the equations to the moving unicycle; returns its summary.
fn lane_change(written: &mut Written<'_>) -> Result<String, Error> {
    let source = Source::shipped("unicycle")?;
    let model = engine::model("unicycle", &[], None)?;
    let motion = Motion {
        interval: Some(0.01),
        options: Options::with_tolerances(1e-10, 1e-10),
        laws: vec![Law::Text {
            name: "lane_change_5_m_s.toml".to_owned(),
            text: LANE_CHANGE.to_owned(),
        }],
        ..Motion::new(10.0)
    };
    let Simulated {
        trajectory,
        failure,
        ..
    } = simulated(&model, &motion)?;
    let panels = [
        vec!["y_G"],
        vec!["psi"],
        vec!["theta"],
        vec!["r"],
        vec!["u"],
    ];
    let html = source.derivation(Stage::All, Format::Html)?;
    let about = "the derivation from frames to equations of motion";
    files::write(&written.place("unicycle.html", about), &html)?;
    let rust = source.rust(&source.functions()?)?;
    let about = "the same equations as Rust, compiled into this program";
    files::write(&written.place("unicycle.rs", about), &rust)?;
    let about = "the motion in 3-D";
    let page = model.page(&trajectory, failure.as_deref())?;
    files::write(&written.place("lane_change.html", about), &page)?;
    let about = "the motion: states, input, outputs, energies";
    write_csv(&written.place("lane_change.csv", about), &trajectory)?;
    let about = "the motion over time";
    let figure = Figure::over_time(&trajectory, &panels).to_svg();
    files::write(&written.place("lane_change.svg", about), &figure)?;
    if let Some(path) = Figure::path(&trajectory, "x_G", "y_G") {
        let about = "the path of the wheel centre, seen from above";
        files::write(&written.place("path.svg", about), &path.to_svg())?;
    }
    match failure {
        None => Ok(summary::text(&trajectory)),
        Some(reason) => Err(Error::Computation(reason)),
    }
}

/// A simulated rig and its diagnosis; returns the verdict.
fn rig(written: &mut Written<'_>) -> Result<String, Error> {
    let about = "recordings of a simulated rig, and a spec that lacks something";
    let folder = written.place("rig", about);
    if !folder.exists() {
        sample::rig(&folder)?;
    }
    let set = appell::recording::read(&[folder], None)?;
    let options = DiagnosisOptions {
        pictures: true,
        ..DiagnosisOptions::default()
    };
    let report = progress::during("diagnosing", |spinner| {
        appell::diagnose(&set, &options, |stage| spinner.set_message(stage))
    })?;
    let about = "the missing effect, and how far it closes the gap";
    files::write(
        &written.place("gap.html", about),
        &appell::diagnosis::page(&set, &report),
    )?;
    let about = "the same for programs, and for `appell apply`";
    let json = written.place("gap.json", about);
    files::write_json(&json, &appell::json::diagnosis(&report, None, &[]))?;
    let spec = shell(&set.spec.file);
    let json = shell(&json.to_string_lossy());
    let apply = format!("appell apply {spec} --report {json}");
    Ok(diagnosed::text(&report, None, &[apply]))
}
