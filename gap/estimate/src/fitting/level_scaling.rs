//! Level scaling: levels of process noise relative to the inertia of the model.
//!
//! Noise levels are forces, but recordings determine accelerations: doubling a mass doubles the level
//! that fits. Scaled to accelerations, levels decouple from the masses.

use nalgebra::{DMatrix, DVector};

use super::levels;
use super::posterior::{Point, Posterior};
use crate::EstimateError;
use crate::data::setup::Disturbance;
use crate::data::unknown::Unknown;
use crate::estimation::Estimation;
use crate::motion::command;
use crate::motion::plant::Place;

/// Largest change of the logarithm of a level by the other coordinates.
const FARTHEST: f64 = 1.0;

/// Changes of levels with steps of the other coordinates, to first order.
pub(crate) struct LevelScaling {
    /// A row and a column for each coordinate.
    slopes: DMatrix<f64>,
}

impl LevelScaling {
    /// About a point.
    pub(crate) fn of(posterior: &Posterior<'_, '_>, point: &Point) -> Result<Self, EstimateError> {
        let (estimation, selection) = (posterior.estimation, posterior.selection);
        let free = selection.free;
        let mut slopes = DMatrix::zeros(free.len(), free.len());
        let levels: Vec<(usize, usize)> = (0..free.len())
            .filter_map(|i| match free[i].unknown {
                Unknown::Disturbance(index) => match estimation.setup().disturbances[index] {
                    Disturbance::Force(speed) => Some((i, speed)),
                    Disturbance::Rate(_) => None,
                },
                _ => None,
            })
            .collect();
        for (j, parameter) in free.iter().enumerate() {
            if !matches!(parameter.unknown, Unknown::Parameter(_)) {
                continue;
            }
            let change = parameter.small_change(selection.value(&point.values, j));
            let [below, above] = [-change, change].map(|change| {
                let values = selection.changed(&point.values, j, change);
                mobilities(estimation, &values)
            });
            let (below, above) = (below?, above?);
            for &(i, speed) in &levels {
                let slope = (below[speed] / above[speed]).ln() / (2.0 * change);
                if slope.is_finite() {
                    slopes[(i, j)] = slope;
                }
            }
        }
        Ok(Self { slopes })
    }

    /// The step of [`levels::step`] in coordinates with levels scaled to accelerations.
    pub(crate) fn step(
        &self,
        posterior: &Posterior<'_, '_>,
        point: &Point,
        curvature: &DMatrix<f64>,
        damping: f64,
    ) -> (DVector<f64>, f64) {
        let gradient = &point.gradient + self.slopes.tr_mul(&point.gradient);
        let turned = Point {
            gradient,
            ..point.clone()
        };
        let (step, gain) = levels::step(posterior, &turned, curvature, damping);
        // To first order only: a level does not follow a step far beyond that.
        let scaled = (&self.slopes * &step).map(|change| change.clamp(-FARTHEST, FARTHEST));
        (step + scaled, gain)
    }
}

/// Acceleration of each pseudo-velocity per unit force in its own equation, at the start of the
/// runs: geometric mean.
fn mobilities(estimation: &Estimation<'_>, values: &[f64]) -> Result<Vec<f64>, EstimateError> {
    let (layout, plant) = (estimation.layout(), estimation.plant(0));
    let (n, s) = (plant.n, plant.speeds);
    let mut scratch = plant.scratch();
    let mut logs = vec![0.0; s];
    let runs = estimation.recordings();
    for (run, recording) in runs.iter().enumerate() {
        let first = layout.place(Unknown::Initial { run, state: 0 })?;
        let commands = command::at_start(recording);
        let (t, z) = (recording.times()[0], &values[first..first + n]);
        let mut columns = vec![0.0; s * s];
        columns
            .iter_mut()
            .step_by(s + 1)
            .for_each(|entry| *entry = 1.0);
        let place = Place::new(layout, values, t, z, &commands);
        estimation
            .plant(run)
            .accelerations(place, &mut scratch, &mut columns);
        for (log, mobility) in logs.iter_mut().zip(columns.iter().step_by(s + 1)) {
            *log += mobility.abs().ln() / runs.len() as f64;
        }
    }
    Ok(logs.into_iter().map(f64::exp).collect())
}
