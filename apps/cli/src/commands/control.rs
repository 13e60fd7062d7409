//! `appell control`

use std::path::{Path, PathBuf};

use crate::failure::Error;
use crate::output::shell;
use appell::control::Request;
use appell::setup::{Assignment, listed};
use appell::{Model, files};
use serde_json::Value;

use crate::{design_report, engine, output, picture, progress};

/// Controllability about a steady motion, and gains of a feedback law.
///
/// The motion is the initial state of the spec with the values of `--at`; the other inputs are chosen
/// so that it is steady. Without `--poles` or `--lqr` no law is designed. Gains, poles and weights are
/// in SI.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell control cart_pole --poles -4
  appell control unicycle --at \"omega_2=1[m/s]/R\" --outputs omega_1,theta,sigma,r --lqr Q=1,R=0.1 --write law.toml")]
pub(crate) struct Control {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// A parameter, such as R=0.3 or R=30cm
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Assignment>,
    /// A state or input on the steady motion, such as theta=5deg or u=2N, or a quantity that
    /// determines it: an output, or the rate of an ignorable coordinate
    #[arg(
        long,
        visible_alias = "fix",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true
    )]
    at: Vec<Assignment>,
    /// The inputs that the law may use [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    inputs: Vec<String>,
    /// The states that are fed back; an output of the spec stands for the states that it depends on
    /// [default: a controllable set, coordinates first]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    outputs: Vec<String>,
    /// Closed-loop poles in 1/s, such as -8,-8,-2+3i,-2-3i; a single one is used for all
    #[arg(
        long,
        value_name = "POLES",
        allow_hyphen_values = true,
        conflicts_with = "lqr"
    )]
    poles: Option<String>,
    /// Diagonal weights of outputs and inputs in ∫(yᵀQy + uᵀRu)dt, such as Q=1,10,R=0.1; a single
    /// number is used for all
    #[arg(long, value_name = "Q=…,R=…")]
    lqr: Option<String>,
    /// Sampling period; the inputs are held in between
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    sampled_ms: Option<f64>,
    /// Delay from a measurement to its effect
    #[arg(
        long,
        value_name = "MS",
        allow_negative_numbers = true,
        requires = "sampled_ms"
    )]
    delay_ms: Option<f64>,
    /// Design a law at several values of a state, input or parameter, such as v=1..20/10 (ten intervals)
    #[arg(long, value_name = "NAME=FROM..TO/STEPS", allow_hyphen_values = true)]
    schedule: Option<Assignment>,
    /// Write the law as a file for `appell simulate --feedback`
    #[arg(long, value_name = "FILE.toml")]
    write: Option<PathBuf>,
    /// Simulate the law from a grid of disturbances of one or two states, such as
    /// theta=-20deg..20deg/8,r=-10cm..10cm/8, and report which motions settle
    #[arg(
        long,
        value_name = "NAME=FROM..TO/STEPS,…",
        allow_hyphen_values = true,
        conflicts_with = "schedule"
    )]
    attraction: Option<String>,
    /// Duration of each of these motions
    #[arg(
        long,
        visible_alias = "t-end-s",
        value_name = "S",
        default_value_t = 10.0,
        requires = "attraction"
    )]
    for_s: f64,
    /// Draw the region of attraction over two states
    #[arg(long, value_name = "FILE.svg|png", requires = "attraction")]
    plot: Option<PathBuf>,
    /// Write the results as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Control {
    pub(super) fn run(&self) -> Result<(), Error> {
        let model = engine::model(&self.model, &self.set, None)?;
        self.needs_law()?;
        let (text, json) = match &self.schedule {
            None => self.designed(&model)?,
            Some(range) => self.scheduled(&model, range)?,
        };
        output::json(self.json.as_deref(), || json)?;
        output::print_beside(&text, &[&self.json, &self.write, &self.plot])
    }

    /// A design, its region of attraction if requested, and its files.
    fn designed(&self, model: &Model) -> Result<(String, Value), Error> {
        let design = model.control(&self.request())?;
        if let Some(path) = &self.write {
            files::write(path, &in_file(&model.law(&design)?, path))?;
        }
        let mut text = design_report::text(&design, model.info());
        let mut json = appell::json::design(model.info(), &design);
        if let Some(grid) = &self.attraction {
            let bar = progress::parts();
            let progress = |done: usize, of: usize| {
                bar.set_length(of as u64);
                bar.set_position(done as u64);
            };
            let region = model.attraction(&design, grid, self.for_s, &progress);
            bar.finish_and_clear();
            let region = region?;
            text += &region.text();
            json["attraction"] = region.to_json();
            if let Some(path) = &self.plot {
                picture::write(path, &region.map()?.to_svg())?;
            }
        }
        Ok((text, json))
    }

    /// Designs over a range, and their file.
    fn scheduled(&self, model: &Model, range: &Assignment) -> Result<(String, Value), Error> {
        let schedule = model.schedule(&self.request(), range)?;
        if let Some(path) = &self.write {
            files::write(path, &in_file(&model.scheduled_law(&schedule)?, path))?;
        }
        Ok((
            design_report::schedule_text(&schedule, model.info()),
            appell::json::schedule(model.info(), &schedule),
        ))
    }

    /// Refuses files of a law that is not designed.
    fn needs_law(&self) -> Result<(), Error> {
        let flags = [
            ("--write", self.write.is_some()),
            ("--attraction", self.attraction.is_some()),
        ];
        let refused = |message: String| Err(Error::Usage(message));
        match flags.iter().find(|(_, given)| *given) {
            Some((flag, _)) if self.poles.is_none() && self.lqr.is_none() => refused(format!(
                "{flag}: there is no law; design one with --poles or --lqr"
            )),
            _ if self.schedule.is_some() && self.write.is_some() && self.sampled_ms.is_some() => {
                refused("--write: a sampled law cannot be scheduled yet".to_owned())
            }
            _ if self.plot.is_some() && !self.disturbs_two_states() => {
                refused("--plot: the map needs disturbances of two states".to_owned())
            }
            _ => Ok(()),
        }
    }

    fn disturbs_two_states(&self) -> bool {
        let grid = self.attraction.as_deref().unwrap_or_default();
        listed(grid).len() == 2
    }

    fn request(&self) -> Request {
        Request {
            parameters: self.set.clone(),
            at: self.at.clone(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            poles: self.poles.clone(),
            weights: self.lqr.clone(),
            sampled_ms: self.sampled_ms,
            delay_ms: self.delay_ms,
        }
    }
}

/// The law with its own file in the command to try it.
fn in_file(law: &str, path: &Path) -> String {
    law.replacen("FILE.toml", &shell(&path.to_string_lossy()), 1)
}
