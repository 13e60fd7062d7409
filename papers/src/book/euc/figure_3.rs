//! Figures 3 and 4: a figure-eight in the ground, and in the frame that moves with the unicycle.

use appell_recordings::motion_capture::{Ride, Vector};
use appell_report::figure::{Path, Series, Surface};

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use crate::book::{Part, Result, Section, failed, line, paths};

/// The capture volume of the paper in m.
const VOLUME: [f64; 3] = [6.0, 4.0, 2.0];

pub(super) fn section(laboratory: &Laboratory) -> Result<Section> {
    let session = laboratory.session(Manoeuvre::FigureEight)?;
    let ride = session.by_3.rides.first();
    let ride = ride.ok_or_else(|| failed("no ride"))?;
    let top = laboratory.skeleton.body("E");
    let top = &ride.points[top.ok_or_else(|| failed("no body `E`"))?];

    let mut part = Part::read(include_str!("figure_3.toml"))?;
    let [length, width] = [0, 1].map(|k| extent(&component(&ride.origin, k)));
    let ours = format!("{length:.1} m × {width:.1} m on the ground");
    let inside = length < VOLUME[0] && width < VOLUME[1];
    part.found("volume", ours, inside)?;

    let [low, high] = ends(&ride.angles[1]);
    let ours = format!(
        "ψ runs over {:.0}°, ϑ from {:.1}° to {:.1}°",
        extent(&ride.angles[0]).to_degrees(),
        low.to_degrees(),
        high.to_degrees()
    );
    part.found("swings", ours, high.max(-low) > 0.05)?;

    let [ahead, side] = [0, 1].map(|k| ends(&component(&ride.relative, k)));
    let ours = format!(
        "x_CG within {:.0} mm … {:.0} mm, y_CG within {:.0} mm … {:.0} mm",
        1e3 * ahead[0],
        1e3 * ahead[1],
        1e3 * side[0],
        1e3 * side[1]
    );
    let upright = ride.relative.iter().all(|r| r[2] > 0.5 && r[2] < 1.2);
    part.found("moving_frame", ours, upright)?;

    part.picture("in_space", in_space(laboratory, ride).to_svg())?;
    let places = [("C", &ride.origin), ("E", top), ("G", &ride.centre)];
    let lines = places.map(|(name, places)| path(name, places, [0, 1]));
    let figure = paths("Figure-eight from above", "X [m]", lines.to_vec());
    part.picture("from_above", figure.to_svg())?;
    let above = seen_from_the_axle(ride, top);
    for (key, axis, plane) in [
        ("longitudinal", "x [m]", [0, 2]),
        ("frontal", "y [m]", [1, 2]),
    ] {
        let lines = [("E", &above), ("G", &ride.relative)];
        let lines = lines.map(|(name, places)| path(name, places, plane));
        let figure = paths("Figure-eight in the moving frame", axis, lines.to_vec());
        part.picture(key, figure.to_svg())?;
    }
    Ok(part.section())
}

/// The least and the largest value.
fn ends(values: &[f64]) -> [f64; 2] {
    let values = values.iter().copied();
    [
        values.clone().fold(f64::INFINITY, f64::min),
        values.fold(f64::NEG_INFINITY, f64::max),
    ]
}

fn extent(values: &[f64]) -> f64 {
    let [least, most] = ends(values);
    most - least
}

fn component(places: &[Vector], k: usize) -> Vec<f64> {
    places.iter().map(|place| place[k]).collect()
}

fn path(label: &str, places: &[Vector], plane: [usize; 2]) -> Series {
    let [x, y] = plane.map(|k| component(places, k));
    line(label, x, y)
}

/// The paths in a box of the size of the capture volume, centred.
fn in_space(laboratory: &Laboratory, ride: &Ride) -> Surface {
    let body = |name: &str| {
        let body = laboratory.skeleton.body(name);
        body.map_or(&[][..], |body| &ride.points[body])
    };
    let places = [
        ("C", &ride.origin[..]),
        ("E", body("E")),
        ("G", &ride.centre),
        ("H", body("H")),
    ];
    let around = |k: usize| {
        let all = places.iter().flat_map(|(_, places)| component(places, k));
        let [least, most] = ends(&all.collect::<Vec<_>>());
        let middle = 0.5 * (least + most);
        // One scale on the ground.
        [-0.5, 0.5].map(|part| middle + part * VOLUME[0])
    };
    let path = |(name, places): &(&str, &[Vector])| Path {
        label: (*name).to_owned(),
        points: places.to_vec(),
    };
    Surface {
        title: "Figure-eight in space".to_owned(),
        labels: ["X [m]", "Y [m]", "Z [m]"].map(str::to_owned),
        ranges: [around(0), around(1), [0.0, VOLUME[2]]],
        kinds: Vec::new(),
        patches: Vec::new(),
        paths: places.iter().map(path).collect(),
    }
}

/// A point in the moving frame.
fn seen_from_the_axle(ride: &Ride, point: &[Vector]) -> Vec<Vector> {
    let rows = 0..ride.times.len();
    rows.map(|row| {
        let [place, origin] = [point[row], ride.origin[row]];
        let relative = [0, 1, 2].map(|k| place[k] - origin[k]);
        ride.frame(row).from_ground(relative)
    })
    .collect()
}
