//! Angular velocities of frames and bodies, velocities of points.

use appell_spec::mechanism::{BodyId, FrameId, GROUND, PointId};

use super::super::writer::Writer;
use super::super::{About, Letter, Section};
use super::phrases::{about, headed, sentence, with};

/// Velocities, each in the frame where it is shortest.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut equations = Vec::new();
    for frame in written_frames(w) {
        let v = w.derivation.kinematics.frames.angular_velocity(frame);
        // A body-fixed frame rotates with its body.
        let rotations = w
            .derivation
            .bodies
            .iter()
            .filter_map(|b| b.rotation.as_ref());
        if rotations.into_iter().any(|r| r.velocity == v) {
            continue;
        }
        let letter = Letter::bold("Ω").below(&w.frame(frame));
        equations.extend(about(w.vector(letter, v.v, v.frame), About::Frame(frame)));
    }
    for (index, body) in w.derivation.bodies.clone().into_iter().enumerate() {
        if let Some(rotation) = body.rotation {
            let letter = Letter::bold("ω").below(&body.name);
            let vector = w.vector(letter, rotation.velocity.v, rotation.velocity.frame);
            equations.extend(about(vector, About::Body(BodyId::new(index))));
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
fn written_frames(w: &Writer<'_>) -> Vec<FrameId> {
    let mut frames: Vec<FrameId> = Vec::new();
    for body in &w.derivation.bodies {
        let rotation = body.rotation.as_ref().map(|r| r.velocity.frame);
        for frame in [Some(body.centre.velocity.frame), rotation]
            .into_iter()
            .flatten()
        {
            if frame != GROUND && !frames.contains(&frame) {
                frames.push(frame);
            }
        }
    }
    frames.sort_unstable();
    frames
}

/// Centres of mass, then the other points of application of loads.
fn moving_points(w: &Writer<'_>) -> Vec<PointId> {
    let mut points: Vec<PointId> = w.mechanism.bodies.iter().map(|b| b.centre).collect();
    points.extend(w.mechanism.loads.iter().flat_map(|load| load.kind.points()));
    let mut once = Vec::new();
    for point in points {
        let moves =
            w.derivation.kinematics.velocity(point).v != appell_codegen::symbolic::vector::ZERO;
        if moves && !once.contains(&point) {
            once.push(point);
        }
    }
    once
}
