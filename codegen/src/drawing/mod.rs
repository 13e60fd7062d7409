//! A drawing of a mechanism at its initial state, as SVG.
//!
//! The files are the steps: [`scene`] places points and turns frames, [`view`] chooses where to look
//! from, [`shapes`] makes strokes in space, [`sheet`] lays them out on paper.

mod scene;
mod shapes;
mod sheet;
mod space;
mod view;

use appell_spec::mechanism::Mechanism;

use crate::mechanics::Derivation;
use crate::mechanics::finding::Outcome;
use scene::Scene;
use view::View;

/// The drawing of a mechanism, an SVG document. What has no finite position is left out and told in
/// the caption.
pub fn drawing(mechanism: &Mechanism, derivation: Derivation) -> Outcome<String> {
    let scene = Scene::new(mechanism, derivation)?;
    let view = View::of(mechanism, scene.flat_across);
    Ok(sheet::svg(mechanism, &scene, &view))
}
