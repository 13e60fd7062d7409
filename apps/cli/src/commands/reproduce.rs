//! `appell reproduce`

use std::path::PathBuf;

use serde::Serialize;

use crate::failure::Error;
use crate::failure::tell;
use crate::output;
use crate::progress;
use appell::files;
use appell_papers::book::{self, Claim, Section, Tally};

/// Reproduces a paper: its equations, tables and figures against the published ones.
///
/// The report is one self-contained HTML page. For the electric unicycle the simulated rides are
/// written too, as data sets for `appell diagnose`. The exit status is 4 if a comparison has an
/// unexpected result.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell reproduce steering
  appell reproduce euc --out euc")]
pub(crate) struct Reproduce {
    /// The paper
    #[arg(value_enum, default_value_t = Paper::Steering)]
    paper: Paper,
    /// Points of the charts of the paper on steering along each axis
    #[arg(long, value_name = "COUNT", default_value_t = 240, value_parser = clap::value_parser!(u16).range(20..=1000))]
    grid: u16,
    /// Output folder
    #[arg(long, short, value_name = "DIR", default_value = "reproduced")]
    out: PathBuf,
    /// Write all statements with their comparison as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The papers that can be recomputed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Paper {
    /// Steering Control of an Autonomous Unicycle
    Steering,
    /// Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle
    Euc,
}

impl Paper {
    const fn title(self) -> &'static str {
        match self {
            Self::Steering => "Steering Control of an Autonomous Unicycle",
            Self::Euc => {
                "Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle \
                 with a Human Rider"
            }
        }
    }

    const fn file(self) -> &'static str {
        match self {
            Self::Steering => "steering.html",
            Self::Euc => "euc.html",
        }
    }
}

/// The book as JSON.
#[derive(Serialize)]
struct Book<'a> {
    schema: &'static str,
    paper: &'a str,
    /// Statements of the paper.
    statements: usize,
    #[serde(flatten)]
    tally: Tally,
    errata: usize,
    /// Comparisons that did not give their expected result.
    unexpected: usize,
    sections: &'a [Section],
}

impl Reproduce {
    pub(super) fn run(&self) -> Result<(), Error> {
        let bar = progress::parts();
        let making = |name: &str, done: usize, of: usize| {
            bar.set_length(of as u64);
            bar.set_position(done as u64);
            bar.set_message(name.to_owned());
        };
        files::make_folder(&self.out)?;
        let sections = match self.paper {
            Paper::Steering => book::steering::book(usize::from(self.grid), making),
            Paper::Euc => book::euc::book(&self.out.join("rides"), making),
        };
        bar.finish_and_clear();
        let sections = sections?;
        let title = self.paper.title();
        let file = self.out.join(self.paper.file());
        files::write(&file, &book::page(title, &sections))?;
        let claims: Vec<&Claim> = sections
            .iter()
            .flat_map(|section| &section.claims)
            .collect();
        let count = |is: &dyn Fn(&Claim) -> bool| claims.iter().filter(|claim| is(claim)).count();
        let tally = Tally::of(&sections);
        let book = Book {
            schema: "reproduced/1",
            paper: title,
            statements: tally.statements(),
            tally: tally.clone(),
            errata: count(&|claim| claim.erratum.is_some()),
            unexpected: count(&|claim| !claim.as_expected),
            sections: &sections,
        };
        output::json(self.json.as_deref(), || &book)?;
        let text = format!(
            "{title}\n  {}\n  {} errata\n  {}\n",
            tally.words(),
            book.errata,
            file.display()
        );
        output::print_beside(&text, &[&self.json])?;
        if book.unexpected == 0 {
            return Ok(());
        }
        for claim in claims.iter().filter(|claim| !claim.as_expected) {
            tell(&format!(
                "{}: {}\n  found: {}\n",
                claim.place, claim.published, claim.ours
            ));
        }
        Err(Error::Computation(format!(
            "{} of {} comparisons did not give their expected result",
            book.unexpected,
            claims.len()
        )))
    }
}
