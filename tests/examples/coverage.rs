//! How often intervals of the rider's height hold the truth: 400 simulated data sets of each straight
//! manoeuvre. `docs/motion-capture.md` tells the result.
//!
//! ```sh
//! cargo run --release -p appell-tests --example coverage              # noise on the coordinates
//! cargo run --release -p appell-tests --example coverage capture      # noise of rigid bodies
//! cargo run --release -p appell-tests --example coverage offsets 40   # and pivots that sit off
//! ```

#![allow(
    clippy::unwrap_used,
    reason = "a study ends where something is missing"
)]

use appell_estimate::inverse::{Consistency, Found, Record, Relations, Sought, Track};
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::rides::{MANOEUVRES, captured, planar, seen, shown, skeleton};

/// Data sets of a manoeuvre.
const SETS: usize = 400;
/// Runs of a data set.
const RUNS: usize = 4;
/// How far pivots sit from where they should, in m: a new rig for every data set.
const OFFSET: f64 = 0.005;

fn main() {
    let mut words = std::env::args().skip(1);
    let seen_by = words.next().unwrap_or_default();
    let offset = if seen_by == "offsets" { OFFSET } else { 0.0 };
    let count: usize = words.next().map_or(SETS, |count| count.parse().unwrap());
    let skeleton = skeleton();
    let model = planar();
    let index = model.info().parameter_index("h").unwrap();
    let h = model.info().parameters[index].value;
    println!("manoeuvre          hits   without an end   mean of h   spread   median width");
    for manoeuvre in MANOEUVRES {
        let mut random = Random::of(manoeuvre.name);
        let rides: Vec<Record> = (0..RUNS)
            .map(|_| manoeuvre.ride(model, &mut random))
            .collect();
        let set = |number: usize| {
            let rides = rides.iter();
            if seen_by.is_empty() {
                let records: Vec<Record> = rides.map(|ride| seen(ride, &mut random)).collect();
                return found(model, &records, vec![Sought::Parameter(index)]);
            }
            // Pivots stay where they are from ride to ride.
            let rig = Random::of(&format!("{} {number}", manoeuvre.name));
            let records = rides.map(|ride| {
                let capture = captured(&skeleton, ride, (offset, &mut rig.clone()), &mut random);
                shown(&skeleton, &capture)
            });
            let records: Vec<Record> = records.collect();
            // They turn the line from the pedals to the rider's centre of mass.
            let bias = (offset > 0.0).then_some(Sought::Bias(2));
            let sought = [Sought::Parameter(index)].into_iter().chain(bias);
            found(model, &records, sought.collect())
        };
        let found: Vec<Found> = (0..count).map(set).collect();
        let inside = |found: &&Found| {
            let [low, high] = found.intervals[0];
            low <= h && h <= high
        };
        let hits = found.iter().filter(inside).count();
        let width = |found: &Found| found.intervals[0][1] - found.intervals[0][0];
        let mut widths: Vec<f64> = found.iter().map(width).collect();
        widths.sort_by(f64::total_cmp);
        let open = widths.iter().filter(|width| width.is_infinite()).count();
        let mean = found.iter().map(|found| found.values[0]).sum::<f64>() / count as f64;
        let square = found
            .iter()
            .map(|found| (found.values[0] - mean).powi(2))
            .sum::<f64>();
        println!(
            "{:<16} {hits:>4}/{count} {open:>12} {mean:>14.4} {:>10.4} {:>10.4}",
            manoeuvre.name,
            (square / count as f64).sqrt(),
            widths[count / 2]
        );
    }
}

fn found(model: &dyn Model, records: &[Record], sought: Vec<Sought>) -> Found {
    let track = Track::of(records).unwrap();
    let p = model.info().default_parameters();
    let relations = Relations::new(model, &[0, 1, 2], &track.stretches[0].motions[0], &p).unwrap();
    Consistency::new(relations, track, p, sought)
        .unwrap()
        .find()
        .unwrap()
}
