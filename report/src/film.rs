//! A page with an animation of the mechanism: one self-contained file.
//!
//! [`data`] writes the data of the page; the scripts draw it for any mechanism:
//!
//! | script | contents |
//! |---|---|
//! | `vectors.js` | vectors, affine maps, boxes |
//! | `film.js`, `colours.js` | the data at any time; light and dark |
//! | `gl.js`, `painter.js` | programs and buffers of WebGL 2; the render passes in their order |
//! | `shapes.js`, `solids.js` | cylinder, ball, ring …; the pass that draws them with lighting |
//! | `traces.js`, `ground.js` | the passes of traces and of the squares on the ground |
//! | `parts.js`, `stage.js` | wheels, springs, arrows … composed of shapes; all of them posed at a time |
//! | `camera.js`, `names.js` | the camera and its controls; labels of points over the picture |
//! | `panel.js`, `player.js` | legend, values, plot; time, keys and buttons |
//! | `live.js` | motions sent by an embedding page |

use appell_codegen::mechanics::finding::Outcome;
use appell_runtime::Trajectory;
use appell_runtime::model::{Model, ModelInfo};
use appell_spec::Mechanism;
use appell_spec::mechanism::{FrameId, Point, PointId};
use base64::prelude::{BASE64_STANDARD, Engine as _};
use maud::{PreEscaped, html};
use serde_json::{Value, json};

use crate::drawing::film::Film;
use crate::page_shell::PageShell;

pub use crate::drawing::film::FilmMaker;

const STYLE: &str = include_str!("film/style.css");
/// Shows the picture and the time only; the embedding page shows the rest.
const LIVE: &str = include_str!("film/live.css");
const BODY: &str = include_str!("film/body.html");
/// In dependency order.
const SCRIPTS: [&str; 16] = [
    include_str!("film/vectors.js"),
    include_str!("film/film.js"),
    include_str!("film/colours.js"),
    include_str!("film/gl.js"),
    include_str!("film/shapes.js"),
    include_str!("film/solids.js"),
    include_str!("film/traces.js"),
    include_str!("film/ground.js"),
    include_str!("film/painter.js"),
    include_str!("film/parts.js"),
    include_str!("film/stage.js"),
    include_str!("film/camera.js"),
    include_str!("film/panel.js"),
    include_str!("film/names.js"),
    include_str!("film/live.js"),
    include_str!("film/player.js"),
];

/// Only the content of the page.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; \
                      style-src 'unsafe-inline'; img-src data:";

/// The page of a motion; `ending` gives the cause of an early end.
pub fn page(
    mechanism: &Mechanism,
    model: &dyn Model,
    motion: &Trajectory,
    ending: Option<&str>,
) -> Outcome<String> {
    let data = data(&FilmMaker::new(mechanism)?, model, motion, ending);
    // The text of a spec is escaped: without `<` in the data it cannot end the element.
    let data = data.to_string().replace('<', "\\u003c");
    Ok(around(&mechanism.title, STYLE, &data))
}

/// The page without a motion, for a frame in another page that sends it the [`data`] of several motions of one
/// mechanism.
pub fn live_page() -> String {
    around("Motion", &[STYLE, LIVE].concat(), "null")
}

fn around(title: &str, style: &str, data: &str) -> String {
    let scripts = SCRIPTS.join("\n");
    let shell = PageShell {
        policy: Some(POLICY),
        ..PageShell::new(title, style)
    };
    shell.around(&html! {
        (PreEscaped(BODY))
        script type="application/json" id="film" { (PreEscaped(data)) }
        (PreEscaped("\n"))
        script { (PreEscaped("\n\"use strict\";\n")) (PreEscaped(scripts)) }
    })
}

/// Largest number of rows; larger pages open slowly.
const MOST_ROWS: usize = 12_000;

/// The data of a motion for a [`live_page`]: the animation with the values of the columns.
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
