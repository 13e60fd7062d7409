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

mod data;

use appell_codegen::mechanics::finding::Outcome;
use appell_runtime::Trajectory;
use appell_runtime::model::Model;
use appell_spec::Mechanism;
use maud::{PreEscaped, html};

pub use crate::drawing::film::FilmMaker;
use crate::page_shell::PageShell;
pub use data::data;

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
