//! Outward recursion: angular velocities and accelerations of the links.

use super::super::algebra::{Algebra, named3};
use super::links::{Link, Links, Step};
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph};

/// The motion of a link, in its axes.
#[derive(Debug, Clone)]
pub(super) struct LinkMotion {
    /// Angular velocity.
    pub(super) w: Vec3,
    /// Angular acceleration.
    pub(super) alpha: Vec3,
    /// Acceleration of the origin.
    pub(super) a: Vec3,
    /// `α× + ω× ω×`: maps a position to its acceleration relative to the origin.
    pub(super) turning: Mat3,
}

impl LinkMotion {
    /// A motion without rotation.
    pub(super) fn at_rest(a: Vec3) -> Self {
        Self {
            w: vector::ZERO,
            alpha: vector::ZERO,
            a,
            turning: [vector::ZERO; 3],
        }
    }
}

/// `α× + ω× ω×`
fn turning(graph: &mut Graph, w: Vec3, alpha: Vec3) -> Mat3 {
    let square = |graph: &mut Graph, i: usize, j: usize| graph.mul(w[i], w[j]);
    let mut matrix = vector::IDENTITY;
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (jj, kk) = (square(graph, j, j), square(graph, k, k));
        let sum = graph.add(jj, kk);
        matrix[i][i] = graph.neg(sum);
        let ij = square(graph, i, j);
        matrix[i][j] = graph.sub(ij, alpha[k]);
        matrix[j][i] = graph.add(ij, alpha[k]);
    }
    matrix
}

impl Links {
    /// The motions of all links for an acceleration of the ground and ω̇, none if all vanish. `kind` distinguishes
    /// this motion in names.
    pub(super) fn motions(
        &self,
        algebra: &mut Algebra,
        ground: Vec3,
        accelerations: &[Expr],
        kind: &str,
    ) -> Vec<LinkMotion> {
        let at_rest = LinkMotion::at_rest(ground);
        let mut motions: Vec<LinkMotion> = Vec::with_capacity(self.all.len());
        for link in &self.all {
            let carrier = link.parent.map_or(&at_rest, |parent| &motions[parent]);
            let motion = link.moved(algebra, carrier, accelerations, kind);
            motions.push(motion);
        }
        motions
    }

    /// The acceleration of the ground in the axes of all links at rest.
    pub(super) fn still(&self, algebra: &mut Algebra, ground: Vec3) -> Vec<Vec3> {
        let mut all: Vec<Vec3> = Vec::with_capacity(self.all.len());
        for link in &self.all {
            let carried = link.parent.map_or(ground, |parent| all[parent]);
            all.push(match &link.step {
                Step::Rotation { .. } => {
                    let a = link.step.inward(&mut algebra.graph, carried);
                    named3(algebra, &format!("g_{}", link.name), a)
                }
                Step::Shift { .. } => carried,
            });
        }
        all
    }
}

impl Link {
    /// The relative velocity of the step, or its rate: `Σ column · speed`; zero without speeds.
    pub(super) fn along(&self, graph: &mut Graph, speeds: &[Expr]) -> Vec3 {
        let mut sum = vector::ZERO;
        for &(speed, column) in self.columns.iter().filter(|_| !speeds.is_empty()) {
            let part = graph.scale3(speeds[speed], column);
            sum = graph.add3(sum, part);
        }
        sum
    }

    fn moved(
        &self,
        algebra: &mut Algebra,
        carrier: &LinkMotion,
        accelerations: &[Expr],
        kind: &str,
    ) -> LinkMotion {
        let driving = self.along(&mut algebra.graph, accelerations);
        let (name, step) = (&self.name, &self.step);
        match step {
            Step::Rotation { w, w_dot, .. } => {
                let graph = &mut algebra.graph;
                let carried = step.inward(graph, carrier.w);
                let sum = graph.add3(carried, *w);
                let turned = algebra.shared3(&format!("w_{name}"), sum);
                let graph = &mut algebra.graph;
                // α = Rᵀ α_carrier + ω × w + ẇ
                let mut alpha = step.inward(graph, carrier.alpha);
                let change = graph.cross(turned, *w);
                for part in [change, *w_dot, driving] {
                    alpha = graph.add3(alpha, part);
                }
                let a = step.inward(graph, carrier.a);
                let alpha = named3(algebra, &format!("alpha{kind}_{name}"), alpha);
                let a = named3(algebra, &format!("a{kind}_{name}"), a);
                LinkMotion {
                    w: turned,
                    alpha,
                    a,
                    turning: turning(&mut algebra.graph, turned, alpha),
                }
            }
            Step::Shift { d, d_dot, d_ddot } => {
                // a = a_carrier + (α× + ω× ω×) d + 2 ω × ḋ + d̈
                let graph = &mut algebra.graph;
                let mut a = graph.mat_vec(&carrier.turning, *d);
                let coriolis = graph.cross(carrier.w, *d_dot);
                let coriolis = graph.add3(coriolis, coriolis);
                for part in [carrier.a, coriolis, *d_ddot, driving] {
                    a = graph.add3(a, part);
                }
                let a = named3(algebra, &format!("a{kind}_{name}"), a);
                LinkMotion {
                    a,
                    ..carrier.clone()
                }
            }
        }
    }
}
