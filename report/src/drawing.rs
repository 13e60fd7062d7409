//! A drawing of a mechanism at its initial state, as SVG, and what a moving picture needs.
//!
//! The files are the steps: [`placement`] writes where points and frames are, [`scene`] evaluates that,
//! [`solids`] gives bodies a shape, [`view`] chooses where to look from, [`shapes`] makes strokes in
//! space, [`sheet`] lays them out on paper. [`home`] tells where a name belongs. [`mod@film`] follows a motion with the same places and shapes.

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

/// The drawing of a mechanism, an SVG document. What has no finite position is left out and told in
/// the caption.
pub fn drawing(mechanism: &Mechanism, derivation: Derivation) -> Outcome<String> {
    marked(mechanism, derivation, &[])
}

/// The drawing with rings about the places of some names: coordinates, bodies, inputs, parameters,
/// constraints, points. A name without a place has no ring.
pub fn marked(mechanism: &Mechanism, derivation: Derivation, names: &[&str]) -> Outcome<String> {
    let scene = Scene::initial(mechanism, derivation)?;
    let view = View::of(mechanism, scene.flat_across);
    Ok(sheet::svg(mechanism, &scene, &view, names))
}
