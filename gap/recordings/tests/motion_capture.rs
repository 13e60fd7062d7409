//! Captures of rigid bodies become what a planar model measures.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use appell_estimate::smoothing::savitzky_golay::SavitzkyGolay;
use appell_recordings::motion_capture::{
    Axes, Capture, Ride, Skeleton, Smoothed, filter, manifest, table,
};
use appell_recordings::read;

use crate::common::{Folder, library};

/// The skeleton of the documents.
const EXAMPLE: &str = include_str!("../../../docs/examples/euc/skeleton.toml");
/// A capture in files has nine decimals of a millimetre and of a degree.
const PRINTED: f64 = 1e-10;
/// Truncation of a polynomial of degree four over nine frames.
const SMOOTH: f64 = 1e-4;

/// A vehicle with a rider of one segment.
const SMALL: &str = r#"
description = "a mass above a wheel"
mechanism   = "euc_2dof"
[columns]
position = ["{}.x", "{}.y", "{}.z"]
angles   = ["{}.yaw", "{}.tilt", "{}.pitch"]
length   = "mm"
angle    = "deg"
[bodies]
E = "vehicle"
B = "rider"
[points]
C = { body = "E", offset = [0, 0, -400], unit = "mm" }
T = { body = "B", offset = [0, 0, 0.5], unit = "m" }
[rider]
mass  = { value = 70, unit = "kg" }
table = "winter"
name  = "G"
[segments]
all = { part = "trunk", from = "B", to = "T" }
[frame]
body   = "E"
origin = "C"
[channels]
x   = { path = "C" }
phi = { lean = ["C", "G"] }
"#;

/// Where the axle is, how fast, and yaw and tilt of the vehicle: a circle, ridden twice.
const RADIUS: f64 = 3.0;
const RATE: f64 = 1.2;
const TILT: f64 = 0.1;
const LEAN: f64 = 0.2;
const ROWS: usize = 1300;

/// The rows of a capture of a ride on a circle, angles told between −180° and 180°.
fn circle() -> String {
    let mut text =
        "t,E.x,E.y,E.z,E.yaw,E.tilt,E.pitch,B.x,B.y,B.z,B.yaw,B.tilt,B.pitch\n".to_owned();
    for row in 0..ROWS {
        let t = row as f64 / 120.0;
        let yaw = RATE * t;
        let pitch = 0.05 * (3.0 * t).sin();
        let axle = [RADIUS * yaw.sin(), -RADIUS * yaw.cos(), 0.2];
        let top = Axes::turned([yaw, TILT, pitch]).to_ground([0.0, 0.0, 0.4]);
        // The rider's centre, half way up the segment, leans by `LEAN` in the frame of the vehicle.
        let frame = Axes::turned([yaw, TILT, 0.0]);
        let rider = Axes::turned([yaw, TILT, LEAN]);
        let low = frame.to_ground([0.5 * LEAN.sin(), 0.0, 0.5 * LEAN.cos()]);
        let degrees = |angle: f64| (((angle + PI).rem_euclid(TAU)) - PI).to_degrees();
        let _ = write!(text, "{t}");
        for k in 0..3 {
            let _ = write!(text, ",{:.9}", 1e3 * (axle[k] + top[k]));
        }
        let _ = write!(
            text,
            ",{:.9},{:.9},{:.9}",
            degrees(yaw),
            degrees(TILT),
            degrees(pitch)
        );
        for k in 0..3 {
            let _ = write!(text, ",{:.9}", 1e3 * (axle[k] + low[k]));
        }
        assert!(rider.forward()[2] < 0.0);
        let _ = writeln!(
            text,
            ",{:.9},{:.9},{:.9}",
            degrees(yaw),
            degrees(TILT),
            degrees(LEAN)
        );
    }
    text
}

fn ride() -> (Skeleton, Ride) {
    let folder = Folder::new();
    folder.write("circle.csv", circle());
    let skeleton = Skeleton::parse("skeleton.toml", SMALL).unwrap();
    let (capture, findings) = Capture::read(&folder.path("circle.csv"), &skeleton).unwrap();
    assert!(findings.is_empty());
    let ride = Ride::of(&skeleton, &capture);
    (skeleton, ride)
}

#[test]
fn points_centre_and_angles_of_a_ride_on_a_circle_are_found() {
    let (_, ride) = ride();
    let turned = RATE * (ROWS - 1) as f64 / 120.0;
    assert!(turned > TAU, "the yaw angle starts anew on the way");
    let last = ROWS - 1;
    assert!((ride.angles[0][last] - turned).abs() < PRINTED);
    for row in 0..ROWS {
        let yaw = RATE * ride.times[row];
        let axle = [RADIUS * yaw.sin(), -RADIUS * yaw.cos(), 0.2];
        for k in 0..3 {
            assert!(
                (ride.origin[row][k] - axle[k]).abs() < PRINTED,
                "axle at {row}"
            );
        }
        // (3): the lean is the one of the line from the axle to the centre.
        assert!(
            (ride.channels[1][row] - LEAN).abs() < PRINTED,
            "lean at {row}"
        );
        assert!(
            ride.relative[row][1].abs() < PRINTED,
            "beside the plane at {row}"
        );
    }
    // Chords of a circle are shorter than its arcs, by a part of (step/2)²/6.
    let way = ride.channels[0][last];
    assert!((way - RADIUS * turned).abs() < 1e-4 * way, "{way}");
}

#[test]
fn velocity_and_acceleration_stand_in_the_moving_frame() {
    let (_, ride) = ride();
    let filter = SavitzkyGolay::new(4, 9);
    let smoothed = Smoothed::of(&ride, filter).unwrap();
    let speed = RADIUS * RATE;
    for row in 0..ROWS {
        let ([v, side, _], [along, inwards, up]) =
            (smoothed.velocity[row], smoothed.acceleration[row]);
        assert!(
            (v - speed).abs() < SMOOTH && side.abs() < SMOOTH,
            "{v} {side} at {row}"
        );
        assert!(along.abs() < 10.0 * SMOOTH, "{along} at {row}");
        // Towards the middle of the circle, in axes that are tilted.
        let towards = speed * RATE;
        assert!(
            (inwards - towards * TILT.cos()).abs() < 10.0 * SMOOTH,
            "{inwards} at {row}"
        );
        assert!(
            (up + towards * TILT.sin()).abs() < 10.0 * SMOOTH,
            "{up} at {row}"
        );
    }
}

#[test]
fn a_ride_becomes_a_data_set_that_is_read() {
    let (skeleton, ride) = ride();
    let smoothed = Smoothed::of(&ride, filter(std::slice::from_ref(&ride)).unwrap()).unwrap();
    let folder = Folder::new();
    folder.write("circle.csv", table(&skeleton, &ride, &smoothed));
    folder.write(
        "recording.toml",
        manifest(&skeleton, &["circle.csv".to_owned()]),
    );
    let set = read(&folder.path(""), library(), None).unwrap();
    let measured: Vec<&str> = set
        .channels
        .iter()
        .filter(|channel| channel.is_measured())
        .map(|channel| channel.column.as_str())
        .collect();
    assert_eq!(measured, ["x", "phi"]);
    assert_eq!(set.runs[0].times.len(), ROWS);
}

#[test]
fn the_skeleton_of_the_documents_has_the_bodies_of_table_2_and_the_whole_mass() {
    let skeleton = Skeleton::parse("skeleton.toml", EXAMPLE).unwrap();
    assert_eq!(skeleton.bodies.len(), 14);
    let mass: f64 = skeleton
        .rider
        .segments
        .iter()
        .map(|segment| segment.mass)
        .sum();
    assert!((mass - 65.0).abs() < PRINTED, "{mass}");
}

#[test]
fn all_mistakes_of_a_skeleton_are_told_with_their_places() {
    let wrong = SMALL
        .replace("table = \"winter\"", "table = \"wintre\"")
        .replace("origin = \"C\"", "origin = \"D\"")
        .replace("length   = \"mm\"", "length   = \"kg\"")
        .replace("path = \"C\"", "path = \"K\"");
    let error = Skeleton::parse("skeleton.toml", &wrong)
        .unwrap_err()
        .to_string();
    for part in [
        "there is no table `wintre`",
        "did you mean `winter`?",
        "there is no point `D`",
        "`kg` is not a unit with the dimension of m",
        "there is no point `K`",
        "skeleton.toml:7",
    ] {
        assert!(error.contains(part), "`{part}` in\n{error}");
    }
    let missing = Skeleton::parse("skeleton.toml", "mechanism = \"pendulum\"").unwrap_err();
    let missing = missing.to_string();
    for section in ["columns", "bodies", "rider", "frame", "channels"] {
        assert!(
            missing.contains(&format!("`[{section}]` is missing")),
            "{section}:\n{missing}"
        );
    }
}

#[test]
fn damaged_skeletons_are_refused_without_a_panic() {
    for text in [SMALL, EXAMPLE] {
        for cut in 0..text.len() {
            if let Some(part) = text.get(..cut) {
                let _ = Skeleton::parse("skeleton.toml", part);
            }
            if let (Some(before), Some(after)) = (text.get(..cut), text.get(cut + 1..)) {
                let _ = Skeleton::parse("skeleton.toml", &format!("{before}{after}"));
            }
        }
    }
}
