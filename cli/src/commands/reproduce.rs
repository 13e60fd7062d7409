//! `appell reproduce`

use std::path::PathBuf;

use serde::Serialize;

use crate::failure::{Failure, tell};
use crate::reproduce::{self, Claim, Section};
use crate::{files, progress};

/// Recomputes a paper: every equation, table and figure beside what is published, as a book.
///
/// The book is one page that needs no network. Beside the one on the electric unicycle its simulated
/// rides are written, as data sets for `appell diagnose`. The exit status is 4 if a statement that should hold
/// does not.
#[derive(Debug, clap::Args)]
pub(crate) struct Reproduce {
    /// The paper
    #[arg(value_enum, default_value_t = Paper::Steering)]
    paper: Paper,
    /// Points of the charts of the paper on steering along each axis
    #[arg(long, value_name = "COUNT", default_value_t = 240, value_parser = clap::value_parser!(u16).range(20..=1000))]
    grid: u16,
    /// Folder for the book
    #[arg(long, value_name = "DIR", default_value = "reproduced")]
    out: PathBuf,
    /// Write all statements with their verdicts; `-` is standard output
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

/// Everything for programs.
#[derive(Serialize)]
struct Book<'a> {
    paper: &'a str,
    claims: usize,
    holding: usize,
    errata: usize,
    sections: &'a [Section],
}

impl Reproduce {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let bar = progress::parts();
        let making = |name: &str, done: usize, of: usize| {
            bar.set_length(of as u64);
            bar.set_position(done as u64);
            bar.set_message(name.to_owned());
        };
        let sections = match self.paper {
            Paper::Steering => reproduce::steering(usize::from(self.grid), making),
            Paper::Euc => reproduce::euc(&self.out.join("rides"), making),
        };
        bar.finish_and_clear();
        let sections = sections?;
        let title = self.paper.title();
        let file = self.out.join(self.paper.file());
        files::write(&file, &reproduce::page(title, &sections))?;
        let claims: Vec<&Claim> = sections
            .iter()
            .flat_map(|section| &section.claims)
            .collect();
        let book = Book {
            paper: title,
            claims: claims.len(),
            holding: claims.iter().filter(|claim| claim.holds).count(),
            errata: claims
                .iter()
                .filter(|claim| claim.verdict.is_erratum())
                .count(),
            sections: &sections,
        };
        if let Some(path) = &self.json {
            files::write_json(path, &book)?;
        }
        let text = format!(
            "{title}\n  {} statements, {} as they should be, {} errata\n  {}\n",
            book.claims,
            book.holding,
            book.errata,
            file.display()
        );
        files::print_beside(&text, &[&self.json])?;
        let failed: Vec<&Claim> = claims.into_iter().filter(|claim| !claim.holds).collect();
        if failed.is_empty() {
            return Ok(());
        }
        for claim in &failed {
            tell(&format!(
                "{}: {}\n  found: {}\n",
                claim.place, claim.published, claim.ours
            ));
        }
        Err(Failure::Computation(format!(
            "{} of {} statements did not come out as they should",
            failed.len(),
            book.claims
        )))
    }
}
