//! `appell steady`

use appell_analysis::{Branch, Term};
use appell_report::figure::{Figure, Panel, Series};

use crate::failure::note;
use crate::motions::{self, Question, text};
use crate::output;
use crate::picture;
use appell::Error;
use appell::files;
use appell::steady::{Answer, Asked, export};

/// Finds steady motions, that is, relative equilibria, alone or along a quantity.
///
/// In a steady motion the essential states are constant while ignorable coordinates advance uniformly.
/// Conditions are values of states, inputs, outputs and rates of ignorable coordinates; if they leave
/// a family of motions, the answer names the quantities that may be prescribed in addition. With
/// `--along` the motions are continued through folds and crossings. Values are in the unit of the
/// spec, or carry their own, as in `theta=10deg`.
#[derive(Debug, clap::Args)]
pub(crate) struct Steady {
    #[command(flatten)]
    question: Question,
}

impl Steady {
    pub(super) fn run(&self) -> Result<(), Error> {
        self.question.with(|asked, _| {
            let answer = motions::answer(asked)?;
            let text = text::structure(asked)
                + &match &answer {
                    Answer::Motions(motions) => text::motions(asked, motions),
                    Answer::Branches(branches) => text::branches(asked, branches),
                };
            write(&self.question, asked, &answer, figure)?;
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
    asked: &Asked<'_>,
    answer: &Answer,
    figure: impl Fn(&Asked<'_>, Term, &[Branch]) -> Figure,
) -> Result<(), Error> {
    if let Some(path) = &question.json {
        files::write_json(path, &export::json(asked, answer))?;
    }
    if let Some(path) = &question.csv {
        files::write_with(path, |to| export::csv(asked, answer, to))?;
    }
    match (&question.plot, answer, asked.along) {
        (Some(path), Answer::Branches(branches), Some((along, _))) => {
            picture::write(path, &figure(asked, along, branches).to_svg())?;
        }
        (Some(_), ..) => {
            note("`--plot` needs a quantity to plot against: give `--along NAME=FROM..TO`");
        }
        _ => {}
    }
    Ok(())
}

/// Every quantity against the continuation parameter, one panel each.
fn figure(asked: &Asked<'_>, along: Term, branches: &[Branch]) -> Figure {
    let model = asked.problem.model();
    let info = model.info();
    let horizontal = along.quantity(info);
    let shown = |term: &Term| {
        let value = |branch: &Branch| -> Vec<f64> {
            let points = branch.points.iter();
            points.map(|at| term.value(model, &at.point)).collect()
        };
        let all: Vec<f64> = branches.iter().flat_map(value).collect();
        *term != along && all.iter().any(|v| v.abs() > 1e-12)
    };
    let panel = |term: Term| {
        let quantity = term.quantity(info);
        let series = branches.iter().enumerate().map(|(i, branch)| Series {
            label: if i == 0 {
                quantity.name.to_string()
            } else {
                format!("branch {}", i + 1)
            },
            x: branch
                .points
                .iter()
                .map(|at| horizontal.to_unit(at.value))
                .collect(),
            y: branch
                .points
                .iter()
                .map(|at| quantity.to_unit(term.value(model, &at.point)))
                .collect(),
        });
        Panel {
            unit: quantity.unit.to_string(),
            series: series.collect(),
        }
    };
    Figure {
        title: info.title.to_string(),
        x_label: format!("{} [{}]", horizontal.name, horizontal.unit),
        panels: asked.terms().into_iter().filter(shown).map(panel).collect(),
        marks: marks(asked, along, branches),
        equal_axes: false,
    }
}

/// A mark at every special point.
pub(super) fn marks(
    asked: &Asked<'_>,
    along: Term,
    branches: &[Branch],
) -> Vec<appell_report::figure::Mark> {
    let quantity = along.quantity(asked.problem.model().info());
    let specials = branches.iter().flat_map(|branch| &branch.specials);
    specials
        .map(|special| appell_report::figure::Mark {
            x: quantity.to_unit(special.motion.value),
            about: format!(
                "{} = {} {}",
                quantity.name,
                text::exact(quantity.to_unit(special.motion.value)),
                quantity.unit
            ),
        })
        .collect()
}
