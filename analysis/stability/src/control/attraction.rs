//! Region of attraction of a loop, by simulations from a grid of initial states.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};

use appell_runtime::inputs::InputSource;
use appell_runtime::model::Model;
use appell_runtime::simulate::{Simulation, SimulationError};
use appell_runtime::trajectory::Trajectory;

/// A state that the grid varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The state, by its index in the model.
    pub state: usize,
    /// Its initial values in SI.
    pub values: Vec<f64>,
}

/// Outcome of a motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Fate {
    /// It settled.
    Settled,
    /// It reached the end without settling.
    Unsettled,
    /// It left the range of a state, or became singular, at this time in s.
    Lost {
        /// When.
        time: f64,
    },
}

/// A grid of initial states about a steady motion.
pub struct Region<'a> {
    /// Equations of motion.
    pub model: &'a dyn Model,
    /// Parameters in SI.
    pub parameters: &'a [f64],
    /// The state on the steady motion in SI; the axes replace entries.
    pub state: &'a [f64],
    /// Creates the closed loop for each motion.
    pub inputs: &'a (dyn Fn() -> Box<dyn InputSource + 'a> + Sync),
    /// How long each motion lasts, in s.
    pub duration: f64,
    /// The varied states. The first axis runs slowest in the results.
    pub axes: Vec<Axis>,
    /// Whether a motion is settled at its end.
    pub settled: &'a (dyn Fn(&Trajectory) -> bool + Sync),
}

/// The outcomes of all motions of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Fates {
    /// The varied states.
    pub axes: Vec<Axis>,
    /// The states of the axes on the steady motion.
    pub centre: Vec<f64>,
    /// One for each point of the grid, the last axis running fastest.
    pub fates: Vec<Fate>,
}

impl Region<'_> {
    /// Simulates from every point of the grid, on all processors. `progress` is called with the
    /// number of finished motions, from any thread.
    pub fn explore(&self, progress: &(dyn Fn(usize) + Sync)) -> Result<Fates, SimulationError> {
        let count: usize = self.axes.iter().map(|axis| axis.values.len()).product();
        let done = AtomicUsize::new(0);
        let fate = |point| {
            let fate = self.fate(point);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            fate
        };
        // Motions take different times.
        let points = (0..count).into_par_iter().with_max_len(1);
        let fates: Vec<Result<Fate, SimulationError>> = points.map(fate).collect();
        let states = self.axes.iter().map(|axis| self.state.get(axis.state));
        let centre = states.map(|state| state.copied().unwrap_or(f64::NAN));
        Ok(Fates {
            axes: self.axes.clone(),
            centre: centre.collect(),
            fates: fates.into_iter().collect::<Result<_, _>>()?,
        })
    }

    fn fate(&self, point: usize) -> Result<Fate, SimulationError> {
        let mut simulation = Simulation::new(self.model);
        simulation.parameters = self.parameters.to_vec();
        simulation.initial_state = self.state.to_vec();
        for (axis, place) in self.axes.iter().zip(places(&self.axes, point)) {
            if let Some(x) = simulation.initial_state.get_mut(axis.state) {
                *x = axis.values[place];
            }
        }
        let inputs = (self.inputs)();
        simulation.inputs = &*inputs;
        simulation.span = [0.0, self.duration];
        let motion = match simulation.run() {
            Ok(motion) => motion,
            Err(SimulationError::Integration { trajectory, .. }) => {
                let time = trajectory.times().last().copied().unwrap_or(0.0);
                return Ok(Fate::Lost { time });
            }
            Err(error) => return Err(error),
        };
        let time = motion.times().last().copied().unwrap_or(0.0);
        Ok(if time < self.duration {
            Fate::Lost { time }
        } else if (self.settled)(&motion) {
            Fate::Settled
        } else {
            Fate::Unsettled
        })
    }
}

impl Fates {
    /// The largest fraction s such that every motion settles that begins within s times the largest
    /// disturbances of all axes: an inner estimate, as fine as the grid.
    pub fn safe_part(&self) -> f64 {
        let axes = || self.axes.iter().zip(&self.centre);
        let largest = |(axis, centre): (&Axis, &f64)| {
            let away = axis.values.iter().map(|value| (value - centre).abs());
            away.fold(f64::MIN_POSITIVE, f64::max)
        };
        let reach: Vec<f64> = axes().map(largest).collect();
        let part = |point: usize| {
            axes()
                .zip(places(&self.axes, point))
                .map(|((axis, centre), place)| (axis.values[place] - centre).abs())
                .zip(&reach)
                .map(|(distance, reach)| distance / reach)
                .fold(0.0, f64::max)
        };
        let parts = (0..self.fates.len()).map(|point| (part(point), &self.fates[point]));
        let failing = parts.clone().filter(|(_, fate)| **fate != Fate::Settled);
        let limit = failing.map(|(part, _)| part).fold(f64::INFINITY, f64::min);
        let safe = parts.map(|(part, _)| part).filter(|part| *part < limit);
        safe.fold(0.0, f64::max)
    }
}

/// Indices on the axes of a point of the grid.
fn places(axes: &[Axis], mut point: usize) -> Vec<usize> {
    let mut places: Vec<usize> = axes
        .iter()
        .rev()
        .map(|axis| {
            let count = axis.values.len().max(1);
            let place = point % count;
            point /= count;
            place
        })
        .collect();
    places.reverse();
    places
}
