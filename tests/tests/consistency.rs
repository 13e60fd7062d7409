//! Parameters from motions alone: whatever the inputs were, the equations that they leave over hold.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::inverse::{
    Consistency, Found, InverseError, Motion, Record, Relations, Sought, Track,
};
use appell_runtime::model::Model;
use appell_test_kit::{Random, is_full};
use appell_tests::rides::{MANOEUVRES, Manoeuvre, planar, seen};
use nalgebra::{DMatrix, DVector};

/// Runs of a data set.
const RUNS: usize = 4;
/// Data sets of each manoeuvre, in an ordinary run and in a full one, and of how many the interval holds the
/// truth at least: of sets that hold it with a chance of 95 %, fewer do once in a thousand.
/// `examples/coverage.rs` takes 400 sets.
const SETS: [(usize, usize); 2] = [(15, 11), (40, 32)];
/// The bound on the height without noise, in m.
const NOISE_FREE: f64 = 1e-6;
/// Differences of third order beside exact derivatives.
const SLOPES: f64 = 1e-6;

fn rides(manoeuvre: Manoeuvre, model: &dyn Model, random: &mut Random) -> Vec<Record> {
    (0..RUNS).map(|_| manoeuvre.ride(model, random)).collect()
}

fn found(model: &dyn Model, records: &[Record], names: &[&str]) -> Found {
    consistency(model, records, names).find().unwrap()
}

fn consistency<'a>(model: &'a dyn Model, records: &[Record], names: &[&str]) -> Consistency<'a> {
    let track = Track::of(records).unwrap();
    let p = model.info().default_parameters();
    let relations = Relations::new(model, &[0, 1, 2], &track.stretches[0].motions[0], &p).unwrap();
    let index = |name: &&str| Sought::Parameter(model.info().parameter_index(name).unwrap());
    let sought = names.iter().map(index).collect();
    Consistency::new(relations, track, p, sought).unwrap()
}

fn truth(model: &dyn Model, name: &str) -> f64 {
    let info = model.info();
    info.parameters[info.parameter_index(name).unwrap()].value
}

#[test]
fn a_height_is_found_to_a_micrometre_without_noise() {
    let model = planar();
    let h = truth(model, "h");
    for manoeuvre in MANOEUVRES {
        let mut random = Random::of(manoeuvre.name);
        let found = found(model, &rides(manoeuvre, model, &mut random), &["h"]);
        let off = (found.values[0] - h).abs();
        println!("{}: off by {off:e} m", manoeuvre.name);
        assert!(off < NOISE_FREE, "{}: off by {off:e}", manoeuvre.name);
    }
}

#[test]
fn intervals_hold_the_true_height_about_as_often_as_they_say() {
    let model = planar();
    let h = truth(model, "h");
    let (sets, fewest) = SETS[usize::from(is_full())];
    for manoeuvre in MANOEUVRES {
        let mut random = Random::of(manoeuvre.name);
        let rides = rides(manoeuvre, model, &mut random);
        let hits = (0..sets).filter(|_| {
            let records: Vec<Record> = rides.iter().map(|ride| seen(ride, &mut random)).collect();
            let [low, high] = found(model, &records, &["h"]).intervals[0];
            low <= h && h <= high
        });
        let hits = hits.count();
        println!("{}: {hits} of {sets}", manoeuvre.name);
        assert!(hits >= fewest, "{}: {hits} of {sets}", manoeuvre.name);
    }
}

#[test]
fn a_braking_ride_tells_more_of_the_height_than_one_at_constant_speed() {
    let model = planar();
    let width = |manoeuvre: Manoeuvre| {
        let mut random = Random::of(manoeuvre.name);
        let rides = rides(manoeuvre, model, &mut random);
        let records: Vec<Record> = rides.iter().map(|ride| seen(ride, &mut random)).collect();
        let found = found(model, &records, &["h"]);
        assert!(
            (0.7..1.3).contains(&found.normalised_square()),
            "{}: {}",
            manoeuvre.name,
            found.normalised_square()
        );
        found.intervals[0][1] - found.intervals[0][0]
    };
    let [constant, _, braking] = MANOEUVRES.map(width);
    println!("widths: {constant} m and {braking} m");
    assert!(constant > 2.0 * braking, "{constant} and {braking}");
}

/// A motion with values of all kinds.
fn motion() -> Motion {
    Motion {
        t: 0.0,
        derivatives: [[1.3, 0.2, -0.3], [2.0, -0.7, 0.9], [-1.1, 3.0, -2.0]]
            .map(|row| DVector::from_row_slice(&row)),
    }
}

#[test]
fn derivatives_of_the_relations_are_those_of_differences() {
    let model = planar();
    let p = model.info().default_parameters();
    let relations = Relations::new(model, &[0, 1, 2], &motion(), &p).unwrap();
    assert_eq!(relations.len(), 1);
    let value = |motion: &Motion, p: &[f64]| relations.at(motion, p).unwrap().values[0];
    // A motion that is possible: the relation is linear in the forward acceleration.
    let first = relations.at(&motion(), &p).unwrap();
    let mut motion = motion();
    motion.derivatives[2][0] -= first.values[0] / first.by_motion[2][(0, 0)];
    let rows = relations.at(&motion, &p).unwrap();
    let h = 1e-5;
    for order in 0..3 {
        for index in 0..3 {
            let [mut above, mut below] = [motion.clone(), motion.clone()];
            above.derivatives[order][index] += h;
            below.derivatives[order][index] -= h;
            let slope = (value(&above, &p) - value(&below, &p)) / (2.0 * h);
            let exact = rows.by_motion[order][(0, index)];
            assert!(
                (slope - exact).abs() < SLOPES * (1.0 + exact.abs()),
                "order {order}, coordinate {index}: {exact} instead of {slope}"
            );
        }
    }
    for index in 0..p.len() {
        let [mut above, mut below] = [p.clone(), p.clone()];
        above[index] += h;
        below[index] -= h;
        let slope = (value(&motion, &above) - value(&motion, &below)) / (2.0 * h);
        let exact = rows.by_parameters[(0, index)];
        assert!(
            (slope - exact).abs() < SLOPES * (1.0 + exact.abs()),
            "parameter {index}: {exact} instead of {slope}"
        );
    }
}

#[test]
fn what_cannot_be_sought_is_told() {
    let model = planar();
    let p = model.info().default_parameters();
    let missing = Relations::new(model, &[0, 1, 7], &motion(), &p);
    let (index, coordinates) = (7, 3);
    assert_eq!(
        missing.err(),
        Some(InverseError::NoCoordinate { index, coordinates })
    );
    // γ is not measured: γ̇ stays open.
    let open = Relations::new(model, &[0, 2], &motion(), &p);
    assert!(matches!(
        open.err(),
        Some(InverseError::Lengths { .. } | InverseError::Undetermined { .. })
    ));
    let short = Record {
        times: vec![0.0, 0.1],
        values: DMatrix::zeros(2, 3),
    };
    assert_eq!(Track::of(&[short]).err(), Some(InverseError::TooShort));
}
