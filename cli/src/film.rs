//! A page with the moving mechanism: one file that needs no network.
//!
//! [`data`] writes what the page shows; the scripts beside it draw that, whatever the mechanism:
//!
//! | script | what it knows |
//! |---|---|
//! | `vectors.js` | vectors, affine maps, boxes |
//! | `film.js`, `colours.js` | the data at any time; light and dark |
//! | `gl.js`, `painter.js` | programs and buffers of WebGL 2; the passes of a picture, in their order |
//! | `shapes.js`, `solids.js` | cylinder, ball, ring …; the pass that draws them in their light |
//! | `traces.js`, `ground.js` | the passes of traces and of the squares on the ground |
//! | `parts.js`, `stage.js` | wheels, springs, arrows … of shapes; all of them where they are at a time |
//! | `camera.js`, `names.js` | the eye and its pointers; names of points over the picture |
//! | `panel.js`, `player.js` | legend, values, plot; time, keys and buttons |

mod data;

use appell_codegen::compile::report;
use appell_runtime::Trajectory;

use appell::Error;
use appell::engine::Equations;
use appell::setup::Setup;

const STYLE: &str = include_str!("film/style.css");
const BODY: &str = include_str!("film/body.html");
/// In the order in which they use each other.
const SCRIPTS: [&str; 15] = [
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
    include_str!("film/player.js"),
];

/// The page of a motion; `ending` tells why it ended early.
pub(crate) fn page(
    equations: &Equations,
    setup: &Setup<'_>,
    motion: &Trajectory,
    ending: Option<&str>,
) -> Result<String, Error> {
    let data = data::json(&setup.mechanism, equations.model(), motion, ending)
        .map_err(|findings| report(&setup.mechanism, setup.spec, &findings))?;
    // The text of a spec stays text: no `<` leaves the data, so that nothing in it ends the element.
    let data = data.to_string().replace('<', "\\u003c");
    let title = escaped(&setup.mechanism.title);
    let scripts = SCRIPTS.join("\n");
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n{BODY}\
         <script type=\"application/json\" id=\"film\">{data}</script>\n\
         <script>\n\"use strict\";\n{scripts}</script>\n</html>\n"
    ))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
