//! A drawing of a mechanism at its initial state, as SVG, and the data of animations.
//!
//! The files are the steps: [`scene`] writes positions of points and frames and evaluates them, [`view`] chooses the
//! projection, [`shapes`] gives bodies a shape and makes strokes in space, [`arcs`] those of angles, [`sheet`] lays them
//! out. [`home`] locates names. [`mod@film`] follows a motion with the same positions and shapes.

mod arcs;
pub mod film;
mod home;
pub mod link;
mod scene;
mod shapes;
mod sheet;
mod space;
mod view;

use appell_spec::mechanism::Mechanism;

use appell_codegen::mechanics::Derivation;
use appell_codegen::mechanics::finding::Outcome;
pub use scene::Moment;
use scene::Scene;

/// The drawing of a mechanism, an SVG document. Points without a finite position are omitted and
/// listed in the caption.
pub fn drawing(mechanism: &Mechanism, derivation: Derivation) -> Outcome<String> {
    marked(mechanism, derivation, &[])
}

/// The drawing with other values than those of the spec.
pub fn drawing_at(
    mechanism: &Mechanism,
    derivation: Derivation,
    moment: &Moment,
) -> Outcome<String> {
    let scene = Scene::initial(mechanism, derivation, Some(moment))?;
    Ok(sheet::svg(mechanism, &scene, &[], &moment.given))
}

/// The drawing with rings around the locations of some names: coordinates, bodies, inputs,
/// parameters, constraints, points. A name without a location has no ring.
pub fn marked(mechanism: &Mechanism, derivation: Derivation, names: &[&str]) -> Outcome<String> {
    let scene = Scene::initial(mechanism, derivation, None)?;
    Ok(sheet::svg(mechanism, &scene, names, ""))
}
