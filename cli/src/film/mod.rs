//! A page with the moving mechanism: one file that needs no network.
//!
//! [`data`] writes what the page shows; the scripts beside it draw that, whatever the mechanism.

mod data;

use appell_codegen::compile::report;
use appell_runtime::Trajectory;

use appell::Error;
use appell::engine::Equations;
use appell::setup::Setup;

/// The library that draws in space, see `vendor/three`.
const THREE: &str = include_str!("../../vendor/three/three.min.js");
const LICENCE: &str = include_str!("../../vendor/three/LICENSE");

const STYLE: &str = include_str!("style.css");
const BODY: &str = include_str!("body.html");
/// In the order in which they use each other.
const SCRIPTS: [&str; 7] = [
    include_str!("film.js"),
    include_str!("colours.js"),
    include_str!("parts.js"),
    include_str!("stage.js"),
    include_str!("camera.js"),
    include_str!("panel.js"),
    include_str!("player.js"),
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
         <!-- three.js\n{LICENCE}-->\n<script>{THREE}</script>\n\
         <script>\n\"use strict\";\n{scripts}</script>\n</html>\n"
    ))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
