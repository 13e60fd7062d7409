//! Parameters from recordings, with what the recordings cannot tell.
//!
//! ```text
//! data set --start--> values to begin with: levels of noise, states at the first rows
//!          --shooting--> parameters to begin with, where asked for
//!          --problem--> what is looked for: parameters within their tolerances, levels
//!          --fit (estimate)--> the most likely values, beside the most likely nominal ones
//!          --answer--> intervals, correlation, combinations that are known
//!          --held_out--> errors of predictions on the runs that no fit has seen
//! ```
//!
//! The likelihood is that of the innovations of an extended Kalman filter with disturbing forces on
//! every pseudo-velocity, whose levels are estimated too (`appell_estimate`). A model that
//! is wrong therefore shows as large disturbances, not as wrong parameters with narrow intervals; and
//! the robust intervals do not believe that what is left is white.

mod additions;
mod answer;
mod drift;
mod error;
mod held_out;
mod problem;
mod shooting;
mod start;

use appell_estimate::{Estimation, Fit, Setup};
use appell_runtime::model::Model;

use crate::data::{DataSet, Part, Run};

pub use answer::{Answer, Estimate, Known, Level};
pub use drift::Course;
pub use error::IdentifyError;
pub use held_out::{AHEAD, HORIZONS, HeldOut, Trace};

use held_out::Test;
use problem::EFFORT;
pub(crate) use problem::{Problem, begin};

/// Steps of the integration are this long in s at most, where the equations are not fast.
const LONGEST_STEP: f64 = 0.02;

/// Where the search for parameters begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Begin {
    /// At the values of the rig.
    #[default]
    Nominal,
    /// Where multiple shooting ends that begins there: for values far from the truth.
    Shooting,
}

/// What is identified.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Parameters to look for; nothing means those that the data set states a tolerance for.
    pub free: Option<Vec<String>>,
    /// What to look for besides: `tau.lag` and `tau.delay` of inputs; `theta.bias`, `theta.scale` and
    /// `theta.delay` of channels.
    pub also: Vec<String>,
    /// Parameters that change on the way, with the standard deviations of their changes in one second,
    /// in their units.
    pub drifting: Vec<(String, f64)>,
    /// Whether it is no mistake that no parameter is free.
    pub none_will_do: bool,
    /// Where the search begins.
    pub begin: Begin,
}

impl Options {
    /// All parameters with a tolerance, if there are any.
    pub(crate) fn tolerant() -> Self {
        Self {
            none_will_do: true,
            ..Self::default()
        }
    }
}

/// The longest step in s of the integration, where equations bear no longer one than this.
pub(crate) fn longest_step(borne: Option<f64>) -> f64 {
    borne.map_or(LONGEST_STEP, |borne| borne.min(LONGEST_STEP))
}

/// Finds the parameters of a model that make the runs to fit most likely, and measures its errors on
/// the others. `stage` is told what begins.
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
    let additions = additions::named(&options.also, set, &setup)?;
    for addition in &additions {
        addition.prepare(&mut setup);
    }
    let drifts = drift::named(&options.drifting, set, model.info())?;
    drift::prepare(&drifts, &mut setup);
    let recordings = set.recordings(Part::Fit, model.info())?;
    if recordings.is_empty() {
        return Err(IdentifyError::NothingToFit);
    }
    let estimation = Estimation::new(&setup, &recordings)?;
    let problem = Problem::of(set, &estimation, (options, &additions))?;

    stage("fitting the levels of noise to the nominal model");
    let nominal = Fit::of(&estimation, &problem.start, &problem.levels, EFFORT)?;
    let begin = match options.begin {
        Begin::Nominal => nominal.values.clone(),
        Begin::Shooting => {
            stage("shooting at the recordings");
            shooting::shot(&estimation, &problem, &nominal.values)?
        }
    };
    stage("fitting the parameters");
    let all = [problem.wanted.as_slice(), &problem.levels].concat();
    let fit = Fit::of(&estimation, &begin, &all, EFFORT)?;
    stage("weighing what the recordings tell");
    let mut answer = Answer::of(set, &estimation, &problem, (&nominal, &fit))?;
    let runs: Vec<&Run> = set
        .runs
        .iter()
        .filter(|run| run.part == Part::Fit)
        .collect();
    answer.courses = drift::courses(&drifts, &estimation, &fit.values, &runs)?;
    stage("predicting the runs that were held out");
    let recordings = set.recordings(Part::Test, model.info())?;
    if recordings.is_empty() {
        return Ok(answer);
    }
    let estimation = Estimation::new(&setup, &recordings)?;
    let test = Test::new(set, &estimation, ([&nominal.values, &fit.values], &drifts))?;
    answer.held_out = test.errors()?;
    answer.traces = test.traces()?;
    Ok(answer)
}
