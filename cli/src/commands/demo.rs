//! `appell demo`: spec to simulation in one command.

use std::fmt::Write as _;
use std::path::PathBuf;

use appell_report::figure::Figure;
use appell_runtime::integrate::Options;
use appell_runtime::simulate::{Method, Validity};

use super::derive::{Format, Stage, derivation};
use super::simulate::{Run, standard_extras, write_csv};
use crate::output;
use crate::summary;
use appell::Error;
use appell::files;
use appell::inputs::controller::Plan;
use appell::inputs::feedback;
use appell::setup::Setup;
use appell::source::Source;

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
        let source = Source::find("unicycle")?;
        let equations = crate::engine::equations(&source, None)?;
        let mut setup = Setup::new(&source.file, &source.text, equations.model().info())?;
        let law = feedback::parse("lane_change_5_m_s.toml", LANE_CHANGE, &setup)?;
        setup.start_from_law(&law)?;
        let mut plan = Plan::new(&setup);
        plan.feedback(law)?;
        let run = Run {
            equations: &equations,
            setup: &setup,
            t_end: 10.0,
            interval: 0.01,
            method: Method::Dop853,
            options: Options::with_tolerances(1e-10, 1e-10),
            extras: standard_extras(),
            validity: Validity::default(),
        };
        let (trajectory, failure) = run.run(plan)?;
        let panels = [
            vec!["y_G"],
            vec!["psi"],
            vec!["theta"],
            vec!["r"],
            vec!["u"],
        ];
        let figure = Figure::over_time(&trajectory, &panels);
        let path = Figure::path(&trajectory, "x_G", "y_G");

        let mut told = String::new();
        let mut place = |name: &str, about: &str| {
            let path = self.out.join(name);
            // Writing to a string cannot fail.
            let _ = writeln!(told, "  {:<28} {about}", path.display());
            path
        };
        let html = derivation(&source, Format::Html, Stage::All, &[])?;
        let about = "the derivation from frames to equations of motion";
        files::write(&place("unicycle.html", about), &html)?;
        let rust = derivation(&source, Format::Rust, Stage::All, &[])?;
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
