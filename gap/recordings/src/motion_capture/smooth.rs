//! Velocities and accelerations of a ride, by one Savitzky-Golay filter for all signals.
//!
//! With a single filter both sides of the equations are filtered alike. Its window is the narrowest
//! of those that the rule of [`appell_estimate::smoothing::window`] chooses for the second
//! derivatives of the channels.

use appell_estimate::smoothing::savitzky_golay::{SavitzkyGolay, weights};
use appell_estimate::smoothing::{Samples, SamplesError, noise, window};

use super::pose::{Axes, Vector};
use super::ride::Ride;

/// Degree of the polynomials.
const DEGREE: usize = 4;
/// Rides, and frames from the middle of each, from which the window is chosen; more do not change it.
const RIDES: usize = 3;
const FRAMES: usize = 600;

/// A ride with derivatives.
#[derive(Debug, Clone)]
pub struct Smoothed {
    /// Velocity of the frame's origin, in the frame, m/s.
    pub velocity: Vec<Vector>,
    /// Acceleration of the frame's origin, in the frame, m/s².
    pub acceleration: Vec<Vector>,
    /// Yaw, tilt and pitch with two derivatives.
    pub angles: [Signal; 3],
    /// The channels with two derivatives.
    pub channels: Vec<Signal>,
}

/// A quantity with two derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal(Vec<[f64; 3]>);

impl Signal {
    /// Value and derivatives at a row.
    pub fn at(&self, row: usize) -> [f64; 3] {
        self.0[row]
    }

    /// The derivative of an order at all times.
    pub fn derivative(&self, order: usize) -> Vec<f64> {
        self.0.iter().map(|all| all[order]).collect()
    }
}

/// The window for rides of one kind, in samples of a Savitzky-Golay filter.
pub fn filter(rides: &[Ride]) -> Result<SavitzkyGolay, SamplesError> {
    let mut narrowest: Option<SavitzkyGolay> = None;
    for ride in rides.iter().take(RIDES) {
        let first = ride.times.len().saturating_sub(FRAMES) / 2;
        let frames = first..(first + FRAMES).min(ride.times.len());
        for channel in &ride.channels {
            let samples = Samples::new(&ride.times[frames.clone()], &channel[frames.clone()])?;
            let level = noise::from_differences(&[samples]).map_or(0.0, |found| found.std);
            // Without noise the narrowest window is right.
            let level = level.max(f64::MIN_POSITIVE.sqrt());
            let chosen = window::chosen(samples, DEGREE, 2, level)?;
            if narrowest.is_none_or(|filter| chosen.count() < filter.count()) {
                narrowest = Some(chosen);
            }
        }
    }
    Ok(narrowest.unwrap_or_else(|| SavitzkyGolay::new(DEGREE, DEGREE + 3)))
}

impl Smoothed {
    /// Of a ride, by a filter.
    pub fn of(ride: &Ride, filter: SavitzkyGolay) -> Result<Self, SamplesError> {
        let kernels = Kernels::of(&ride.times, filter);
        let smooth = |values: &[f64]| kernels.smooth(values);
        let component = |k: usize| {
            let values: Vec<f64> = ride.origin.iter().map(|place| place[k]).collect();
            smooth(&values)
        };
        let origin = [component(0)?, component(1)?, component(2)?];
        let [yaw, tilt, pitch] = &ride.angles;
        let angles = [smooth(yaw)?, smooth(tilt)?, smooth(pitch)?];
        let in_frame = |order: usize| {
            (0..ride.times.len())
                .map(|row| {
                    let frame = Axes::turned([angles[0].at(row)[0], angles[1].at(row)[0], 0.0]);
                    frame.from_ground(origin.each_ref().map(|own| own.at(row)[order]))
                })
                .collect()
        };
        let channels = ride.channels.iter().map(|values| smooth(values));
        Ok(Self {
            velocity: in_frame(1),
            acceleration: in_frame(2),
            channels: channels.collect::<Result<_, _>>()?,
            angles,
        })
    }
}

/// Weights of a filter at all times of a record. On equal steps most of them are the same.
struct Kernels<'t> {
    times: &'t [f64],
    filter: SavitzkyGolay,
    /// The first sample of each window, and the place of its weights.
    windows: Vec<(usize, usize)>,
    /// For each order a weight for each sample of a window.
    weights: Vec<[Vec<f64>; 3]>,
}

/// Times from the middle of two windows that differ by less than this part of a window are the same.
const SAME: f64 = 1e-9;

impl<'t> Kernels<'t> {
    fn of(times: &'t [f64], filter: SavitzkyGolay) -> Self {
        let count = filter.count();
        let mut all = Self {
            times,
            filter,
            windows: Vec::new(),
            weights: Vec::new(),
        };
        let mut shape: Vec<f64> = Vec::new();
        for (row, &t) in times.iter().enumerate() {
            let first = row.saturating_sub(count / 2);
            let first = first.min(times.len().saturating_sub(count));
            let window = &times[first..times.len().min(first + count)];
            let close = SAME * (window[window.len() - 1] - window[0]);
            let same = shape.len() == window.len()
                && (shape.iter().zip(window)).all(|(own, time)| (own - (time - t)).abs() <= close);
            if !same {
                let of = |order| weights(window, t, DEGREE, order).unwrap_or_default();
                all.weights.push([of(0), of(1), of(2)]);
                shape = window.iter().map(|time| time - t).collect();
            }
            all.windows.push((first, all.weights.len() - 1));
        }
        all
    }

    fn smooth(&self, values: &[f64]) -> Result<Signal, SamplesError> {
        let samples = Samples::new(self.times, values)?;
        if values.len() < self.filter.count() || values.iter().any(|value| value.is_nan()) {
            // Windows extend over missing values. Deviations are not needed, so the level is arbitrary.
            let rows = self.filter.estimate(samples, 2, 1.0)?.into_iter();
            let three = rows.map(|own| [0, 1, 2].map(|order| own.means[order]));
            return Ok(Signal(three.collect()));
        }
        let rows = self.windows.iter().map(|&(first, kernel)| {
            self.weights[kernel].each_ref().map(|weights| {
                let pairs = weights.iter().zip(&values[first..]);
                pairs.map(|(weight, value)| weight * value).sum()
            })
        });
        Ok(Signal(rows.collect()))
    }
}
