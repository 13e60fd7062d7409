//! A drawing of a mechanism at its initial state, as SVG, and the data of animations.
//!
//! The files are the steps: [`placement`] writes positions of points and frames, [`scene`]
//! evaluates them, [`solids`] gives bodies a shape, [`view`] chooses the projection, [`shapes`]
//! makes strokes in space, [`sheet`] lays them out. [`home`] locates names. [`mod@film`] follows a
//! motion with the same positions and shapes.

pub mod film;
mod home;
pub mod link;
mod placement;
mod scene;
mod shapes;
mod sheet;
mod solids;
mod space;
mod view;

use appell_spec::mechanism::Mechanism;

use appell_codegen::mechanics::Derivation;
use appell_codegen::mechanics::finding::Outcome;
use scene::Scene;
use view::View;

/// The drawing of a mechanism, an SVG document. Points without a finite position are omitted and
/// listed in the caption.
pub fn drawing(mechanism: &Mechanism, derivation: Derivation) -> Outcome<String> {
    marked(mechanism, derivation, &[])
}

/// The drawing with rings around the locations of some names: coordinates, bodies, inputs,
/// parameters, constraints, points. A name without a location has no ring.
pub fn marked(mechanism: &Mechanism, derivation: Derivation, names: &[&str]) -> Outcome<String> {
    let scene = Scene::initial(mechanism, derivation)?;
    let view = View::of(mechanism, scene.flat_across);
    Ok(sheet::svg(mechanism, &scene, &view, names))
}
