//! Inward recursion: the forces required by a motion, and their projections on the speeds.

use super::super::algebra::Algebra;
use super::inertia::{Inertia, Wrench};
use super::links::Links;
use super::movement::LinkMotion;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};

impl Inertia {
    /// Inertial forces of a motion: `f = m a + (α× + ω× ω×) h` and `n = h × a + I α + ω × I ω`.
    pub(super) fn takes(&self, graph: &mut Graph, motion: &LinkMotion) -> Wrench {
        let inertial = graph.scale3(self.mass, motion.a);
        let turning = graph.mat_vec(&motion.turning, self.moment);
        let moment = graph.cross(self.moment, motion.a);
        let gyroscopic = self.turns(graph, motion);
        Wrench {
            n: graph.add3(moment, gyroscopic),
            f: graph.add3(inertial, turning),
        }
    }

    /// `I α + ω × I ω`, using the products of ω in the turning matrix.
    pub(super) fn turns(&self, graph: &mut Graph, motion: &LinkMotion) -> Vec3 {
        let (t, l) = (&self.tensor, &motion.turning);
        let mut component = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let difference = graph.sub(t[k][k], t[j][j]);
            let product = graph.mul(motion.w[j], motion.w[k]);
            let squares = graph.sub(l[j][j], l[k][k]);
            let minus = graph.neg(l[k][i]);
            let terms = [
                graph.mul(t[i][i], motion.alpha[i]),
                graph.mul(difference, product),
                graph.mul(t[i][j], minus),
                graph.mul(t[i][k], l[j][i]),
                graph.mul(t[j][k], squares),
            ];
            graph.sum(&terms)
        };
        [0, 1, 2].map(&mut component)
    }
}

impl Links {
    /// The forces on all links, accumulated over their descendants.
    pub(super) fn wrenches(
        &self,
        algebra: &mut Algebra,
        inertias: &[Inertia],
        motions: &[LinkMotion],
        kind: &str,
    ) -> Vec<Wrench> {
        let mut wrenches: Vec<Wrench> = (inertias.iter().zip(motions))
            .map(|(inertia, motion)| inertia.takes(&mut algebra.graph, motion))
            .collect();
        for (place, link) in self.all.iter().enumerate().rev() {
            let named = wrenches[place].named(algebra, kind, &link.name);
            wrenches[place] = named;
            if let Some(parent) = link.parent {
                let graph = &mut algebra.graph;
                let carried = link.on_carrier(graph, named);
                wrenches[parent] = wrenches[parent].plus(graph, carried);
            }
        }
        wrenches
    }

    /// The projections of the links' forces on the speeds.
    pub(super) fn felt(&self, graph: &mut Graph, wrenches: &[Wrench]) -> Vec<Expr> {
        let mut parts = vec![Vec::new(); self.speeds.len()];
        for (link, &wrench) in self.all.iter().zip(wrenches) {
            for &(speed, column) in &link.columns {
                parts[speed].push(link.work(graph, column, wrench));
            }
        }
        parts.iter().map(|parts| graph.sum(parts)).collect()
    }
}
