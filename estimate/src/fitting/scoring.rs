//! Fits by scoring: every step has Fisher's information of its own, which takes few passes of the
//! filter ([`information`](crate::gradient::information)). For many fits of models that are nearly right.

use nalgebra::{DMatrix, DVector};

use super::fit::{Effort, Fit};
use super::free::{Coordinate, Free, Selection};
use super::level_scaling::LevelScaling;
use super::posterior::{Point, Posterior};
use crate::EstimateError;
use crate::estimation::Estimation;
use crate::gradient::information::is_level;

/// Part of the promised gain that makes a step worth it.
const ENOUGH: f64 = 0.05;
/// Damping of a step after one that failed undamped, relative to the curvature: in a narrow valley the
/// right one is small.
const DAMPING: f64 = 1e-4;
/// A step that fails is damped so much more.
const MORE: f64 = 8.0;
/// A step is damped so much less after one that kept this part of its promise.
const LESS: (f64, f64) = (5.0, 0.5);
/// Steps that are damped more than this move nothing, less than this are not damped.
const DAMPED: [f64; 2] = [2e-5, 1e6];
/// A place from which no step leads on may promise so many times what a step is worth.
const FLAT: f64 = 10.0;
/// So many steps that gain less together than one should have come to the end.
const LAST: usize = 6;
/// Change of a level's logarithm that makes no other information of it.
const NEAR: f64 = 0.3;

impl Fit {
    /// Looks for an optimum from `start` as [`Fit::of`] does, by scoring. The curvature of the result
    /// is the expected one. Where likelihoods are rough, as with friction that sticks, a search may end
    /// before an optimum: [`Fit::promised`] tells.
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
        let mut scaling = LevelScaling::of((estimation, &selection), &point)?;
        let (mut damping, mut steps) = (0.0, 0);
        let mut gained = [f64::INFINITY; LAST];
        loop {
            let (step, gain) = scaling.step((&posterior, &point), &information, damping);
            let promises_little = (0.0..=effort.gain).contains(&gain);
            let gains_little = gained.iter().sum::<f64>() < effort.gain;
            let ends = steps >= effort.steps || damping > DAMPED[1];
            let is_over = promises_little && (damping <= 0.0 || gains_little);
            if is_over || ends {
                let (mut promised, mut gain) = (DVector::zeros(free.len()), gain);
                if !is_over {
                    let (step, more) = scaling.step((&posterior, &point), &information, DAMPING);
                    // Where no step helps, the place is good if little was promised at all.
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
            // Coordinates at their reach may make things worse together: a damped step does not.
            let next = (gain > 0.0).then(|| posterior.moved(&point, &step).ok());
            let is_better = |next: &Point| {
                next.objective.is_finite() && point.is_worse_than(next, ENOUGH * gain)
            };
            match next.flatten().filter(is_better) {
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
                    scaling = LevelScaling::of((estimation, &selection), &point)?;
                }
                None => damping = (MORE * damping).max(DAMPING),
            }
        }
    }
}

/// The information of levels, where it was computed last.
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
            // Far below its optimum the likelihood bends by a level as much as it slopes, and much
            // more than is expected where the level is right.
            if free.coordinate == Coordinate::Logarithm {
                information[(i, i)] += point.gradient[i].abs();
            }
        }
        Ok(information)
    }
}
