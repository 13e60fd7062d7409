//! `appell steady`

use appell_analysis::{Branch, Term};
use appell_report::figure::Figure;

use crate::failure::Error;
use crate::motions::{self, Question, text};
use crate::output;
use crate::picture;
use appell::files;
use appell::steady::{Answer, Resolved, export};

/// Finds steady motions, that is, relative equilibria, alone or along a quantity.
///
/// In a steady motion the essential states are constant while ignorable coordinates advance uniformly.
/// Conditions are values of states, inputs, outputs and rates of ignorable coordinates; if they leave
/// a family of motions, the answer names the quantities that may be prescribed in addition. With
/// `--along` the motions are continued through folds and crossings. Values are in the unit of the
/// spec, or carry their own, as in `theta=10deg`.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell steady unicycle --fix theta=10deg --fix psi_dot=2
  appell steady bicycle --along speed=0.5..10 --csv steady.csv")]
pub(crate) struct Steady {
    #[command(flatten)]
    question: Question,
}

impl Steady {
    pub(super) fn run(&self) -> Result<(), Error> {
        self.question.needs_abscissa()?;
        self.question.with(|asked, _| {
            let answer = motions::answer(asked)?;
            let text = text::structure(asked)
                + &match &answer {
                    Answer::Motions(motions) => text::motions(asked, motions),
                    Answer::Branches(branches) => text::branches(asked, branches),
                };
            write(&self.question, asked, &answer, |along, branches| {
                let model = asked.problem.model();
                Figure::of_branches(model, along, &asked.terms(), branches)
            })?;
            output::print_beside(
                &text,
                &[&self.question.csv, &self.question.json, &self.question.plot],
            )
        })
    }
}

/// Writes the requested files.
pub(super) fn write(
    question: &Question,
    asked: &Resolved<'_>,
    answer: &Answer,
    figure: impl Fn(Term, &[Branch]) -> Figure,
) -> Result<(), Error> {
    if let Some(path) = &question.json {
        files::write_json(path, &appell::json::steady(asked, answer))?;
    }
    if let Some(path) = &question.csv {
        files::write_with(path, |to| export::csv(asked, answer, to))?;
    }
    if let (Some(path), Answer::Branches(branches), Some((along, _))) =
        (&question.plot, answer, asked.along)
    {
        picture::write(path, &figure(along, branches).to_svg())?;
    }
    Ok(())
}
