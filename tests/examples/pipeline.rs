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

use appell_estimate::inverse::{Consistency, Record, Relations, Sought, Track};
use appell_recordings::motion_capture::{Capture, Ride, Skeleton, Smoothed, filter};
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::rides::{MANOEUVRES, captured, planar, record_of, skeleton};

const RUNS: usize = 10;
const SECONDS: f64 = 60.0;

/// A file of a capture: rigid bodies of the skeleton on a planar ride, in mm and degrees.
fn write(skeleton: &Skeleton, ride: &Record, random: &mut Random) -> PathBuf {
    let mut text = "t".to_owned();
    for body in &skeleton.bodies {
        for column in ["X", "Y", "Z", "yaw", "tilt", "pitch"] {
            let _ = write!(text, ",{body}.{column}");
        }
    }
    text.push('\n');
    let capture = captured(skeleton, ride, (0.0, &mut Random::of("markers")), random);
    for (row, t) in capture.times.iter().enumerate() {
        let _ = write!(text, "{t}");
        for track in &capture.bodies {
            for place in &track.position {
                let _ = write!(text, ",{:.4}", 1e3 * place[row]);
            }
            for angle in &track.angles {
                let _ = write!(text, ",{:.4}", angle[row].to_degrees());
            }
        }
        text.push('\n');
    }
    let path = std::env::temp_dir().join(format!("pipeline-{}.csv", random.bits()));
    std::fs::write(&path, text).unwrap();
    path
}

fn main() {
    let skeleton = skeleton();
    let model = planar();
    let mut random = Random::of("pipeline");
    let files: Vec<PathBuf> = (0..RUNS)
        .map(|_| {
            let ride = MANOEUVRES[2].long_ride(model, &mut random, SECONDS);
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
    let records: Vec<Record> = rides.iter().map(record_of).collect();
    let track = Track::of(&records).unwrap();
    let times: usize = track.stretches.iter().map(|own| own.motions.len()).sum();
    println!(
        "splines   {:.2} s, {times} times",
        start.elapsed().as_secs_f64()
    );
    let p = model.info().default_parameters();
    let relations = Relations::new(model, &[0, 1, 2], &track.stretches[0].motions[0], &p).unwrap();
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
