//! The rigid bodies of a capture over time.

use std::path::Path;

use appell_estimate::smoothing::angle::unwrap;
use appell_spec::units;

use super::skeleton::{Column, Skeleton};
use crate::time::Stated;
use crate::{Channel, DataError, Finding, Role, format, limits};

/// Rigid bodies at increasing times, in SI; NaN where a body was not seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Capture {
    /// Times in s.
    pub times: Vec<f64>,
    /// A track for each body of the skeleton.
    pub bodies: Vec<Track>,
}

/// A rigid body over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The pivot: forward, left, up.
    pub position: [Vec<f64>; 3],
    /// Yaw, tilt and pitch, unwrapped.
    pub angles: [Vec<f64>; 3],
}

impl Capture {
    /// Reads the columns of all bodies of a skeleton from a file of any format of recordings.
    pub fn read(path: &Path, skeleton: &Skeleton) -> Result<(Self, Vec<Finding>), DataError> {
        let patterns: Vec<&Column> = patterns(skeleton).collect();
        let names = skeleton.bodies.iter();
        let names = names.flat_map(|body| patterns.iter().map(move |column| column.of(body)));
        let plain = units::parse("1").map_err(|_| DataError::whole("1", "is a unit"))?;
        let channel = |name: String| Channel::new(&name, Role::Recorded, plain.clone(), None);
        let channels: Vec<Channel> = names.map(channel).collect();
        let mut budget = limits::MAX_NUMBERS;
        let table = format::read(path, &Stated::default(), &channels, None, &mut budget)?;
        let mut columns = table.columns.into_iter();
        let bodies = skeleton.bodies.iter().map(|_| {
            let mut next = |column: &Column| -> Vec<f64> {
                let values = columns.next().unwrap_or_default();
                values
                    .into_iter()
                    .map(|value| value * column.scale)
                    .collect()
            };
            let position = skeleton.columns.position.each_ref().map(&mut next);
            let mut angles = skeleton.columns.angles.each_ref().map(&mut next);
            for angle in &mut angles {
                unwrap(angle);
            }
            Track { position, angles }
        });
        let bodies = bodies.collect();
        let times = table.times;
        Ok((Self { times, bodies }, table.findings))
    }
}

fn patterns(skeleton: &Skeleton) -> impl Iterator<Item = &Column> {
    let columns = &skeleton.columns;
    columns.position.iter().chain(&columns.angles)
}
