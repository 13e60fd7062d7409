//! `appell steady`

use appell_analysis::Branch;
use appell_report::figure::Figure;

use crate::failure::Error;
use crate::motions::Question;

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
            let figure = |along, branches: &[Branch]| {
                let model = asked.problem.model();
                Figure::of_branches(model, along, &asked.terms(), branches)
            };
            self.question.answer(asked, |_| String::new(), figure)
        })
    }
}
