//! Fits by Fisher scoring: the information is computed anew for every step, which takes few passes
//! of the filter ([`information`](crate::gradient::information)). For many fits of models that are
//! nearly correct.

use nalgebra::DVector;

use super::fit::{Effort, Fit};
use super::free::{Free, Selection};
use super::level_scaling::LevelScaling;
use super::levels::Levels;
use super::posterior::{Posterior, SUFFICIENT_DECREASE};
use crate::EstimateError;
use crate::estimation::Estimation;

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
/// A search is given up where this many times the next or the last gain do not reach [`Effort::floor`].
const GIVEN_UP: f64 = 4.0;

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
        let mut point = posterior.with_means(start)?;
        let mut information = levels.information(&posterior, &point)?;
        let mut scaling = LevelScaling::of(&posterior, &point)?;
        let (mut damping, mut steps, mut has_failed) = (0.0, 0, false);
        let mut gained = [f64::INFINITY; LAST];
        loop {
            let (step, gain) = scaling.step(&posterior, &point, &information, damping);
            let promises_little = (0.0..=effort.gain).contains(&gain);
            let gains_little = gained.iter().sum::<f64>() < effort.gain;
            let reach = point.objective + GIVEN_UP * gain.max(gained[LAST - 1]);
            let is_given_up = reach < effort.floor;
            let ends = is_given_up || steps >= effort.steps || damping > DAMPED[1];
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
                    promised,
                    gain,
                    steps,
                    ..Self::at(point, free, [information.clone(), information])
                });
            }
            steps += 1;
            // A step with several coordinates at their largest change may fail; a damped one does
            // not.
            let next = (gain > 0.0)
                .then(|| {
                    let least = SUFFICIENT_DECREASE * gain;
                    posterior.bettered(&point, &step, least, has_failed)
                })
                .flatten();
            has_failed = next.is_none();
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
