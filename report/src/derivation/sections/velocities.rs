//! Angular velocities of frames and bodies, velocities of points, and their accelerations.

use std::collections::BTreeSet;

use appell_codegen::mechanics::gibbs_appell::along;
use appell_codegen::symbolic::vector;
use appell_codegen::symbolic::vector::ZERO;
use appell_spec::mechanism::{FrameId, GROUND, PointId};

use super::super::{About, Letter, Section, Writer};
use super::phrases::{about, formula, headed, sentence, with, with_formulas};

/// Velocities, each in the frame where it is shortest.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut equations = Vec::new();
    for frame in written_frames(w) {
        let v = w.derivation.kinematics.frames.angular_velocity(frame);
        // A body-fixed frame rotates with its body.
        let mut rotations = w.derivation.bodies.iter().flat_map(|b| &b.rotation);
        if rotations.any(|r| r.velocity == v) {
            continue;
        }
        let letter = Letter::bold("Ω").below(&w.frame(frame));
        equations.extend(about(w.vector(letter, v.v, v.frame), About::Frame(frame)));
    }
    let bodies = w.derivation.bodies.clone();
    for (id, body) in w.mechanism.bodies.ids().zip(bodies) {
        if let Some(rotation) = body.rotation {
            let letter = Letter::bold("ω").below(&body.name);
            let vector = w.vector(letter, rotation.velocity.v, rotation.velocity.frame);
            equations.extend(about(vector, About::Body(id)));
        }
    }
    for point in moving_points(w) {
        let v = w.derivation.kinematics.velocity(point);
        let letter = Letter::bold("v").below(&w.point(point));
        equations.extend(about(w.vector(letter, v.v, v.frame), About::Point(point)));
    }
    let mut blocks = vec![sentence(
        "Ω is the angular velocity of a frame, ω that of a body and the frames fixed in it; each \
         vector is written in the frame where it is shortest.",
    )];
    blocks.extend(with(w, "", equations));
    headed("Velocities", blocks)
}

/// The rotating frames in which motions of bodies are written.
fn written_frames(w: &Writer<'_>) -> BTreeSet<FrameId> {
    let bodies = w.derivation.bodies.iter();
    let frames = bodies.flat_map(|body| {
        let rotation = body.rotation.as_ref();
        let frames = [Some(&body.centre.velocity), rotation.map(|r| &r.velocity)];
        frames.into_iter().flatten().map(|velocity| velocity.frame)
    });
    frames.filter(|&frame| frame != GROUND).collect()
}

/// Centres of mass, then the other points of application of loads.
fn moving_points(w: &Writer<'_>) -> Vec<PointId> {
    let centres = w.mechanism.bodies.iter().map(|b| b.centre);
    let loads = w.mechanism.loads.iter();
    let mut once = Vec::new();
    for point in centres.chain(loads.flat_map(|load| load.kind.points())) {
        let moves = w.derivation.kinematics.velocity(point).v != ZERO;
        if moves && !once.contains(&point) {
            once.push(point);
        }
    }
    once
}

/// Accelerations, linear in the pseudo-accelerations.
pub(super) fn accelerations(w: &mut Writer<'_>) -> Section {
    let mut equations = Vec::new();
    let mut shown = Vec::new();
    let accelerations = w.derivation.symbols.accelerations.clone();
    let bodies = w.derivation.bodies.clone();
    for (id, body) in w.mechanism.bodies.ids().zip(bodies) {
        let centre = w.mechanism.bodies[id].centre;
        if !shown.contains(&centre) {
            shown.push(centre);
            let motion = body.centre;
            let a = along(w.graph(), motion.bias, &motion.partial, &accelerations);
            let letter = Letter::bold("a").below(&w.point(centre));
            let vector = w.vector(letter, a, motion.velocity.frame);
            equations.extend(about(vector, About::Point(centre)));
        }
        if let Some(rotation) = body.rotation
            && rotation.velocity.v != vector::ZERO
        {
            let alpha = along(w.graph(), rotation.bias, &rotation.partial, &accelerations);
            let letter = Letter::bold("α").below(&body.name);
            let vector = w.vector(letter, alpha, rotation.velocity.frame);
            equations.extend(about(vector, About::Body(id)));
        }
    }
    let rule = with_formulas(
        "In a rotating frame {}, differentiated component by component; angular accelerations likewise.",
        [formula("*a = *v' + *Ω × *v")],
    );
    let mut blocks = vec![rule];
    blocks.extend(with(w, "", equations));
    headed("Accelerations", blocks)
}
