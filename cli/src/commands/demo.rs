//! `appell demo`: spec to simulation in one command.

use std::fmt::Write as _;
use std::path::PathBuf;

use crate::failure::Error;
use appell::derivation::{Format, Stage};
use appell::source::Source;
use appell::{Law, Motion, Simulated, files};
use appell_report::figure::Figure;
use appell_runtime::integrate::Options;

use super::simulate::{simulated, write_csv};
use crate::{engine, output, summary};

/// The lane change of the paper at 5 m/s.
const LANE_CHANGE: &str = include_str!("../../../docs/examples/feedback/lane_change_5_m_s.toml");

/// Derives the unicycle, lets it change lanes under feedback, and draws the motion.
#[derive(Debug, clap::Args)]
pub(crate) struct Demo {
    /// Output folder
    #[arg(long, value_name = "DIR", default_value = "demo")]
    out: PathBuf,
}

impl Demo {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = Source::shipped("unicycle")?;
        let model = engine::model("unicycle", None)?;
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
        let figure = Figure::over_time(&trajectory, &panels);
        let path = Figure::path(&trajectory, "x_G", "y_G");

        files::make_folder(&self.out)?;
        let mut told = String::new();
        let mut place = |name: &str, about: &str| {
            let path = self.out.join(name);
            // Writing to a string cannot fail.
            let _ = writeln!(told, "  {:<28} {about}", path.display());
            path
        };
        let html = source.derivation(Stage::All, Format::Html)?;
        let about = "the derivation from frames to equations of motion";
        files::write(&place("unicycle.html", about), &html)?;
        let rust = source.rust()?;
        let about = "the same equations as Rust, compiled into this program";
        files::write(&place("unicycle.rs", about), &rust)?;
        let about = "the motion: states, input, outputs, energies";
        write_csv(&place("lane_change.csv", about), &trajectory)?;
        let about = "the motion over time";
        files::write(&place("lane_change.svg", about), &figure.to_svg())?;
        if let Some(path) = path {
            let about = "the path of the wheel centre, seen from above";
            files::write(&place("path.svg", about), &path.to_svg())?;
        }
        output::print(&format!("{}\nopen:\n{told}", summary::text(&trajectory)))?;
        failure.map_or(Ok(()), |reason| Err(Error::Computation(reason)))
    }
}
