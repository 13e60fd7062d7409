//! Motions at which the equations are evaluated: random ones, and recorded ones as splines.

use std::f64::consts::PI;

use appell_estimate::inverse::{InverseError, Moment, Motion, Record, Relations, Track};
use appell_recordings::{DataSet, Part, Role, Run};
use appell_runtime::model::{Model, Quantity};
use appell_runtime::positions::{Moving, Positions};
use nalgebra::{DMatrix, DVector};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use super::error::BaseError;
use crate::inverse::coordinates;

/// Largest pseudo-velocity of a random motion, in SI.
const SPEED: f64 = 3.0;
/// Largest pseudo-acceleration, in SI.
const ACCELERATION: f64 = 10.0;
/// Largest input, in SI.
const INPUT: f64 = 5.0;

/// Random motions within the ranges of the coordinates; within a full turn where there is none.
pub(super) fn random(model: &dyn Model, count: usize, p: &[f64]) -> Vec<Moment> {
    let info = model.info();
    let mut random = SplitMix64::seed_from_u64(1);
    let mut between = move |low: f64, high: f64| {
        let uniform = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * uniform
    };
    let mut positions = Positions::of(model);
    let mut moments = Vec::with_capacity(count);
    for _ in 0..count {
        let speeds = (0..info.speeds).map(|_| between(-SPEED, SPEED));
        let mut x: Vec<f64> = speeds.collect();
        let coordinate = |q: &Quantity| {
            let [low, high] = q.range;
            (low.max(q.value - PI), high.min(q.value + PI))
        };
        let ranges = info.coordinate_quantities().iter().map(coordinate);
        x.extend(ranges.map(|(low, high)| between(low, high)));
        let accelerations = (0..info.speeds).map(|_| between(-ACCELERATION, ACCELERATION));
        let accelerations: Vec<f64> = accelerations.collect();
        let u: Vec<f64> = (0..info.input_len())
            .map(|_| between(-INPUT, INPUT))
            .collect();
        if let Some(positions) = &mut positions
            && positions
                .restore(model, 0.0, &mut x, &u, p, Moving::All)
                .is_err()
        {
            continue;
        }
        moments.push(Moment {
            t: 0.0,
            x,
            accelerations,
            u,
        });
    }
    moments
}

/// Recorded motions whose errors do not depend on those of other stretches.
pub(crate) struct Stretch {
    pub(super) part: Part,
    /// The columns as splines: measured coordinates, then inputs.
    pub(super) motions: Vec<Motion>,
    /// How many of them are coordinates.
    pub(super) coordinates: usize,
    /// For derivatives of the orders r and s, at index 3 r + s: the covariance between the motions, times that of the
    /// samples.
    pub(super) shares: Vec<DMatrix<f64>>,
    /// Its run among those of the part.
    pub(crate) run: usize,
    pub(crate) moments: Vec<Moment>,
    /// Covariance at each of them: of every measured coordinate, then of every input, with its first and second
    /// derivative.
    pub(crate) spreads: Vec<DMatrix<f64>>,
}

/// The motions of all runs.
pub(crate) struct Recorded<'a> {
    pub(crate) stretches: Vec<Stretch>,
    /// Covariance of the samples of the training runs.
    pub(super) noise: DMatrix<f64>,
    pub(super) relations: Relations<'a>,
}

/// State, accelerations and recorded inputs of a motion.
pub(super) fn moment(
    relations: &Relations<'_>,
    motion: &Motion,
    p: &[f64],
) -> Result<Moment, InverseError> {
    let count = relations.measured().len();
    let mut moment = relations.moment(&coordinates_of(motion, count), p)?;
    let given = motion.derivatives[0].iter().skip(count);
    for (u, given) in moment.u.iter_mut().zip(given) {
        *u = *given;
    }
    Ok(moment)
}

/// The recorded motions.
pub(crate) fn recorded<'a>(
    set: &DataSet,
    model: &'a dyn Model,
    p: &[f64],
) -> Result<Recorded<'a>, BaseError> {
    let info = model.info();
    let columns = coordinates(set);
    let inputs = (0..info.declared_inputs).map(|input| {
        let mut channels = set.channels.iter();
        let place = channels.position(|channel| channel.role == Role::Input(input));
        place.ok_or_else(|| BaseError::NoInput {
            input: info.inputs[input].name.to_string(),
        })
    });
    let inputs: Vec<usize> = inputs.collect::<Result<_, _>>()?;
    let measured: Vec<usize> = columns.iter().map(|(_, coordinate)| *coordinate).collect();
    let mut stretches = Vec::new();
    let mut training = None;
    for part in [Part::Fit, Part::Test] {
        let runs = set.runs.iter().filter(|run| run.part == part);
        let record = |run: &Run| {
            let coordinates = columns.iter();
            let coordinates = coordinates.map(|(column, _)| run.values[*column].clone());
            let inputs = inputs.iter().map(|&column| {
                let values = &run.values[column];
                if set.channels[column].is_joined() {
                    values.clone()
                } else {
                    about_rows(values)
                }
            });
            let values = coordinates.chain(inputs).map(DVector::from_vec);
            Record {
                times: run.times.clone(),
                values: DMatrix::from_columns(&values.collect::<Vec<_>>()),
            }
        };
        let records: Vec<Record> = runs.map(record).collect();
        if records.is_empty() {
            continue;
        }
        let track = Track::beside(&records, inputs.len())?;
        let first = coordinates_of(&track.stretches[0].motions[0], measured.len());
        let relations = Relations::new(model, &measured, &first, p)?;
        for stretch in &track.stretches {
            let moments = stretch.motions.iter();
            let moments = moments.map(|motion| Ok(moment(&relations, motion, p)?));
            stretches.push(Stretch {
                part,
                run: stretch.run,
                moments: moments.collect::<Result<_, BaseError>>()?,
                spreads: (0..stretch.motions.len())
                    .map(|place| track.spread(stretch, place))
                    .collect(),
                motions: stretch.motions.clone(),
                coordinates: measured.len(),
                shares: stretch.spread.clone(),
            });
        }
        training.get_or_insert((track.noise, relations));
    }
    let (noise, relations) = training.ok_or(InverseError::TooShort)?;
    Ok(Recorded {
        stretches,
        noise,
        relations,
    })
}

/// An input that is held from row to row, about each of them: its mean over half a row before and after.
fn about_rows(values: &[f64]) -> Vec<f64> {
    let before = values.iter().take(1).chain(values);
    let means = before.zip(values).map(|(a, b)| 0.5 * (a + b));
    means.collect()
}

/// A motion with its coordinates alone.
fn coordinates_of(motion: &Motion, count: usize) -> Motion {
    Motion {
        t: motion.t,
        derivatives: (motion.derivatives.each_ref()).map(|all| all.rows(0, count).into_owned()),
    }
}
