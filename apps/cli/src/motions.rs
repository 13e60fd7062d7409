//! Flags and output common to `appell steady` and `appell stability`.

pub(crate) mod text;

use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;

use crate::failure::Error;
use appell::files;
use appell::setup::{Assignment, Setup};
use appell::steady::{Answer, Resolved, STARTS, Span, export};
use appell_analysis::{Branch, Stability, Term};
use appell_report::figure::Figure;
use serde_json::Value;

use crate::{engine, output, picture, progress};

/// The problem: prescribed values, free quantities, continuation parameter.
#[derive(Debug, clap::Args)]
pub(crate) struct Question {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// A parameter, such as R=0.3 or R=30cm
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Assignment>,
    /// Prescribe a state, input, output, or rate of an ignorable coordinate, such as theta=10deg;
    /// other inputs are zero
    #[arg(
        long,
        visible_alias = "at",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true
    )]
    fix: Vec<Assignment>,
    /// An input or parameter to solve for
    #[arg(long, value_name = "NAME")]
    free: Vec<String>,
    /// Continue the motions along a quantity, such as speed=0.5..10 or theta=-30deg..30deg
    #[arg(long, value_name = "NAME=FROM..TO", allow_hyphen_values = true)]
    along: Option<Span>,
    /// Lower bound for feasible motions, in quotes: 'z>=0'
    #[arg(long, value_name = "BOUND", allow_hyphen_values = true)]
    require: Vec<Least>,
    /// Number of starting points of the search
    #[arg(long, value_name = "N", default_value_t = STARTS)]
    starts: usize,
    /// Admit motions outside of the declared ranges of states
    #[arg(long)]
    ignore_ranges: bool,
    /// Write the motions, in the units of the spec; `-` is standard output
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Plot the motions against the quantity
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write the motions as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// `NAME>=VALUE` as it was given.
#[derive(Debug, Clone)]
pub(crate) struct Least(Assignment);

impl FromStr for Least {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text
            .split_once(">=")
            .ok_or("write NAME>=VALUE in quotes, such as 'z>=0'")?;
        let assignment = Assignment::from_str(&format!("{name}={value}"))?;
        Ok(Self(assignment))
    }
}

impl Question {
    /// Refuses a plot without a quantity to plot against.
    pub(crate) fn needs_abscissa(&self) -> Result<(), Error> {
        if self.plot.is_some() && self.along.is_none() {
            let message = "--plot: give a quantity to plot against by --along NAME=FROM..TO";
            return Err(Error::Usage(message.to_owned()));
        }
        Ok(())
    }

    /// Obtains the equations, reads the values and passes both on.
    pub(crate) fn with<T>(
        &self,
        then: impl FnOnce(&Resolved<'_>, &Setup<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let model = engine::model(&self.model, &self.set, None)?;
        let mut setup = model.setup()?;
        setup.set(&self.set)?;
        let question = appell::steady::Question {
            parameters: self.set.clone(),
            fix: self.fix.clone(),
            free: self.free.clone(),
            along: self.along.clone(),
            require: self.require.iter().map(|least| least.0.clone()).collect(),
            starts: self.starts,
            ignore_ranges: self.ignore_ranges,
        };
        then(&model.resolve(&question)?, &setup)
    }

    /// The motions, printed with what there is to say `about` the stability of each alone, and written to the requested
    /// files; `figure` draws branches.
    pub(crate) fn answer(
        &self,
        asked: &Resolved<'_>,
        about: impl Fn(&Stability) -> String,
        figure: impl Fn(Term, &[Branch]) -> Figure,
    ) -> Result<(), Error> {
        let answer = progress::during("searching for steady motions", |_| asked.answer())?;
        let told = match &answer {
            Answer::Motions(motions) => {
                let each = motions.iter().map(|(_, stability)| about(stability));
                text::motions(asked, motions) + &each.collect::<String>()
            }
            Answer::Branches(branches) => text::branches(asked, branches),
        };
        let svg = || match (&answer, asked.along) {
            (Answer::Branches(branches), Some((along, _))) => {
                Some(figure(along, branches).to_svg())
            }
            _ => None,
        };
        self.write(
            asked,
            &told,
            || appell::json::steady(asked, &answer),
            |to| export::csv(asked, &answer, to),
            svg,
        )
    }

    /// Prints the structure of the equations with a text, and writes the requested files.
    pub(crate) fn write(
        &self,
        asked: &Resolved<'_>,
        told: &str,
        json: impl FnOnce() -> Value,
        csv: impl FnOnce(&mut dyn Write) -> io::Result<()>,
        svg: impl FnOnce() -> Option<String>,
    ) -> Result<(), Error> {
        output::json(self.json.as_deref(), json)?;
        if let Some(path) = &self.csv {
            files::write_with(path, csv)?;
        }
        if let Some((path, svg)) = self.plot.as_ref().and_then(|path| Some((path, svg()?))) {
            picture::write(path, &svg)?;
        }
        let text = text::structure(asked) + told;
        output::print_beside(&text, &[&self.csv, &self.json, &self.plot])
    }
}
