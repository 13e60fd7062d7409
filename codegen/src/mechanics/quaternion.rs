//! Orientations by unit quaternions e = (w, x, y, z): R(e), the angular velocity 2 ē ė and ė = ½ e ω (Altmann,
//! *Rotations, Quaternions, and Double Groups*, 1986).

use appell_spec::mechanism::{ConstraintId, CoordinateId, Mechanism};

use super::algebra::Algebra;
use crate::symbolic::vector::{Mat3, Vec3};
use crate::symbolic::{Expr, Graph, Rational};

/// The coordinates of the quaternions, by index.
pub(super) fn quaternions(mechanism: &Mechanism) -> impl Iterator<Item = [usize; 4]> {
    let frames = mechanism.frames.iter();
    let all = frames.filter_map(|frame| Some(frame.quaternion?.map(CoordinateId::index)));
    let mut told = Vec::new();
    // Frames with the same rotation share one.
    all.filter(move |quaternion| {
        let is_new = !told.contains(quaternion);
        told.push(*quaternion);
        is_new
    })
}

/// Whether a constraint is the norm of a quaternion: these come after those of the spec.
pub(super) fn is_norm(mechanism: &Mechanism, constraint: ConstraintId) -> bool {
    let written = mechanism.constraints.len() - quaternions(mechanism).count();
    constraint.index() >= written
}

/// The rotation of a frame relative to its parent.
#[derive(Debug, Clone)]
pub(super) struct Attitude {
    /// From components in the frame to those in the parent.
    pub(super) matrix: Mat3,
    /// Angular velocity relative to the parent, in the frame.
    pub(super) w: Vec3,
}

impl Attitude {
    /// The rotation of a quaternion, and its angular velocity.
    pub(super) fn new(algebra: &mut Algebra, e: [Expr; 4], rates: [Expr; 4]) -> Self {
        let w = angular_velocity(&mut algebra.graph, e, rates);
        Self {
            matrix: rotation(&mut algebra.graph, e),
            w: algebra.shortest3(w),
        }
    }
}

fn rotation(graph: &mut Graph, [w, x, y, z]: [Expr; 4]) -> Mat3 {
    // 1 − 2 (a² + b²)
    let mut diagonal = |a, b| {
        let squares = [graph.square(a), graph.square(b)];
        let sum = graph.sum(&squares);
        let twice = graph.scale(&Rational::new(2, 1), sum);
        graph.sub(Graph::ONE, twice)
    };
    let [xx, yy, zz] = [diagonal(y, z), diagonal(x, z), diagonal(x, y)];
    // 2 (a b ± w c)
    let mut pair = |a, b, c| {
        let (ab, wc) = (graph.mul(a, b), graph.mul(w, c));
        let both = [graph.sub(ab, wc), graph.add(ab, wc)];
        both.map(|sum| graph.scale(&Rational::new(2, 1), sum))
    };
    let ([xy, yx], [zx, xz], [yz, zy]) = (pair(x, y, z), pair(x, z, y), pair(y, z, x));
    [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]
}

/// ω = 2 (w v̇ − ẇ v − v × v̇) in the frame.
fn angular_velocity(graph: &mut Graph, e: [Expr; 4], rates: [Expr; 4]) -> Vec3 {
    let ([w, v @ ..], [w_dot, v_dot @ ..]) = (e, rates);
    let (along, fading) = (graph.scale3(w, v_dot), graph.scale3(w_dot, v));
    let across = graph.cross(v, v_dot);
    let less = graph.add3(fading, across);
    [0, 1, 2].map(|k| {
        let half = graph.sub(along[k], less[k]);
        graph.scale(&Rational::new(2, 1), half)
    })
}

/// ė = ½ (−v · ω, w ω + v × ω) for an angular velocity in the frame.
pub(super) fn rates(graph: &mut Graph, [w, v @ ..]: [Expr; 4], omega: Vec3) -> [Expr; 4] {
    let along = graph.dot(v, omega);
    let (scaled, across) = (graph.scale3(w, omega), graph.cross(v, omega));
    let [x, y, z] = graph.add3(scaled, across);
    let w = graph.neg(along);
    [w, x, y, z].map(|rate| graph.scale(&Rational::new(1, 2), rate))
}
