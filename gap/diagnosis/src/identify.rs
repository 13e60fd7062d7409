//! Identification of parameters from recordings, with their identifiability.
//!
//! ```text
//! data set --start--> initial values: noise standard deviations, states at the first rows
//!          --steps--> whether the filter may step from row to row
//!          --problem--> the unknowns: parameters within their tolerances, noise standard deviations
//!          --basin, fit (estimate)--> maximum a posteriori, for the nominal and for the free parameters
//!          --basin, shooting--> other starting points, where the fitted model does not reproduce the recordings
//!          --answer--> intervals, correlation, determined combinations
//!          --repeatability--> values of the single runs, and their spread
//!          --held_out--> prediction errors on the held-out runs
//! ```
//!
//! The likelihood is that of the innovations of an extended Kalman filter with process noise on
//! every pseudo-velocity, whose intensity is estimated too (`appell_estimate`). A wrong model
//! therefore shows as large process noise, not as wrong parameters with narrow intervals; and the
//! robust intervals do not assume white residuals.

mod additions;
mod answer;
mod basin;
mod drift;
mod error;
mod held_out;
mod options;
mod problem;
mod repeatability;
mod shooting;
mod start;
mod steps;

use appell_estimate::{Estimation, Fit, Setup};
use appell_runtime::model::Model;

use appell_recordings::{DataSet, Part, Run};

pub use crate::held_out::{AHEAD, HORIZONS};
pub use answer::{Answer, Estimate, Known, Level};
pub use appell_estimate::HALF_WIDTH_95;
pub use drift::Course;
pub use error::IdentifyError;
pub use held_out::{HeldOut, Trace};
pub use options::{Begin, Options};
pub use repeatability::Repeatability;

use basin::Search;
use held_out::Test;
pub(crate) use options::longest_step;
pub(crate) use problem::{Problem, begin, possible};

/// Fits the parameters of a model to the training runs by maximum likelihood, and measures
/// prediction errors on the others. `stage` is called with the name of each stage.
pub fn identify(
    set: &DataSet,
    model: &dyn Model,
    options: &Options,
    mut stage: impl FnMut(&'static str),
) -> Result<Answer, IdentifyError> {
    let measured = set.measured(model.info());
    if measured.is_empty() {
        return Err(IdentifyError::NothingMeasured);
    }
    let shown: Vec<_> = measured.iter().map(|(_, shown)| *shown).collect();
    let mut setup = Setup {
        longest_step: longest_step(set.mechanism.longest_step),
        ..Setup::new(model, &shown)
    };
    let additions = additions::named(&options.additional, set, &setup)?;
    for addition in &additions {
        addition.prepare(&mut setup);
    }
    let drifts = drift::named(&options.drifting, set, model.info())?;
    drift::prepare(&drifts, &mut setup);
    let recordings = set.recordings(Part::Fit, model.info())?;
    if recordings.is_empty() {
        return Err(IdentifyError::NothingToFit);
    }
    let problem = {
        let estimation = Estimation::new(&setup, &recordings)?;
        Problem::of(set, &estimation, options, &additions)?
    };
    setup.has_corners = steps::are_too_long(&setup, &recordings, &problem.start)?;
    let mut fits = |setup: &Setup<'_>| -> Result<(Fit, Fit), IdentifyError> {
        stage("fitting the noise of the nominal model");
        let search = Search {
            estimation: &Estimation::new(setup, &recordings)?,
            problem: &problem,
            options,
        };
        let nominal = search.levels(&problem.start)?;
        let fit = search.best(&nominal, &mut stage)?;
        Ok((nominal, fit))
    };
    let (mut nominal, mut fit) = fits(&setup)?;
    if steps::are_too_long(&setup, &recordings, &fit.values)? {
        setup.has_corners = true;
        (nominal, fit) = fits(&setup)?;
    }
    let estimation = Estimation::new(&setup, &recordings)?;
    stage("computing intervals and identifiable combinations");
    let mut answer = Answer::of(set, &estimation, &problem, &nominal, &fit)?;
    let runs: Vec<&Run> = (set.runs.iter())
        .filter(|run| run.part == Part::Fit)
        .collect();
    if runs.len() > 1 {
        stage("fitting each run alone");
        let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
        answer.repeatability =
            repeatability::repeatability(&names, &estimation, &problem, &fit, &answer.parameters)?;
    }
    answer.courses = drift::courses(&drifts, &estimation, &fit.values, &runs)?;
    stage("predicting the held-out runs");
    let recordings = set.recordings(Part::Test, model.info())?;
    if recordings.is_empty() {
        return Ok(answer);
    }
    let estimation = Estimation::new(&setup, &recordings)?;
    let test = Test::new(set, &estimation, [&nominal.values, &fit.values], &drifts)?;
    answer.held_out = test.errors()?;
    answer.traces = test.traces()?;
    Ok(answer)
}
