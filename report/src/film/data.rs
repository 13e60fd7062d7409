//! The data of the page as JSON: names and shapes as text, time series packed.

use appell_runtime::Trajectory;
use appell_runtime::model::{Model, ModelInfo};
use appell_spec::Mechanism;
use appell_spec::mechanism::{FrameId, Point, PointId};
use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde_json::{Value, json};

use crate::drawing::film::{Film, FilmMaker};

/// Largest number of rows; larger pages open slowly.
const MOST_ROWS: usize = 12_000;

/// The data of a motion for a [`live_page`](super::live_page): the animation with the values of the columns.
pub fn data(
    maker: &FilmMaker,
    model: &dyn Model,
    motion: &Trajectory,
    ending: Option<&str>,
) -> Value {
    let rows = thinned(motion.len());
    let mechanism = &maker.mechanism;
    let film = maker.film(model, motion, &rows);
    let times = rows.iter().map(|&row| motion.times()[row]);
    let info = motion.info();
    let columns = motion.columns();
    let values = rows.iter().flat_map(|&row| {
        let values = motion.row(row).iter().zip(columns);
        values.map(|(&value, column)| column.to_unit(value))
    });
    let entries = columns.iter().enumerate().map(|(index, column)| {
        json!({
            "name": column.name,
            "about": column.about,
            "unit": column.unit,
            "group": group(info, index),
        })
    });
    let events = (motion.breaches.iter())
        .map(|breach| json!({ "t": breach.t, "what": breach.describe(info) }));
    let links = (film.links.iter())
        .map(|link| json!({ "kind": link.kind, "ends": link.ends.map(PointId::index) }));
    let forces =
        (film.forces.iter()).map(|force| json!({ "kind": force.kind, "at": force.at.index() }));
    let [right, up, floor, vertical] = film.view;
    let flat = film.flat_across.is_some();
    json!({
        "title": mechanism.title,
        "source": mechanism.source,
        "ending": ending,
        "events": events.collect::<Vec<_>>(),
        "view": { "right": right, "up": up, "floor": floor, "vertical": vertical, "flat": flat },
        "points": points(mechanism),
        "frames": frames(mechanism, &film),
        "links": links.collect::<Vec<_>>(),
        "bodies": bodies(mechanism, &film),
        "forces": forces.collect::<Vec<_>>(),
        "contacts": film.contacts.iter().map(|point| point.index()).collect::<Vec<_>>(),
        "columns": entries.collect::<Vec<_>>(),
        "times": packed(times),
        "positions": packed(film.positions.iter().copied()),
        "turns": packed(film.turns.iter().copied()),
        "arrows": packed(film.arrows.iter().copied()),
        "values": packed(values),
    })
}

/// All rows, or every second, third … and the last.
fn thinned(rows: usize) -> Vec<usize> {
    let step = rows.div_ceil(MOST_ROWS).max(1);
    let last = rows.checked_sub(1).filter(|last| last % step != 0);
    (0..rows).step_by(step).chain(last).collect()
}

fn points(mechanism: &Mechanism) -> Vec<Value> {
    let point = |(id, point): (PointId, &Point)| {
        let mut bodies =
            (mechanism.bodies.iter()).filter(|body| body.centre == id && body.has_place());
        let body = bodies.clone().next();
        json!({
            "name": point.name,
            "about": point.about,
            "body": body.map(|body| &body.name),
            "mass": bodies.any(|body| body.inertia.is_none()),
        })
    };
    mechanism.points.entries().map(point).collect()
}

fn frames(mechanism: &Mechanism, film: &Film) -> Vec<Value> {
    let frames = mechanism.frames.iter().zip(&film.seats);
    frames
        .map(|(frame, seat)| json!({ "name": frame.name, "at": seat.map(PointId::index) }))
        .collect()
}

fn bodies(mechanism: &Mechanism, film: &Film) -> Vec<Value> {
    let shapes = film.shapes.iter().map(|(id, shape)| {
        let body = &mechanism.bodies[*id];
        json!({ "name": body.name, "centre": body.centre.index(), "frame": body.frame.map(FrameId::index), "shape": shape })
    });
    shapes.collect()
}

/// Heading of a column.
fn group(info: &ModelInfo, column: usize) -> &'static str {
    let states = info.state_len();
    let inputs = states + info.input_len();
    match column {
        _ if column < info.speeds => "pseudo-velocities",
        _ if column < states => "coordinates",
        _ if column < inputs => "inputs",
        _ if column < inputs + info.output_len() => "outputs",
        _ => "energies and forces",
    }
}

/// Numbers in single precision, little endian, in base 64.
fn packed(numbers: impl Iterator<Item = f64>) -> String {
    // Seven digits exceed the resolution of a picture.
    #[allow(clippy::cast_possible_truncation)]
    let bytes: Vec<u8> = numbers.flat_map(|n| (n as f32).to_le_bytes()).collect();
    BASE64_STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_motion_keeps_its_first_and_last_row() {
        assert_eq!(thinned(4), [0, 1, 2, 3]);
        let rows = thinned(10 * MOST_ROWS + 2);
        assert_eq!(rows[..2], [0, 11]);
        assert_eq!(rows.last(), Some(&(10 * MOST_ROWS + 1)));
        assert!(thinned(0).is_empty());
    }
}
