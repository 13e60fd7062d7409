//! How long ten captures of a minute each take from files to a height with its interval.
//!
//! ```sh
//! cargo run --release -p appell-tests --example pipeline
//! ```

#![allow(
    clippy::unwrap_used,
    reason = "a study ends where something is missing"
)]

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use appell_gap::motion_capture::{Axes, Capture, Ride, Skeleton, Smoothed, filter};
use appell_runtime::inverse::{Consistency, Record, Relations, Sought, Track};
use appell_runtime::model::Model;
use appell_tests::random::Random;
use appell_tests::recorded::normal;
use appell_tests::rides::{MANOEUVRES, planar};
use nalgebra::{DMatrix, DVector};

const RUNS: usize = 10;
const SECONDS: f64 = 60.0;
/// Radius of the wheel, and of the pivot and the pedals from its axle, in m.
const WHEEL: [f64; 3] = [0.2, 0.35, -0.05];

/// A file of a capture: rigid bodies of the skeleton on a planar ride, in mm and degrees.
fn write(skeleton: &Skeleton, ride: &Record, random: &mut Random) -> PathBuf {
    let mut text = "t".to_owned();
    for body in &skeleton.bodies {
        for column in ["X", "Y", "Z", "yaw", "tilt", "pitch"] {
            let _ = write!(text, ",{body}.{column}");
        }
    }
    text.push('\n');
    for (row, t) in ride.times.iter().enumerate() {
        let [x, gamma, phi] = [0, 1, 2].map(|k| ride.values[(row, k)]);
        let _ = write!(text, "{t}");
        let axle = [x, 0.0, WHEEL[0]];
        let at =
            |pitch: f64, height: f64| Axes::turned([0.0, 0.0, pitch]).to_ground([0.0, 0.0, height]);
        for (place, body) in skeleton.bodies.iter().enumerate() {
            let (arm, pitch) = if body == "E" {
                (at(gamma, WHEEL[1]), gamma)
            } else {
                let height = 1.6 - 0.1 * place as f64;
                let (low, high) = (at(gamma, WHEEL[2]), at(phi, height));
                ([0, 1, 2].map(|k| low[k] + high[k]), phi)
            };
            for k in 0..3 {
                let _ = write!(
                    text,
                    ",{:.4}",
                    1e3 * (axle[k] + arm[k]) + 0.2 * normal(random)
                );
            }
            for angle in [0.0, 0.0, pitch.to_degrees()] {
                let _ = write!(text, ",{:.4}", angle + 0.5 * normal(random));
            }
        }
        text.push('\n');
    }
    let path = std::env::temp_dir().join(format!("pipeline-{}.csv", random.bits()));
    std::fs::write(&path, text).unwrap();
    path
}

fn main() {
    let text = include_str!("../../docs/examples/euc/skeleton.toml");
    let skeleton = Skeleton::parse("skeleton.toml", text).unwrap();
    let model = planar();
    let mut random = Random::of("pipeline");
    let files: Vec<PathBuf> = (0..RUNS)
        .map(|_| {
            let ride = MANOEUVRES[2].long_ride(&model, &mut random, SECONDS);
            write(&skeleton, &ride, &mut random)
        })
        .collect();
    let start = Instant::now();
    let captures: Vec<Capture> = files
        .iter()
        .map(|file| Capture::read(file, &skeleton).unwrap().0)
        .collect();
    println!("read      {:.2} s", start.elapsed().as_secs_f64());
    let rides: Vec<Ride> = captures
        .iter()
        .map(|own| Ride::of(&skeleton, own))
        .collect();
    println!("points    {:.2} s", start.elapsed().as_secs_f64());
    let filter = filter(&rides).unwrap();
    let smoothed: Vec<Smoothed> = rides
        .iter()
        .map(|own| Smoothed::of(own, filter).unwrap())
        .collect();
    println!(
        "smooth    {:.2} s, {} frames",
        start.elapsed().as_secs_f64(),
        filter.count()
    );
    let record = |ride: &Ride| {
        let channels = ride.channels.iter();
        let columns: Vec<_> = channels
            .map(|own| DVector::from_column_slice(own))
            .collect();
        Record {
            times: ride.times.clone(),
            values: DMatrix::from_columns(&columns),
        }
    };
    let records: Vec<Record> = rides.iter().map(record).collect();
    let track = Track::of(&records).unwrap();
    let times: usize = track.stretches.iter().map(|own| own.motions.len()).sum();
    println!(
        "splines   {:.2} s, {times} times",
        start.elapsed().as_secs_f64()
    );
    let p = model.info().default_parameters();
    let relations = Relations::new(&model, &[0, 1, 2], &track.stretches[0].motions[0], &p).unwrap();
    let h = model.info().parameter_index("h").unwrap();
    let found = Consistency::new(relations, track, p, vec![Sought::Parameter(h)]);
    let found = found.unwrap().find().unwrap();
    println!("height    {:.2} s", start.elapsed().as_secs_f64());
    println!(
        "h = {:.4} m, interval {:?}",
        found.values[0], found.intervals[0]
    );
    println!("velocities of {} runs", smoothed.len());
    for file in files {
        std::fs::remove_file(file).unwrap();
    }
}
