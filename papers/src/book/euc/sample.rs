//! Captured rides to try `appell motion` and `appell inverse` with.

use std::fmt::Write as _;
use std::path::Path;

use appell_recordings::motion_capture::{Capture, Skeleton};

use super::capture::{Captured, Imperfection, Random};
use super::laboratory::SKELETON;
use super::rider::{Manoeuvre, Rider};
use crate::book::Result;
use appell::sample;

/// Number of rides.
const RIDES: usize = 2;
/// The stated noise, and pivots that were calibrated.
const CALIBRATED: Imperfection = Imperfection {
    noise: 1.0,
    offsets: 0.0,
};

/// The written files, and the true value that they hide.
pub struct Written {
    /// Names of the files, the skeleton first.
    pub files: Vec<String>,
    /// True height of the rider's centre of mass above the pedals in m.
    pub height: f64,
}

/// Writes a folder with a skeleton file and decelerations of a simulated rider, captured with 0.2 mm and 0.5°
/// of noise. They are the same every time.
pub fn capture(folder: &Path) -> Result<Written> {
    let skeleton = Skeleton::parse("skeleton.toml", SKELETON)?;
    let captured = Captured::new(&skeleton)?;
    let rider = Rider::new(captured.height())?;
    let mut random = Random::of("sample");
    let mut files = vec![("skeleton.toml".to_owned(), SKELETON.to_owned())];
    for run in 0..RIDES {
        let motion = rider.ride(Manoeuvre::Deceleration, run)?;
        let seen = captured.see(&motion, CALIBRATED, &mut random);
        files.push((format!("ride_{}.csv", run + 1), table(&skeleton, &seen)));
    }
    sample::write(folder, &files)?;
    Ok(Written {
        files: files.into_iter().map(|(name, _)| name).collect(),
        height: captured.height(),
    })
}

/// A capture in the columns and units of the skeleton.
fn table(skeleton: &Skeleton, capture: &Capture) -> String {
    let columns = &skeleton.columns;
    let columns = || columns.position.iter().chain(&columns.angles);
    let mut text = "t".to_owned();
    for body in &skeleton.bodies {
        for column in columns() {
            text.push(',');
            text.push_str(&column.pattern.replace("{}", body));
        }
    }
    text.push('\n');
    for (row, t) in capture.times.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{t:.6}");
        for track in &capture.bodies {
            let values = track.position.iter().chain(&track.angles);
            for (value, column) in values.zip(columns()) {
                let _ = write!(text, ",{:.4}", value[row] / column.scale);
            }
        }
        text.push('\n');
    }
    text
}
