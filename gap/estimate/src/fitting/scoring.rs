//! Fits by Fisher scoring: the information is computed anew for every step, which takes few passes
//! of the filter ([`information`](crate::gradient::information)). For many fits of models that are
//! nearly correct.

use nalgebra::{DMatrix, DVector};

use super::fit::{Effort, Fit};
use super::free::{Coordinate, Free, Selection};
use super::level_scaling::LevelScaling;
use super::posterior::{Point, Posterior, SUFFICIENT_DECREASE};
use crate::EstimateError;
use crate::estimation::Estimation;
use crate::gradient::information::is_level;

/// Damping after an undamped step failed, relative to the curvature; small, for narrow valleys.
const DAMPING: f64 = 1e-4;
/// Factor of the damping after a failed step.
const MORE: f64 = 16.0;
/// Divisor of the damping after a step that achieved this fraction of its predicted gain.
const LESS: (f64, f64) = (5.0, 0.5);
/// Damping below which steps are undamped, and beyond which they are negligible.
const DAMPED: [f64; 2] = [2e-5, 1e6];
/// Predicted gain, in units of [`Effort::gain`], that may remain when no step succeeds.
const FLAT: f64 = 10.0;
/// Number of steps that together must gain more than [`Effort::gain`].
const LAST: usize = 4;
/// Change of the logarithm of a level up to which its information is reused.
const NEAR: f64 = 0.3;

impl Fit {
    /// Searches for an optimum from `start` as [`Fit::of`] does, by scoring. The curvature of the
    /// result is the expected one. If the likelihood is rough, as with stick-slip friction, the
    /// search may end before an optimum, see [`Fit::promised`].
    pub fn quick(
        estimation: &Estimation<'_>,
        start: &[f64],
        free: &[Free],
        effort: Effort,
    ) -> Result<Self, EstimateError> {
        let selection = Selection::new(&estimation.layout(), free)?;
        let posterior = Posterior {
            estimation,
            selection: &selection,
        };
        let mut levels = Levels::default();
        let mut point = posterior.at(start)?;
        let mut information = levels.information(&posterior, &point)?;
        let mut scaling = LevelScaling::of(&posterior, &point)?;
        let (mut damping, mut steps) = (0.0, 0);
        let mut gained = [f64::INFINITY; LAST];
        loop {
            let (step, gain) = scaling.step(&posterior, &point, &information, damping);
            let promises_little = (0.0..=effort.gain).contains(&gain);
            let gains_little = gained.iter().sum::<f64>() < effort.gain;
            let ends = steps >= effort.steps || damping > DAMPED[1];
            let is_over = promises_little && (damping <= 0.0 || gains_little);
            if is_over || ends {
                let (mut promised, mut gain) = (DVector::zeros(free.len()), gain);
                if !is_over {
                    let (step, more) = scaling.step(&posterior, &point, &information, DAMPING);
                    // If no step succeeds, the point is accepted if the predicted gain is small.
                    if !(0.0..=FLAT * effort.gain).contains(&more) {
                        (promised, gain) = (step, more);
                    }
                }
                return Ok(Self {
                    free: free.to_vec(),
                    at_limit: point.is_held,
                    values: point.values,
                    coordinates: point.coordinates,
                    log_likelihood: point.log_likelihood,
                    log_posterior: point.objective,
                    curvature: information.clone(),
                    information,
                    promised,
                    gain,
                    steps,
                });
            }
            steps += 1;
            // A step with several coordinates at their largest change may fail; a damped one does
            // not.
            let next = (gain > 0.0)
                .then(|| posterior.bettered(&point, &step, SUFFICIENT_DECREASE * gain))
                .flatten();
            match next {
                Some(next) => {
                    let kept = next.objective - point.objective;
                    gained.rotate_left(1);
                    gained[LAST - 1] = kept;
                    if kept > LESS.1 * gain {
                        damping /= LESS.0;
                    }
                    if damping < DAMPED[0] {
                        damping = 0.0;
                    }
                    point = next;
                    information = levels.information(&posterior, &point)?;
                    scaling = LevelScaling::of(&posterior, &point)?;
                }
                None => damping = (MORE * damping).max(DAMPING),
            }
        }
    }
}

/// The information of levels, and the point at which it was computed.
#[derive(Default)]
struct Levels {
    known: Option<(Vec<f64>, DMatrix<f64>)>,
}

impl Levels {
    /// Expected curvature at a point. The information of logarithms of levels hardly depends on the
    /// levels.
    fn information(
        &mut self,
        posterior: &Posterior<'_, '_>,
        point: &Point,
    ) -> Result<DMatrix<f64>, EstimateError> {
        let (estimation, selection) = (posterior.estimation, posterior.selection);
        let free = selection.free;
        let all = free.iter().zip(point.coordinates.iter());
        let levels: Vec<f64> = all
            .filter(|(free, _)| is_level(free))
            .map(|(_, &coordinate)| coordinate)
            .collect();
        let is_near = |old: &[f64]| {
            let mut moved = old.iter().zip(&levels).map(|(old, new)| (old - new).abs());
            moved.all(|moved| moved < NEAR)
        };
        let of_levels = match self.known.take().filter(|(old, _)| is_near(old)) {
            Some(known) => known,
            None => (
                levels,
                estimation.information_of_levels(&point.values, free)?,
            ),
        };
        let mut information = estimation.information_of_means(&point.values, free)?;
        information += &of_levels.1;
        information += DMatrix::from_diagonal(&selection.prior_information());
        self.known = Some(of_levels);
        for (i, free) in free.iter().enumerate() {
            // Far below the optimum of a level, the curvature of the likelihood is as large as its
            // slope, and much larger than expected at the optimum.
            if free.coordinate == Coordinate::Logarithm {
                information[(i, i)] += point.gradient[i].abs();
            }
        }
        Ok(information)
    }
}
