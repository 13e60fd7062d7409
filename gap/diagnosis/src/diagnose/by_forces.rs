//! Diagnosis by the forces of recorded motions, for robots: every pseudo-velocity is the rate of a driven
//! coordinate, all coordinates are measured and all inputs recorded.
//!
//! M ω̇ + b − Π vanishes on a recorded motion if the model is right. It is linear in the sizes of effects, so that
//! every hypothesis is a weighted least-squares problem, and no simulation has to reproduce a motion that is dominated
//! by friction and stiff gears (M. Gautier, W. Khalil, *Identification of the dynamic parameters of robots*, 1990).
//! Effects on channels, or between an input and its force, are not considered.
//!
//! | file | idea |
//! |---|---|
//! | `motions.rs` | residual forces of recorded motions, and their derivatives by the sizes |
//! | `hypothesis.rs` | some candidates fitted, with their evidence |
//! | `search.rs` | the most probable hypotheses |
//! | `report.rs` | the report, with forces over time and over their variables |

mod hypothesis;
mod motions;
mod report;
mod search;

use appell_recordings::{DataSet, Measured, Part as OfSet, Role};
use appell_spec::mechanism::ParameterId;

use super::report::Told;
use super::{Before, Options, Report, Result};
use crate::base::BaseError;
use crate::effects::{Acts, Candidate, EffectModel, Part, driven};
use motions::Motions;
use search::Search;

/// Smallest number of joints of a robot; mechanisms with fewer are diagnosed by simulation.
const FEWEST: usize = 3;
/// The same for a robot that was read from its file.
const FEWEST_OF_FILE: usize = 2;

/// Largest number of searches, each with the forces at the shapes that the one before found.
const ROUNDS: usize = 3;

/// Whether the recordings determine the residual force of every equation.
pub(super) fn applies(set: &DataSet, options: &Options) -> bool {
    determines_forces(set, options, FEWEST)
}

/// Whether the mechanism is a robot, which simulations over windows judge: the same, with fewer joints if it was read
/// from the file of a robot.
pub(super) fn is_of_robot(set: &DataSet, options: &Options) -> bool {
    let fewest = if set.robot.is_some() {
        FEWEST_OF_FILE
    } else {
        FEWEST
    };
    determines_forces(set, options, fewest)
}

fn determines_forces(set: &DataSet, options: &Options, fewest: usize) -> bool {
    let mechanism = &set.mechanism;
    let has = |role: Role| set.channels.iter().any(|channel| channel.role == role);
    let measured = |q: usize| has(Role::Measures(Measured::Coordinate(q)));
    let coordinates = mechanism.coordinates.len();
    coordinates >= fewest
        && driven(mechanism).len() == coordinates
        && mechanism.pseudo_velocities.len() == coordinates
        && mechanism
            .coordinates
            .ids()
            .all(|q| mechanism.speed_of(q).is_some())
        && mechanism.inputs.len() == coordinates
        && mechanism.constraints.is_empty()
        && (0..coordinates).all(measured)
        && (0..mechanism.inputs.len()).all(|input| has(Role::Input(input)))
        && options.alternatives.is_empty()
}

/// Estimates of the parameters with a tolerance, from recorded motions.
pub(super) fn told(set: &DataSet) -> Result<Told> {
    let model = EffectModel::of_forces(&set.spec, Vec::new())?;
    let fit = set.only(OfSet::Fit).bound_to(&model.mechanism);
    let motions = Motions::of(&fit, &model)?;
    let refitted = Search::new(&model, &fit, &motions).refitted();
    let (places, moves) = refitted.ok_or(BaseError::NotFinite)?;
    let inverse = moves.information.try_inverse();
    let covariance = inverse.ok_or(BaseError::NotFinite)?;
    let deviations = covariance.diagonal().map(f64::sqrt);
    let correlation = covariance.component_div(&(&deviations * deviations.transpose()));
    let names = &fit.mechanism.parameters;
    let values = places.iter().zip(&moves.values).zip(&deviations);
    let parameters = values.map(|((&place, moved), &std)| Before {
        name: names[ParameterId::new(place)].label.name.clone(),
        value: fit.parameters[place].value + moved,
        std,
        spread: 0.0,
    });
    Ok(Told::new(parameters.collect(), &correlation))
}

/// The diagnosis; held-out runs and earlier recordings are read at its end only.
pub(super) fn diagnose(
    set: &DataSet,
    before: Option<&DataSet>,
    model: &EffectModel,
    options: &Options,
    stage: &mut impl FnMut(&'static str),
) -> Result<Report> {
    stage("evaluating the forces of the recorded motions");
    let mut fit = set.only(OfSet::Fit).bound_to(&model.mechanism);
    let mut training = Motions::of(&fit, model)?;
    stage("fitting the effects to the forces");
    let mut shapes: Vec<(usize, f64)> = Vec::new();
    let mut rounds = ROUNDS;
    let found = loop {
        let search = Search::new(model, &fit, &training);
        let found = search.found().ok_or(BaseError::NotFinite)?;
        rounds -= 1;
        let Some(moved) = search.moved(found.best()).filter(|_| rounds > 0) else {
            break found;
        };
        shapes = moved;
        fit = shaped(&fit, &shapes);
        training = Motions::of(&fit, model)?;
    };
    stage("predicting the forces of the held-out runs");
    let motions =
        |set: &DataSet| Motions::of(&shaped(&set.bound_to(&model.mechanism), &shapes), model);
    let test = Some(set.only(OfSet::Test)).filter(|test| !test.runs.is_empty());
    let test = test.map(|test| motions(&test)).transpose()?;
    let before = before.map(motions).transpose()?;
    let (test, before) = (test.as_ref(), before.as_ref());
    let search = Search::new(model, &fit, &training);
    search.report(&found, test, before, options)
}

/// A data set with other values of some parameters.
fn shaped(set: &DataSet, shapes: &[(usize, f64)]) -> DataSet {
    let mut set = set.clone();
    for &(parameter, value) in shapes {
        set.parameters[parameter].value = value;
    }
    set
}

/// Whether a candidate is a parameter or adds forces that are linear in its sizes.
pub(super) fn acts(candidate: &Candidate) -> bool {
    let sizes = candidate.parameters.iter().map(|(_, part)| *part);
    let mut others = sizes.clone().filter(|part| *part != Part::Size);
    match candidate.acts {
        Acts::Items => {
            candidate.brings.is_none()
                && sizes.clone().any(|part| part == Part::Size)
                && others.all(Part::is_shape)
        }
        Acts::Parameter(_) => true,
        _ => false,
    }
}
