//! Velocities and accelerations of a ride, by one Savitzky-Golay filter for all signals.
//!
//! With one filter, what smoothing takes from the motion it takes from both sides of the equations.
//! Its window is the narrowest of those that the rule of [`appell_runtime::signal::window`] chooses
//! for the second derivatives of the channels.

use appell_runtime::signal::savitzky_golay::SavitzkyGolay;
use appell_runtime::signal::{Estimate, Samples, SamplesError, noise, window};

use super::pose::{Axes, Vector};
use super::ride::Ride;

/// Degree of the polynomials.
const DEGREE: usize = 4;
/// Rides, and frames from the middle of each, that tell the window; more tell no other one.
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
    pub angles: [Estimate; 3],
    /// The channels with two derivatives.
    pub channels: Vec<Estimate>,
}

/// The window for rides of one kind, in samples of a Savitzky-Golay filter.
pub fn filter(rides: &[Ride]) -> Result<SavitzkyGolay, SamplesError> {
    let mut narrowest: Option<(usize, SavitzkyGolay)> = None;
    for ride in rides.iter().take(RIDES) {
        let first = ride.times.len().saturating_sub(FRAMES) / 2;
        let frames = first..(first + FRAMES).min(ride.times.len());
        for channel in &ride.channels {
            let samples = Samples::new(&ride.times[frames.clone()], &channel[frames.clone()])?;
            let level = noise::from_differences(&[samples]).map_or(0.0, |found| found.std);
            // Without noise the narrowest window is right.
            let level = level.max(f64::MIN_POSITIVE.sqrt());
            let chosen = window::chosen(samples, DEGREE, 2, level)?;
            if narrowest.is_none_or(|(count, _)| chosen.count() < count) {
                narrowest = Some((chosen.count(), chosen));
            }
        }
    }
    narrowest.map_or_else(
        || SavitzkyGolay::new(DEGREE, DEGREE + 3),
        |(_, filter)| Ok(filter),
    )
}

impl Smoothed {
    /// Of a ride, by a filter.
    pub fn of(ride: &Ride, filter: SavitzkyGolay) -> Result<Self, SamplesError> {
        let smooth = |values: &[f64]| {
            // Covariances are not asked for: the level does not matter.
            filter.estimate(Samples::new(&ride.times, values)?, 2, 1.0)
        };
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
