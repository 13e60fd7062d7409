//! Multiple shooting: parameters of undisturbed motions, from starts far from the truth (H. G.
//! Bock, *Randwertproblemmethoden zur Parameteridentifizierung in Systemen nichtlinearer
//! Differentialgleichungen*, 1987).
//!
//! A recording is cut into segments, each with a free state at its first row, so that the effects
//! of wrong parameters grow only within a segment, also in unstable or chaotic motions. The gaps
//! between the segments are closed gradually by Gauss-Newton searches, from which the states are
//! eliminated by condensing ([`condensing`]). The result is one motion, the most likely one if only
//! measurements are noisy.

mod condensing;
mod segment;

use nalgebra::{DMatrix, DVector};

use super::EstimateError;
use super::estimation::Estimation;
use crate::data::recording::Recording;
use crate::data::unknown::Unknown;
use crate::fitting::free::{Coordinate, Free, Selection};
use condensing::{Condensed, Weights};
use segment::{Segment, SegmentIntegrator};

/// Admitted gaps between segments, relative to the scales of the states, for consecutive searches.
/// The last is negligible.
const GAPS: [f64; 8] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
/// Decrease of half the sum of squares below which the search ends.
const GAIN: f64 = 1e-8;
/// The same relative to the sum, because of rounding.
const ROUNDING: f64 = 1e-12;
/// Largest change of a logarithm in one step.
const REACH: f64 = 1.0;
/// Steps of a search.
const STEPS: usize = 60;
/// Sufficient decrease: least part of the predicted decrease at which a step is accepted. Smaller than
/// that of fits, as steps from far away gain less than predicted.
const SUFFICIENT_DECREASE: f64 = 1e-3;
/// Largest number of halvings of a step.
const CUTS: usize = 12;

/// Result of a search.
#[derive(Debug, Clone)]
pub struct Shot {
    /// All values. States at the first rows are those of the first segments.
    pub values: Vec<f64>,
    /// Admitted gaps between segments, relative to the scales of the states.
    pub gap: f64,
    /// Half the sum of squares: residuals relative to noise, gaps relative to the admitted ones,
    /// and deviations from priors.
    pub objective: f64,
    /// Information of the coordinates of the free values for an undisturbed motion.
    pub information: DMatrix<f64>,
}

/// Recordings in segments.
pub struct Shooting<'o, 'e> {
    estimation: &'o Estimation<'e>,
    selection: Selection<'o>,
    /// First rows of the segments, run by run.
    nodes: Vec<Vec<usize>>,
    /// Scales of the states.
    sizes: Vec<f64>,
    start: Trial,
}

/// Coordinates of the free values, and the states at the nodes, run by run.
#[derive(Debug, Clone)]
struct Trial {
    values: Vec<f64>,
    coordinates: DVector<f64>,
    states: Vec<Vec<DVector<f64>>>,
}

impl<'o, 'e> Shooting<'o, 'e> {
    /// Segments of a number of rows. `guess` returns the state at the first row of a part of a
    /// recording; measured values suffice for measured states.
    ///
    /// Parameters, biases, scales and lags can be estimated. Noise weights the channels and has to
    /// be positive.
    pub fn new(
        estimation: &'o Estimation<'e>,
        start: &[f64],
        free: &'o [Free],
        rows: usize,
        guess: impl Fn(&Recording) -> Vec<f64>,
    ) -> Result<Self, EstimateError> {
        estimation.check_ranges(start)?;
        let layout = estimation.layout();
        for (channel, &noise) in start[layout.noise(0)..layout.bias(0)].iter().enumerate() {
            if noise <= 0.0 {
                return Err(EstimateError::Value {
                    what: format!("noise of channel {channel}"),
                    value: noise,
                    demand: "positive: it weighs the channel",
                });
            }
        }
        for &Free { unknown, .. } in free {
            if !matches!(
                unknown,
                Unknown::Parameter(_) | Unknown::Bias(_) | Unknown::Scale(_) | Unknown::Lag(_)
            ) {
                return Err(EstimateError::NotByShooting { unknown });
            }
        }
        let selection = Selection::new(&layout, free)?;
        let coordinates = selection.coordinates(start)?;
        let mut values = start.to_vec();
        selection.write(&coordinates, &mut values);
        let nodes: Vec<Vec<usize>> = estimation
            .recordings()
            .iter()
            .map(|recording| nodes(recording.times().len(), rows.max(2)))
            .collect();
        let mut states = Vec::new();
        for (recording, nodes) in estimation.recordings().iter().zip(&nodes) {
            let ends = nodes[1..].iter().copied().chain([recording.times().len()]);
            let parts = nodes.iter().zip(ends);
            let parts = parts.map(|(&from, to)| guess(&recording.part(from..to)));
            states.push(parts.map(DVector::from_vec).collect::<Vec<_>>());
        }
        let expected = estimation.setup().state_len();
        if let Some(state) = states.iter().flatten().find(|s| s.len() != expected) {
            return Err(EstimateError::ValueCount {
                expected,
                found: state.len(),
            });
        }
        Ok(Self {
            estimation,
            selection,
            nodes,
            sizes: sizes(&states),
            start: Trial {
                values,
                coordinates,
                states,
            },
        })
    }

    /// Closes the gaps, and returns the results of all completed searches. Later ones are more
    /// accurate if the motion is undisturbed.
    pub fn shots(&self) -> Result<Vec<Shot>, EstimateError> {
        let mut trial = self.start.clone();
        let mut shots = Vec::new();
        for gap in GAPS {
            match self.search(trial.clone(), gap) {
                Ok((next, shot)) => {
                    trial = next;
                    shots.push(shot);
                }
                Err(error) if shots.is_empty() => return Err(error),
                Err(_) => break,
            }
        }
        Ok(shots)
    }

    /// The search for one gap.
    fn search(&self, mut trial: Trial, gap: f64) -> Result<(Trial, Shot), EstimateError> {
        let mut pieces = self.pieces(&trial)?;
        let mut steps = 0;
        loop {
            let weights = self.weights(&trial, gap);
            let condensed = Condensed::of(&pieces, &weights)?;
            let (change, slope, information) = self.change(&trial, &condensed);
            let objective = self.objective(&trial, &pieces, gap);
            let states = condensed.states(&change)?;
            let gain = condensed.gain(&change) + slope;
            if gain <= GAIN + ROUNDING * objective {
                let shot = Shot {
                    values: self.all_values(&trial),
                    gap,
                    objective,
                    information,
                };
                return Ok((trial, shot));
            }
            steps += 1;
            let mut part = self.within_reach(&change);
            let mut next = None;
            for _ in 0..CUTS {
                let tried = self.moved(&trial, &change, &states, part);
                if let Ok(pieces) = self.pieces(&tried) {
                    let fall = objective - self.objective(&tried, &pieces, gap);
                    if fall >= SUFFICIENT_DECREASE * part * gain {
                        next = Some((tried, pieces));
                        break;
                    }
                }
                part *= 0.5;
            }
            match next {
                Some(next) if steps < STEPS => (trial, pieces) = next,
                _ => {
                    let slope = gain;
                    return Err(EstimateError::Stuck { steps, slope });
                }
            }
        }
    }

    /// The step of the coordinates within their limits, its gain in the prior, and the information
    /// of all coordinates.
    fn change(&self, trial: &Trial, condensed: &Condensed) -> (DVector<f64>, f64, DMatrix<f64>) {
        let (_, by_prior) = self.selection.prior(&trial.coordinates);
        let known = DMatrix::from_diagonal(&self.selection.prior_information());
        let information = condensed.information() + &known;
        let slope = condensed.downhill() + &by_prior;
        let limits = self.selection.limits();
        let mut open = vec![true; slope.len()];
        loop {
            let change = restricted(&information, &slope, &open);
            let beyond = |&i: &usize| {
                let [low, high] = limits[i];
                let at = trial.coordinates[i];
                open[i] && (at <= low && change[i] < 0.0 || at >= high && change[i] > 0.0)
            };
            let Some(index) = (0..slope.len()).find(beyond) else {
                let gain = by_prior.dot(&change) - 0.5 * change.dot(&(known * &change));
                return (change, gain, information);
            };
            open[index] = false;
        }
    }

    /// The fraction of a step that respects the largest change of logarithms.
    fn within_reach(&self, change: &DVector<f64>) -> f64 {
        let logarithms = self.selection.free.iter().zip(change);
        let logarithms = logarithms.filter(|(free, _)| free.coordinate == Coordinate::Logarithm);
        let longest = logarithms
            .map(|(_, change)| change.abs())
            .fold(REACH, f64::max);
        REACH / longest
    }

    fn objective(&self, trial: &Trial, pieces: &[Vec<Segment>], gap: f64) -> f64 {
        let (prior, _) = self.selection.prior(&trial.coordinates);
        Condensed::objective(pieces, &self.weights(trial, gap)) - prior
    }

    fn moved(
        &self,
        trial: &Trial,
        change: &DVector<f64>,
        states: &[Vec<DVector<f64>>],
        part: f64,
    ) -> Trial {
        let mut moved = trial.clone();
        moved.coordinates += part * change;
        for (coordinate, [low, high]) in moved.coordinates.iter_mut().zip(self.selection.limits()) {
            *coordinate = coordinate.max(low).min(high);
        }
        self.selection.write(&moved.coordinates, &mut moved.values);
        for (state, change) in moved
            .states
            .iter_mut()
            .flatten()
            .zip(states.iter().flatten())
        {
            *state += part * change;
        }
        moved
    }

    /// Every segment of every run with its derivatives.
    fn pieces(&self, trial: &Trial) -> Result<Vec<Vec<Segment>>, EstimateError> {
        let unknowns: Vec<(Unknown, f64)> = (0..self.selection.len())
            .map(|index| {
                let free = self.selection.free[index];
                let value = self.selection.value(&trial.values, index);
                (free.unknown, free.stretch(value))
            })
            .collect();
        let runs = self.nodes.iter().zip(&trial.states).enumerate();
        runs.map(|(run, (nodes, states))| {
            SegmentIntegrator::new(self.estimation, &trial.values, run, &unknowns)
                .along(nodes, states)
        })
        .collect()
    }

    fn weights<'t>(&'t self, trial: &'t Trial, gap: f64) -> Weights<'t> {
        Weights {
            states: &trial.states,
            sizes: &self.sizes,
            gap,
            free: self.selection.len(),
        }
    }

    /// The values with the states at the first rows.
    fn all_values(&self, trial: &Trial) -> Vec<f64> {
        let mut values = trial.values.clone();
        for (run, states) in trial.states.iter().enumerate() {
            let place = self.estimation.layout().initial(run);
            values[place..place + states[0].len()].copy_from_slice(states[0].as_slice());
        }
        values
    }
}

/// First rows of the segments; the last one is no shorter than the others.
fn nodes(rows: usize, segment: usize) -> Vec<usize> {
    let first = [0].into_iter();
    let later = (1..rows / segment).map(|index| index * segment);
    first.chain(later).collect()
}

/// Standard deviations of the states at the nodes; 1 where they are constant.
fn sizes(states: &[Vec<DVector<f64>>]) -> Vec<f64> {
    let all: Vec<&DVector<f64>> = states.iter().flatten().collect();
    let count = all.len() as f64;
    let size = |state: usize| {
        let mean = all.iter().map(|x| x[state]).sum::<f64>() / count;
        let squares: f64 = all.iter().map(|x| (x[state] - mean).powi(2)).sum();
        let size = (squares / count).sqrt();
        if size > 0.0 { size } else { 1.0 }
    };
    (0..all[0].len()).map(size).collect()
}

/// The step of the coordinates that are not at limits; of minimum norm if a combination is
/// undetermined.
fn restricted(information: &DMatrix<f64>, slope: &DVector<f64>, open: &[bool]) -> DVector<f64> {
    /// Eigenvalues of the scaled information that count as zero.
    const LEAST_EIGENVALUE: f64 = 1e-10;
    let mut change = DVector::zeros(slope.len());
    let places: Vec<usize> = (0..open.len())
        .filter(|&i| open[i] && information[(i, i)] > 0.0)
        .collect();
    if places.is_empty() {
        return change;
    }
    let scale = |i: usize| information[(places[i], places[i])].sqrt().recip();
    let scaled = DMatrix::from_fn(places.len(), places.len(), |i, j| {
        information[(places[i], places[j])] * scale(i) * scale(j)
    });
    let right = DVector::from_fn(places.len(), |i, _| slope[places[i]] * scale(i));
    let eigen = scaled.symmetric_eigen();
    let along = eigen.eigenvectors.tr_mul(&right);
    let parts = DVector::from_fn(places.len(), |i, _| {
        let value = eigen.eigenvalues[i];
        if value > LEAST_EIGENVALUE {
            along[i] / value
        } else {
            0.0
        }
    });
    let solved = eigen.eigenvectors * parts;
    for (i, &place) in places.iter().enumerate() {
        change[place] = solved[i] * scale(i);
    }
    change
}
