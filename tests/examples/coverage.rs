//! How often intervals of the rider's height hold the truth: 400 simulated data sets of each straight
//! manoeuvre. `docs/motion-capture.md` tells the result.
//!
//! ```sh
//! cargo run --release -p appell-tests --example coverage
//! ```

#![allow(
    clippy::unwrap_used,
    reason = "a study ends where something is missing"
)]

use appell_runtime::inverse::{Consistency, Found, Record, Relations, Sought, Track};
use appell_runtime::model::Model;
use appell_tests::random::Random;
use appell_tests::rides::{MANOEUVRES, planar, seen};

/// Data sets of a manoeuvre.
const SETS: usize = 400;
/// Runs of a data set.
const RUNS: usize = 4;

fn main() {
    let model = planar();
    let index = model.info().parameter_index("h").unwrap();
    let h = model.info().parameters[index].value;
    println!("manoeuvre          hits   without an end   mean of h   spread   median width");
    for manoeuvre in MANOEUVRES {
        let mut random = Random::of(manoeuvre.name);
        let rides: Vec<Record> = (0..RUNS)
            .map(|_| manoeuvre.ride(&model, &mut random))
            .collect();
        let sets: Vec<Found> = (0..SETS)
            .map(|_| {
                let records: Vec<Record> =
                    rides.iter().map(|ride| seen(ride, &mut random)).collect();
                found(&model, &records, index)
            })
            .collect();
        let inside = |found: &&Found| {
            let [low, high] = found.intervals[0];
            low <= h && h <= high
        };
        let hits = sets.iter().filter(inside).count();
        let width = |found: &Found| found.intervals[0][1] - found.intervals[0][0];
        let mut widths: Vec<f64> = sets.iter().map(width).collect();
        widths.sort_by(f64::total_cmp);
        let open = widths.iter().filter(|width| width.is_infinite()).count();
        let mean = sets.iter().map(|found| found.values[0]).sum::<f64>() / SETS as f64;
        let square = sets
            .iter()
            .map(|found| (found.values[0] - mean).powi(2))
            .sum::<f64>();
        println!(
            "{:<16} {hits:>4}/{SETS} {open:>12} {mean:>14.4} {:>10.4} {:>10.4}",
            manoeuvre.name,
            (square / SETS as f64).sqrt(),
            widths[SETS / 2]
        );
    }
}

fn found(model: &dyn Model, records: &[Record], index: usize) -> Found {
    let track = Track::of(records).unwrap();
    let p = model.info().default_parameters();
    let relations = Relations::new(model, &[0, 1, 2], &track.stretches[0].motions[0], &p).unwrap();
    let sought = vec![Sought::Parameter(index)];
    Consistency::new(relations, track, p, sought)
        .unwrap()
        .find()
        .unwrap()
}
